// Pictures as functions of temperature and absorption: against the renderer, and derivatives
// against differences of the model itself.
#include "plenoflame/inverse/thermal_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/inverse/random_vectors.h"
#include "core/media_voxel/voxel_fixture.h"
#include "inverse/operators/source_table.h"
#include "plenoflame/base/error.h"
#include "plenoflame/inverse/measurement.h"
#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::thermal_model_test {
namespace {

constexpr std::array<int, 3> kCount{7, 8, 9};

AffineTransform lattice_map() {
  return scaled(2e-3, {1 - 6e-3, -7e-3, -8e-3});
}

/// Samples that single precision holds exactly.
struct Grids {
  std::vector<double> temperature, absorption;

  explicit Grids(double thickest) {
    std::mt19937 random(17);
    std::uniform_real_distribution<float> share(0, 1);
    for (int n = 0; n < kCount[0] * kCount[1] * kCount[2]; ++n) {
      temperature.push_back(static_cast<double>(1200 + 800 * share(random)));
      absorption.push_back(
          static_cast<double>(static_cast<float>(thickest) * (0.1F + share(random))));
    }
  }
  /// Temperatures, then logarithms of absorptions.
  std::vector<double> variables() const {
    std::vector<double> x = temperature;
    for (const double kappa : absorption) x.push_back(std::log(kappa));
    return x;
  }
};

MediumLoader loader(const Grids& g) {
  return [g](const FlameSpec&, const std::string&, const std::vector<SourceFunction>& channels,
             const Execution&) {
    const auto field = [&](const std::vector<double>& samples) {
      return make_field(
          {0, 0, 0}, kCount,
          [&](int i, int j, int k) {
            return static_cast<float>(
                samples[static_cast<std::size_t>((i * kCount[1] + j) * kCount[2] + k)]);
          },
          lattice_map());
    };
    VoxelMediumOptions whole_cells;
    whole_cells.tolerance = 0;
    return make_voxel_medium(field(g.temperature), field(g.absorption),
                             VoxelInterpolation::trilinear, channels, whole_cells);
  };
}

struct Problem {
  Grids grids;
  CompiledScene scene;
  std::unique_ptr<Unknowns> unknowns;
  CameraRays rays;
  ThermalModel model;

  explicit Problem(double thickest, int channels = 1, int threads = 2,
                   const Scene& hot = hot_scene())
      : grids(thickest), scene(compile(hot, loader(grids))) {
    unknowns = make_voxel_unknowns({kCount, lattice_map(), VoxelInterpolation::trilinear});
    CameraRaySettings settings;
    settings.samples = 4;
    Execution execution;
    execution.threads = threads;
    rays = draw_camera_rays({{&scene, {}}}, unknowns->bounds(), settings, execution);
    model.unknowns = unknowns.get();
    for (int c = 0; c < channels; ++c)
      model.channels.push_back(
          {&rays, channel_source(scene.scene, static_cast<std::size_t>(c)), c == 0 ? 1 : 0.7});
  }
  static Scene hot_scene() {
    Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
    scene.camera.sensor = {20, 20, 0.5e-3};
    FlameSpec flame;
    flame.kind = FlameKind::vdb;
    flame.file = "hot.vdb";
    scene.flames = {flame};
    scene.channels = {{"650nm", ChannelKind::band, 650e-9, 10e-9},
                      {"850nm", ChannelKind::band, 850e-9, 10e-9}};
    return scene;
  }
};

/// Half of the stop behind a filter that passes red better than orange.
Problem filtered_problem() {
  Scene scene = Problem::hot_scene();
  PupilFilterSpec half{"half"};
  half.extent = std::acos(-1.0);
  half.transmission = "600 nm 0.1, 700 nm 0.9";
  scene.camera.pupil_filters = {half};
  scene.channels[0].width = 60e-9;
  Problem p(60, 1, 2, scene);
  p.model.channels[0].parts = {thermal_parts(p.scene.scene, 0)};
  for (ThermalPart& part : p.model.channels[0].parts[0]) part.absorption_ratio = 1;  // it is grey
  return p;
}

// The table against the function and its slope, by nodes' own formulas.
TEST(SourceTable, IsTheSourceFunctionToAPartInAHundredMillion) {
  for (const SourceFunction& source :
       {SourceFunction::band(431e-9, 10e-9), SourceFunction::band(850e-9, 100e-9),
        SourceFunction::total()}) {
    const SourceTable table(source);
    for (double t = 210.37; t < 5990; t *= 1.0173) {
      EXPECT_TRUE(relative(table.at(t).source, source(t), 3e-8)) << t;
      EXPECT_TRUE(relative(table.at(t).slope, source_slope(source, t), 1e-6)) << t;
      if (t > 1000) {
        EXPECT_TRUE(relative(table.at(t).source, source(t), 1e-11)) << t;
      }
    }
    for (const double beyond : {0.0, 150.0, 7000.0})
      EXPECT_EQ(table.at(beyond).source, source(beyond));
  }
}

// Every pixel: some see the filter, some the open half, some both. The renderer knows each part by
// its spectral nodes. Fails when one source function stands for all parts.
TEST(ThermalModel, IsThePictureThroughFilters) {
  const Problem p = filtered_problem();
  RenderSettings settings;
  settings.samples = 4;
  settings.skip = false;
  settings.control_variate = false;
  settings.precision = Precision::double_precision;
  const Image flux = render(p.scene, settings).light_field.channels[0].flux;
  const std::vector<double> b = thermal_fluxes(p.model, p.grids.variables());
  int lit = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const CameraRays::Row& row = p.rays.rows[i];
    const double expected = static_cast<double>(flux.at(row.column, row.row));
    if (!(expected > 0)) continue;
    EXPECT_TRUE(relative(b[i], expected, 1e-6)) << row.column << ", " << row.row;
    ++lit;
  }
  EXPECT_GT(lit, 50);
  EXPECT_GT(p.model.channels[0].parts[0][0].source.wavelength(), 652e-9);
}

