// Round flames: chords of published and computed cases, rings from one camera, signal trapping.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <numbers>

#include "core/media_voxel/voxel_fixture.h"
#include "plenoflame/base/error.h"
#include "plenoflame/inverse/csr_matrix.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/measurement.h"
#include "plenoflame/inverse/penalty.h"
#include "plenoflame/inverse/solvers.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"
#include "validation/cases.h"

namespace plenoflame::test::axial_cases_test {
namespace {

CameraRays parallel_chords(const std::vector<double>& offsets) {
  std::vector<Ray> rays;
  for (const double b : offsets) rays.push_back({{b, -1, 0}, {0, 1, 0}});
  return rows_of(rays);
}

// Total radiation of Sun et al.'s cylinder, with r^2 / (2 L^2 / H) + z over H as the angle.
TEST(CaseA, ChordsOfTheCylinder) {
  struct Chord {
    double z, b, radiance;
  };
  for (const Chord& c : {Chord{0.075, 0, 1.848389e4}, Chord{0.075, 0.04, 2.332503e4},
                         Chord{0.150, 0, 5.455767e4}, Chord{0.150, 0.04, 6.444354e4},
                         Chord{0.225, 0, 1.128648e5}, Chord{0.225, 0.04, 1.246575e5}}) {
    const auto t = [&](double r) {
      return 1800 * std::sin(r * r / (2 * 0.08 * 0.08) + c.z / 0.3) + 273.15;
    };
    const double found =
        chords(fine_rings(0.08, 20000), t, 8, SourceFunction::total(), parallel_chords({c.b}))[0];
    EXPECT_TRUE(relative(found, c.radiance, 1e-6)) << c.z << " " << c.b;
    note("z " + std::to_string(std::lround(1e3 * c.z)) + " mm b " +
             std::to_string(std::lround(1e3 * c.b)) + " mm",
         c.radiance, found);
  }
}

/// Sun et al.'s camera before the middle of their cylinder, with microlenses of one focal length or
/// of three.
Scene cylinder_camera(bool three) {
  Scene scene;
  scene.camera.lens.model = LensModel::ideal;
  scene.camera.lens.focal_length = 50e-3;
  scene.camera.lens.diameter = 11.5e-3;
  ArraySpec& array = scene.camera.array;
  array.present = true;
  array.lattice = Lattice::hexagonal;
  array.model = LensModel::ideal;
  array.pitch = array.diameter = 95e-6;
  array.sensor_distance = 0.44e-3;
  const std::vector<double> foci =
      three ? std::vector<double>{0.65e-3, 0.60e-3, 0.55e-3} : std::vector<double>{0.60e-3};
  array.types.clear();
  for (const double focus : foci) {
    array.types.emplace_back();
    array.types.back().name = "f" + std::to_string(std::lround(1e6 * focus));
    array.types.back().focal_length = focus;
  }
  scene.camera.sensor = {360, 360, 8e-6};  // half of each side of theirs
  scene.camera.focus.mode = FocusMode::distance;
  scene.camera.focus.lens_distance = 54.14e-3;
  scene.channels = {{"total", ChannelKind::total}};
  return scene;
}

constexpr double kCylinderRadius = 80e-3, kCylinderHeight = 300e-3, kCylinderDistance = 482e-3;

double cylinder_temperature(Vec3 p) {
  const double r = std::hypot(p.x - kCylinderDistance, p.y), z = p.z + kCylinderHeight / 2;
  return 1800 * std::sin(r * r / (2 * kCylinderRadius * kCylinderRadius) + z / kCylinderHeight) +
         273.15;
}

/// The cylinder as voxels of 2 mm, for the renderer, which knows nothing of rings.
std::shared_ptr<const Medium> cylinder_of_voxels(const std::vector<SourceFunction>& channels) {
  constexpr double kSpacing = 2e-3;
  const int half = static_cast<int>(kCylinderRadius / kSpacing) + 1,
            top = static_cast<int>(kCylinderHeight / (2 * kSpacing));
  const AffineTransform map = scaled(kSpacing, {kCylinderDistance, 0, 0});
  const auto field = [&](const std::function<double(Vec3)>& value, float background) {
    return make_field(
        {-half, -half, -top}, {half + 1, half + 1, top + 1},
        [&](int i, int j, int k) {
          return static_cast<float>(value(
              map.point({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})));
        },
        map, background);
  };
  // It fades out over the voxel at its edge.
  const auto absorption = [](Vec3 p) {
    const double inside = kCylinderRadius - std::hypot(p.x - kCylinderDistance, p.y);
    return 8 * std::clamp(inside / kSpacing + 0.5, 0.0, 1.0);
  };
  return make_voxel_medium(field(cylinder_temperature, 300), field(absorption, 0),
                           VoxelInterpolation::trilinear, channels);
}

/// Temperature error of rings that are seen, by LSQR at the iteration that is best by the truth,
/// mean of draws of noise of 30 and of 20 dB, in a rendered picture.
std::array<double, 2> cylinder_errors(bool three) {
  constexpr int kDraws = 3, kBin = 4;
  const CompiledScene scene = compile(cylinder_camera(three));
  RingGrid grid;
  grid.base = {kCylinderDistance, 0, -kCylinderHeight / 2};
  grid.rings = grid.heights = 10;
  grid.radial_step = kCylinderRadius / grid.rings;
  grid.height_step = kCylinderHeight / (grid.heights - 1);
  const auto rings = make_ring_unknowns(grid);
  std::vector<double> truth;
  for (std::size_t j = 0; j < rings->size(); ++j)
    truth.push_back(cylinder_temperature(rings->place(j)));
  CameraRaySettings how;
  how.samples = 2;
  how.bin = kBin;
  const CameraRays rays = draw_camera_rays({{&scene, {}}}, rings->bounds(), how);
  Scene lit = cylinder_camera(three);
  lit.flames.emplace_back().kind = FlameKind::vdb;
  lit.flames.back().file = "cylinder.vdb";
  const CompiledScene flame = compile(
      lit, [](const FlameSpec&, const std::string&, const std::vector<SourceFunction>& channels,
              const Execution&) { return cylinder_of_voxels(channels); });
  RenderSettings settings;
  settings.samples = 4;
  settings.seed = 77;
  const std::vector<double> clean =
      measured_rows({take_measurement(render(flame, settings).light_field, lit, 0, 1e-3)}, rays,
                    kBin)
          .flux;
  const SourceFunction total = SourceFunction::total();
  const EmissionProblem problem{&rays, rings.get(), RowModel::source,
                                std::vector<double>(rings->size(), 8.0)};
  const CsrMatrix<float> matrix = make_emission_matrix(problem, {});
  const auto a = make_csr_operator(matrix, {});
  if (clean.size() != a->rows()) throw Error("the picture has other rows than the matrix");
  const std::vector<double> seen = transposed_times(*a, std::vector<double>(a->rows(), 1.0));
  const double most = *std::max_element(seen.begin(), seen.end());
  std::array<double, 2> sums{};
  for (std::uint64_t draw = 0; draw < 2 * kDraws; ++draw) {
    const double sigma = sigma_of(clean, draw % 2 == 0 ? 30 : 20);
    std::vector<double> b = clean;
    for (std::size_t i = 0; i < b.size(); ++i) b[i] += sigma * NoiseStream(draw, i).gaussian();
    double best = 1e300;
    SolverOptions options;
    options.iterations = 60;
    options.watch = [&](int, double, std::span<const double> x) {
      double error = 0, count = 0;
      for (std::size_t j = 0; j < x.size(); ++j) {
        if (seen[j] < 0.02 * most) continue;
        error += std::fabs(temperature_of(total, std::max(x[j], total(300))) / truth[j] - 1);
        ++count;
      }
      best = std::min(best, error / count);
    };
    solve_lsqr({a.get(), b}, {}, options);
    sums[draw % 2] += best / kDraws;
  }
  return sums;
}

// The source claims that one focus errs less than three, at 30 and at 20 dB. What is true: they err
// alike, within a tenth; more noise errs more. Nothing in the rows prefers either: a row is a block
// of pixels, through whose microlenses rays of all depths come.
TEST(CaseA, OneFocusErrsAsThree) {
  const auto one = cylinder_errors(false), three = cylinder_errors(true);
  constexpr std::array<double, 2> kOnThePage{0.125, 0.128};
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_TRUE(relative(one[k], kOnThePage[k], 0.05));
    EXPECT_TRUE(relative(one[k], three[k], 0.1));
  }
  EXPECT_GT(one[1], one[0]);
  EXPECT_GT(three[1], three[0]);
}

TEST(CaseB, ChordsOfTheHotRing) {
  struct Chord {
    double z, b, thin610, thin650, thick610, thick650;
  };
  for (const Chord& c : {Chord{0.04, 0, 1.244813e9, 1.876433e9, 3.126932e9, 4.712361e9},
                         Chord{0.04, 0.01, 1.791651e9, 2.641299e9, 4.626050e9, 6.821467e9},
                         Chord{0.10, 0, 1.960162e9, 2.887423e9, 4.782684e9, 7.046685e9},
                         Chord{0.10, 0.01, 8.618160e7, 1.489521e8, 2.214295e8, 3.827734e8},
                         Chord{0.16, 0, 1.058900e6, 2.384379e6, 2.563864e6, 5.774463e6}}) {
    const CameraRays rays = parallel_chords({c.b});
    const auto t = [&](double r) { return hot_ring(r, c.z); };
    const auto look = [&](double kappa, double wavelength, double expected) {
      const double found = chords(fine_rings(20e-3, 20000), t, kappa, planck(wavelength), rays)[0];
      EXPECT_TRUE(relative(found, expected, 1e-6)) << c.z << " " << c.b << " " << kappa;
      note("z " + std::to_string(std::lround(1e3 * c.z)) + " mm b " +
               std::to_string(std::lround(1e3 * c.b)) + " mm kappa " +
               std::to_string(std::lround(kappa)) + " at " +
               std::to_string(std::lround(1e9 * wavelength)) + " nm",
           expected, found);
    };
    look(8, 610e-9, c.thin610);
    look(8, 650e-9, c.thin650);
    look(30, 610e-9, c.thick610);
    look(30, 650e-9, c.thick650);
  }
}

// Homogeneous cylinder in closed form, S (1 - e^(-2 kappa sqrt(R^2 - b^2))).
TEST(CaseC, HomogeneousCylinder) {
  constexpr double kRadius = 20e-3;
  for (const double kappa : {0.5, 8.0, 100.0})
    for (const double b : {0.0, 7e-3, 15e-3}) {
      const double half = std::sqrt(kRadius * kRadius - b * b);
      const double expected = planck(650e-9)(1700) * -std::expm1(-2 * kappa * half);
      const double found = chords(
          fine_rings(kRadius, 20000), [](double) { return 1700.0; }, kappa, planck(650e-9),
          parallel_chords({b}))[0];
      EXPECT_TRUE(relative(found, expected, 2e-6)) << kappa << " " << b;
      note("kappa " + std::to_string(kappa) + " b " + std::to_string(b), expected, found);
    }
}

/// Errors of a reconstruction as rings of case B's slice at 60 mm.
struct RingErrors {
  double emission = 0, temperature = 0;
};

/// Least squares without a penalty, mean of 200 draws of noise: 60 chords, 11 directions within
/// +-3.4 deg.
RingErrors rings_of_one_camera(int rings, double decibels) {
  constexpr double kRadius = 20e-3, kHalfAngle = 3.4 * std::numbers::pi / 180;
  constexpr int kDraws = 200;
  std::vector<Ray> lines;
  for (int m = 0; m < 60; ++m)
    for (int s = 0; s < 11; ++s) {
      const double slope = std::tan(kHalfAngle) * (s - 5) / 5;
      const Vec3 d = normalize(Vec3{slope, 1, 0});
      const Vec3 through{(m + 0.5) / 60 * kRadius, 0, 0};
      lines.push_back({through - 0.5 * d, d});
    }
  const CameraRays rays = rows_of(lines);
  const auto temperature = [](double r) { return hot_ring(r, 60e-3); };
  const std::vector<double> clean =
      chords(fine_rings(kRadius, 4000), temperature, 8, planck(650e-9), rays);
  RingGrid grid = fine_rings(kRadius, rings);
  grid.radial_step = kRadius / rings;
  const auto unknowns = make_ring_unknowns(grid);
  const EmissionProblem problem{&rays, unknowns.get(), RowModel::source,
                                std::vector<double>(static_cast<std::size_t>(rings), 8.0)};
  const auto a = make_emission_operator(problem, {});
  Eigen::MatrixXd dense(clean.size(), rings);
  for (int j = 0; j < rings; ++j) {
    std::vector<double> one(static_cast<std::size_t>(rings), 0.0);
    one[static_cast<std::size_t>(j)] = 1;
    const std::vector<double> column = *a * one;
    dense.col(j) = Eigen::Map<const Eigen::VectorXd>(column.data(), dense.rows());
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(dense);
  const double sigma = sigma_of(clean, decibels);
  RingErrors errors;
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXd b(dense.rows());
    for (Eigen::Index i = 0; i < b.size(); ++i)
      b[i] = clean[static_cast<std::size_t>(i)] +
             sigma * NoiseStream(static_cast<std::uint64_t>(draw), static_cast<std::uint64_t>(i))
                         .gaussian();
    const Eigen::VectorXd x = qr.solve(b);
    double away = 0, all = 0, away_t = 0, weight = 0;
    for (int j = 0; j < rings; ++j) {
      const double t = temperature(j * grid.radial_step), s = planck(650e-9)(t);
      const double area = unknowns->volume(static_cast<std::size_t>(j));
      away += area * (x[j] - s) * (x[j] - s);
      all += area * s * s;
      away_t += area * s * std::fabs(temperature_of(planck(650e-9), x[j]) / t - 1);
      weight += area * s;
    }
    errors.emission += std::sqrt(away / all) / kDraws;
    errors.temperature += away_t / weight / kDraws;
  }
  return errors;
}

// The optimum at 20 rings, discretisation against noise, is the point of the case. The published
// temperatures' weights are not told in full: they are noted, not tested.
TEST(CaseF, RingsOfOneCamera) {
  struct Row {
    int rings;
    double quiet, quiet_t, noisy, noisy_t;
  };
  std::vector<RingErrors> found;
  for (const Row& row :
       {Row{10, 0.080, 0.0076, 0.089, 0.0108}, Row{20, 0.035, 0.0029, 0.095, 0.0098},
        Row{40, 0.059, 0.0055, 0.185, 0.0207}}) {
    const RingErrors quiet = rings_of_one_camera(row.rings, 30),
                     noisy = rings_of_one_camera(row.rings, 20);
    const std::string name = std::to_string(row.rings) + " rings ";
    note(name + "30 dB emission", row.quiet, quiet.emission);
    note(name + "30 dB temperature", row.quiet_t, quiet.temperature);
    note(name + "20 dB emission", row.noisy, noisy.emission);
    note(name + "20 dB temperature", row.noisy_t, noisy.temperature);
    EXPECT_TRUE(relative(quiet.emission, row.quiet, 0.2)) << name;
    EXPECT_TRUE(relative(noisy.emission, row.noisy, 0.2)) << name;
    found.push_back(quiet);
  }
  EXPECT_LT(found[1].emission, found[0].emission);
  EXPECT_LT(found[1].emission, found[2].emission);
  EXPECT_LT(found[1].temperature, found[0].temperature);
  EXPECT_LT(found[1].temperature, found[2].temperature);
}

/// RMS error over the peak of the emission, with kappa as it is or taken for 0.
double trapped(double strength, bool trapping) {
  constexpr int kRings = 80;
  RingGrid grid;
  grid.rings = kRings;
  grid.heights = 1;
  grid.radial_step = 1.0 / kRings;
  grid.height_step = 1;
  const auto unknowns = make_ring_unknowns(grid);
  std::vector<double> emission, kappa;
  double peak = 0;
  for (int i = 0; i < kRings; ++i) {
    const double x = static_cast<double>(i) / kRings;
    const double f =
        std::exp(-std::pow((x - 0.55) / 0.12, 2)) + 0.3 * std::exp(-std::pow(x / 0.3, 2));
    const double t = 1700 + 200 * std::exp(-std::pow((x - 0.6) / 0.25, 2));
    kappa.push_back(1.2 * f);
    emission.push_back(f * planck(660e-9)(t));
    peak = std::max(peak, emission.back());
  }
  for (double& value : emission) value /= peak;
  std::vector<double> offsets;
  for (int i = 0; i < kRings; ++i) offsets.push_back(static_cast<double>(i) / kRings);
  const CameraRays rays = parallel_chords(offsets);
  const auto full = make_emission_operator({&rays, unknowns.get(), RowModel::emission, kappa}, {});
  const auto clear = make_emission_operator({&rays, unknowns.get(), RowModel::emission, {}}, {});
  std::vector<double> b = *full * emission;
  const double sigma = 0.01 * *std::max_element(b.begin(), b.end());
  for (std::size_t i = 0; i < b.size(); ++i) b[i] += sigma * NoiseStream(4, i).gaussian();
  const LinearOperator& a = trapping ? *full : *clear;
  const auto penalty = make_penalty({{kRings, 1, 1}});
  SolverOptions options;
  options.iterations = 2000;
  options.relative_change = 1e-10;
  const Solution found = solve_cgls(
      {&a, b}, {penalty.get(), strength * a.squared_norm({}) / penalty->squared_norm({})}, options);
  double sum = 0;
  for (std::size_t j = 0; j < emission.size(); ++j) sum += std::pow(found.x[j] - emission[j], 2);
  return std::sqrt(sum / kRings);
}

// Below 4 % of the peak, and at least twice as bad where trapping is ignored.
TEST(CaseD, SignalTrapping) {
  const double best = trapped(10, true), weak = trapped(0.1, true), ignored = trapped(10, false);
  EXPECT_LT(best, 0.04);
  EXPECT_GT(ignored, 2 * best);
  EXPECT_TRUE(relative(ignored, 0.14, 0.15));
  note("RMS at strength 10", 0.0112, best);
  note("RMS at strength 0.1", 0.0307, weak);
  note("RMS without trapping", 0.14, ignored);
}

}  // namespace
}  // namespace plenoflame::test::axial_cases_test
