// Cramer-Rao bounds: what noise leaves unknown of temperature and absorption, whatever the
// algorithm.
#include <Eigen/Dense>

#include "support/length.h"
#include "validation/cases.h"

namespace plenoflame::test::bounds_case_test {
namespace {

constexpr double kRadius = 20e-3;
/// Fine rings that make up wide ones of one temperature each: what is linear between two of them
/// takes up 1 / 500 of a wide ring where there are ten; bounds
/// above 100 % feel 1 / 40.
constexpr int kFine = 5000;

/// Standard deviations, relative: means over the rings that are hotter than 1400 K.
struct Bounds {
  double absorption = 0, temperature = 0;
};

/// @param wavelengths [m] kappa is that of 650 nm, and in inverse proportion to them
/// @param temperatures, absorptions numbers of equal rings that have one each
Bounds bounds(double kappa, const std::vector<double>& wavelengths, int temperatures,
              int absorptions) {
  const RingGrid grid = fine_rings(kRadius, kFine);
  const auto unknowns = make_ring_unknowns(grid);
  std::vector<Ray> lines;
  for (int m = 0; m < 60; ++m) lines.push_back({{(m + 0.5) / 60 * kRadius, -1, 0}, {0, 1, 0}});
  const CameraRays rays = rows_of(lines);
  ThermalModel model;
  model.unknowns = unknowns.get();
  for (const double wavelength : wavelengths)
    model.channels.push_back({&rays, planck(wavelength), 650e-9 / wavelength});
  model.absorbs.assign(kFine, 1);
  model.absorbs.back() = 0;

  const auto ring_of = [](int i, int rings) {
    const double r = i * kRadius / (kFine - 1.5);
    return std::min(rings - 1, static_cast<int>(r / kRadius * rings));
  };
  const auto temperature = [&](int ring) {
    return temperatures == 1 ? 1700 : hot_ring((ring + 0.5) / temperatures * kRadius, 60e-3);
  };
  std::vector<double> x;
  for (int i = 0; i < kFine; ++i) x.push_back(temperature(ring_of(i, temperatures)));
  x.resize(2 * kFine, std::log(kappa));
  const std::vector<double> b = thermal_fluxes(model, x);
  const CsrMatrix<float> matrix = make_thermal_matrix(model, x, {});
  const auto derivative = make_csr_operator(matrix);
  const Eigen::Index parameters = temperatures + absorptions;
  Eigen::MatrixXd j(static_cast<Eigen::Index>(b.size()), parameters);
  for (Eigen::Index p = 0; p < parameters; ++p) {
    // Both in logarithms: deviations are relative.
    std::vector<double> along(x.size(), 0.0);
    for (int i = 0; i < kFine; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (p < temperatures && ring_of(i, temperatures) == p) along[at] = x[at];
      if (p >= temperatures && ring_of(i, absorptions) == p - temperatures) along[kFine + at] = 1;
    }
    const std::vector<double> column = *derivative * along;
    j.col(p) = Eigen::Map<const Eigen::VectorXd>(column.data(), j.rows());
  }
  // Noise of 1 % of each channel's peak.
  const auto rows = static_cast<Eigen::Index>(lines.size());
  for (std::size_t c = 0; c < wavelengths.size(); ++c) {
    const auto first = b.begin() + static_cast<std::ptrdiff_t>(c * lines.size());
    const double peak = *std::max_element(first, first + rows);
    j.middleRows(static_cast<Eigen::Index>(c) * rows, rows) /= 0.01 * peak;
  }
  const Eigen::MatrixXd inverse = Eigen::HouseholderQR<Eigen::MatrixXd>(j)
                                      .matrixQR()
                                      .topRows(parameters)
                                      .triangularView<Eigen::Upper>()
                                      .solve(Eigen::MatrixXd::Identity(parameters, parameters));
  const auto deviation = [&](Eigen::Index p) { return inverse.row(p).norm(); };
  Bounds result;
  double hot = 0, hot_absorptions = 0;
  for (int ring = 0; ring < temperatures; ++ring) {
    if (!(temperature(ring) > 1400)) continue;
    result.temperature += deviation(ring);
    ++hot;
    if (absorptions == 1) continue;
    result.absorption += deviation(temperatures + ring);
    ++hot_absorptions;
  }
  result.temperature /= hot;
  result.absorption =
      absorptions == 1 ? deviation(temperatures) : result.absorption / hot_absorptions;
  return result;
}

// One wavelength leaves temperature and absorption apart all but unknown; two tell them.
TEST(CaseE, BoundsOfTemperatureAndAbsorption) {
  const std::vector<double> one{650e-9}, two{650e-9, 850e-9}, three{500e-9, 650e-9, 850e-9};
  // Per cent as printed, at 8 and 30 1/m: of the absorption, of the temperature.
  struct Row {
    const char* name;
    const std::vector<double>* wavelengths;
    int temperatures, absorptions;
    const char *thin, *thick, *thin_t, *thick_t;
  };
  for (const Row& row :
       {Row{"1 T 1 kappa 650", &one, 1, 1, "7.3", "2.2", "0.5", "0.1"},
        Row{"1 T 1 kappa 650 850", &two, 1, 1, "0.8", "0.8", "0.06", "0.04"},
        Row{"5 T 1 kappa 650", &one, 5, 1, "104", "38", "7.3", "1.8"},
        Row{"5 T 1 kappa 650 850", &two, 5, 1, "1.2", "1.3", "0.35", "0.32"},
        Row{"10 T 1 kappa 650", &one, 10, 1, "386", "141", "27", "5.7"},
        Row{"10 T 1 kappa 650 850", &two, 10, 1, "1.2", "1.3", "0.42", "0.41"},
        Row{"5 T 5 kappa 650", &one, 5, 5, "1388", "558", "88", "14"},
        Row{"5 T 5 kappa 650 850", &two, 5, 5, "26", "16", "2.5", "1.9"},
        Row{"5 T 5 kappa 500 650 850", &three, 5, 5, "19", "11", "1.8", "1.5"},
        Row{"10 T 10 kappa 650 850", &two, 10, 10, "27", "20", "9.0", "9.3"},
        Row{"10 T 10 kappa 500 650 850", &three, 10, 10, "17", "12", "5.8", "6.5"}}) {
    // One row of each number of wavelengths, where temperatures are five.
    if (!in_full() && row.temperatures != 5) continue;
    const Bounds thin = bounds(8, *row.wavelengths, row.temperatures, row.absorptions),
                 thick = bounds(30, *row.wavelengths, row.temperatures, row.absorptions);
    const std::string name = row.name;
    // Half a unit of the last figure that is printed, and 3 % of the case itself.
    const auto look = [&](const std::string& what, const std::string& printed, double found) {
      const double expected = std::stod(printed);
      note(name + what, expected, 100 * found);
      const std::size_t point = printed.find('.');
      const double unit = point == std::string::npos
                              ? 1
                              : std::pow(10, -static_cast<double>(printed.size() - point - 1));
      EXPECT_TRUE(relative(100 * found, expected, 0.03 + 0.5 * unit / expected)) << name << what;
    };
    look(" kappa at 8 per m", row.thin, thin.absorption);
    look(" T at 8 per m", row.thin_t, thin.temperature);
    look(" kappa at 30 per m", row.thick, thick.absorption);
    look(" T at 30 per m", row.thick_t, thick.temperature);
  }
}

}  // namespace
}  // namespace plenoflame::test::bounds_case_test