// Every pixel, thin and thick: the same rays, the same quadrature, the source function at the
// interpolated temperature. Fails when it is interpolated instead.
TEST(ThermalModel, IsThePictureOfTheGrids) {
  for (const double thickest : {3.0, 200.0}) {
    const Problem p(thickest);
    RenderSettings settings;
    settings.samples = 4;
    settings.skip = false;
    settings.control_variate = false;
    settings.precision = Precision::double_precision;
    const RenderResult picture = render(p.scene, settings);
    const Image& flux = picture.light_field.channels[0].flux;
    const std::vector<double> b = thermal_fluxes(p.model, p.grids.variables());
    int lit = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
      const CameraRays::Row& row = p.rays.rows[i];
      const double expected = static_cast<double>(flux.at(row.column, row.row));
      if (expected > 0)
        EXPECT_TRUE(relative(b[i], expected, 1e-6)) << row.column << ", " << row.row;
      else  // pictures hold single precision: less is 0
        EXPECT_LT(b[i], static_cast<double>(std::numeric_limits<float>::min()));
      lit += expected > 0;
    }
    EXPECT_GT(lit, 40);
  }
}

// J v against differences of the model, by Richardson's rule of fourth order: a direction of
// temperatures, one of absorptions, thin and thick, two channels. Signs change between rows in the
// thick medium. Fails when the light from behind is forgotten.
TEST(ThermalModel, DerivativeAgreesWithDifferences) {
  for (const double thickest : {3.0, 200.0}) {
    const Problem p(thickest, 2);
    const std::vector<double> x = p.grids.variables();
    const auto j = make_thermal_derivative(p.model, x);
    const std::vector<double> flux = thermal_fluxes(p.model, x);
    const std::size_t n = p.unknowns->size();
    for (const bool hotter : {true, false}) {
      std::vector<double> v(x.size(), 0.0);
      const std::vector<double> shape = random_vector(n, 3);
      for (std::size_t k = 0; k < n; ++k)
        v[hotter ? k : n + k] = hotter ? 100 * std::fabs(shape[k]) : std::fabs(shape[k]);
      const auto at = [&](double h) {
        std::vector<double> moved = x;
        for (std::size_t k = 0; k < x.size(); ++k) moved[k] += h * v[k];
        return thermal_fluxes(p.model, moved);
      };
      const double h = 1e-3;
      const auto a = at(h), b = at(-h), c = at(2 * h), d = at(-2 * h);
      const std::vector<double> jv = *j * v;
      for (std::size_t i = 0; i < jv.size(); ++i) {
        const double expected = (8 * (a[i] - b[i]) - (c[i] - d[i])) / (12 * h);
        EXPECT_TRUE(within(jv[i], expected, 1e-7, hotter ? expected : flux[i])) << thickest;
      }
    }
  }
}

TEST(ThermalModel, TransposeIsExactAndStoredAgrees) {
  for (const double thickest : {3.0, 200.0}) {
    const Problem p(thickest, 2);
    const std::vector<double> x = p.grids.variables();
    const auto j = make_thermal_derivative(p.model, x);
    const std::vector<double> u = random_vector(j->columns(), 1), y = random_vector(j->rows(), 2);
    const std::vector<double> ju = *j * u, jty = transposed_times(*j, y);
    double left = 0, right = 0, size = 0;
    for (std::size_t i = 0; i < y.size(); ++i)
      left += ju[i] * y[i], size += std::fabs(ju[i] * y[i]);
    for (std::size_t k = 0; k < u.size(); ++k) right += u[k] * jty[k];
    EXPECT_TRUE(within(left, right, 1e-12, size));
    const CsrMatrix<float> matrix = make_thermal_matrix(p.model, x);
    EXPECT_TRUE(relative(static_cast<double>(estimated_entries(p.model, x)),
                         static_cast<double>(matrix.entries()), 0.2));
    const std::vector<double> stored = *make_csr_operator(matrix) * u;
    double scale = 0;
    for (const double value : ju) scale = std::max(scale, std::fabs(value));
    for (std::size_t i = 0; i < ju.size(); ++i) EXPECT_TRUE(within(stored[i], ju[i], 1e-6, scale));
  }
}

TEST(ThermalModel, IsTheSameForAnyNumberOfThreads) {
  const Problem p(200, 2);
  const std::vector<double> x = p.grids.variables(), y = random_vector(p.model.rows(), 5);
  Execution one, two;
  one.threads = 1;
  two.threads = 2;
  EXPECT_EQ(thermal_fluxes(p.model, x, one), thermal_fluxes(p.model, x, two));
  EXPECT_EQ(transposed_times(*make_thermal_derivative(p.model, x, one), y),
            transposed_times(*make_thermal_derivative(p.model, x, two), y));
}

// Known fields are no variables; a place that does not absorb does not shine.
TEST(ThermalModel, KnownFieldsAndEmptyPlaces) {
  Problem p(50);
  const std::vector<double> x = p.grids.variables(), flux = thermal_fluxes(p.model, x);
  const auto n = static_cast<std::ptrdiff_t>(p.unknowns->size());
  ThermalModel known = p.model;
  known.absorption = p.grids.absorption;
  EXPECT_EQ(known.columns(), p.unknowns->size());
  const std::vector<double> hot =
      thermal_fluxes(known, std::vector<double>(x.begin(), x.begin() + n));
  known = p.model;
  known.temperature = p.grids.temperature;
  const std::vector<double> thick =
      thermal_fluxes(known, std::vector<double>(x.begin() + n, x.end()));
  for (std::size_t i = 0; i < flux.size(); ++i) {
    EXPECT_TRUE(relative(hot[i], flux[i], 1e-12));
    EXPECT_TRUE(relative(thick[i], flux[i], 1e-12));
  }
  p.model.absorbs.assign(p.unknowns->size(), 0);
  for (const double value : thermal_fluxes(p.model, x)) EXPECT_EQ(value, 0);
  EXPECT_THROW(thermal_fluxes(p.model, std::vector<double>(3)), UsageError);
  p.model.absorbs.resize(2);
  EXPECT_THROW(thermal_fluxes(p.model, x), UsageError);
}

TEST(ThermalModel, SlopeOfTheSourceFunction) {
  for (const SourceFunction& source :
       {SourceFunction::band(650e-9, 50e-9), SourceFunction::total()})
    for (const double t : {400.0, 1000.0, 1800.0, 3000.0}) {
      const double h = 1e-3 * t;
      const double expected =
          (8 * (source(t + h) - source(t - h)) - (source(t + 2 * h) - source(t - 2 * h))) /
          (12 * h);
      // The next term of the differences: (h / 2)^4 of the fifth derivative, 50^5 / 120 at 400 K.
      EXPECT_TRUE(relative(source_slope(source, t), expected, t < 1000 ? 1e-6 : 1e-8)) << t;
    }
  EXPECT_EQ(source_slope(SourceFunction::total(), 0), 0);
}

}  // namespace
}  // namespace plenoflame::test::thermal_model_test
