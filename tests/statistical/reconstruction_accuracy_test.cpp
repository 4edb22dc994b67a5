// Reconstructions of pictures that share neither formulas nor grid with what is solved for: the
// renderer's, of a flame on a grid four times finer, by the estimator that shares no sampling code
// with the rays of the reconstruction.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/inverse/glowing_grid.h"
#include "plenoflame/inverse/reconstruction.h"
#include "plenoflame/inverse/unknowns.h"
#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::reconstruction_accuracy_test {
namespace {

constexpr double kRadius = 4.5e-3, kHalfHeight = 9e-3;
constexpr int kRings = 9, kHeights = 13;

/// A hollow flame that fades towards its ends [W/(m^3 sr)].
double glow(Vec3 p) {
  const double r = std::hypot(p.x - 1, p.y) / kRadius, z = p.z / kHalfHeight;
  if (r >= 1 || std::fabs(z) >= 1) return 0;
  return 1000 * std::exp(-4 * (r - 0.4) * (r - 0.4)) * (1 - r * r) * (1 - z * z) * (1 - z * z);
}

/// Its integral over space [W/sr], by the midpoint rule.
double light_of_glow() {
  constexpr int kSteps = 400;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int k = 0; k < kSteps; ++k) {
      const double r = (i + 0.5) / kSteps * kRadius;
      sum += r * glow({1 + r, 0, ((k + 0.5) / kSteps * 2 - 1) * kHalfHeight});
    }
  return 2 * std::numbers::pi * sum * kRadius / kSteps * 2 * kHalfHeight / kSteps;
}

/// One camera in front of the flame on voxels of a quarter of a ring's width and height.
CompiledScene glowing_scene() {
  GlowingGrid g;
  g.count = {4 * 2 * kRings + 1, 4 * 2 * kRings + 1, 4 * (kHeights - 1) + 1};
  const double across = kRadius / (4 * kRings), up = 2 * kHalfHeight / (g.count[2] - 1);
  g.map.linear = {{{{across, 0, 0}, {0, across, 0}, {0, 0, up}}}};
  g.map.translation = {1 - kRadius, -kRadius, -kHalfHeight};
  for (int i = 0; i < g.count[0]; ++i)
    for (int j = 0; j < g.count[1]; ++j)
      for (int k = 0; k < g.count[2]; ++k)
        g.emission.push_back(glow(g.map.translation + Vec3{i * across, j * across, k * up}));
  g.absorption.assign(g.emission.size(), 0.0);
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.camera.sensor = {40, 60, 0.25e-3};
  scene.flames = {glowing_flame()};
  scene.channels = {{"430nm", ChannelKind::band, 430e-9, 20e-9}};
  return compile(scene, glowing_loader(g));
}

struct Experiment {
  CompiledScene scene = glowing_scene();
  std::unique_ptr<Unknowns> unknowns;
  std::vector<double> truth;

  Experiment() {
    RingGrid grid;
    grid.base = {1, 0, -kHalfHeight};
    grid.radial_step = kRadius / kRings;
    grid.height_step = 2 * kHalfHeight / (kHeights - 1);
    grid.rings = kRings;
    grid.heights = kHeights;
    unknowns = make_ring_unknowns(grid);
    for (std::size_t j = 0; j < unknowns->size(); ++j) truth.push_back(glow(unknowns->place(j)));
  }
  double error(const std::vector<double>& values) const {
    double away = 0, all = 0;
    for (std::size_t j = 0; j < truth.size(); ++j) {
      away += unknowns->volume(j) * std::pow(values[j] - truth[j], 2);
      all += unknowns->volume(j) * std::pow(truth[j], 2);
    }
    return std::sqrt(away / all);
  }
};

// The picture is made of bundles that leave the flame. What its pixels scatter, and what the rays
// of the rows do, are the noise. Fails where rows and pictures disagree about the light that a
// flame gives, by as little as 3 %.
TEST(ReconstructionAccuracy, RingsOfAPictureOfTheForwardEstimator) {
  const Experiment e;
  RenderSettings how;
  how.estimator = Estimator::forward;
  how.samples = 2000000;
  const LightFieldChannel picture = render(e.scene, how).light_field.channels[0];
  // Bundles that are few tell their scatter badly: one deviation for all pixels that see any.
  double squares = 0, lit = 0;
  for (const float s : picture.standard_error.pixels) {
    squares += static_cast<double>(s) * static_cast<double>(s);
    lit += s > 0;
  }
  Measurement m;
  m.window = {0, 0, picture.flux.width, picture.flux.height};
  m.flux = picture.flux;
  m.deviation =
      Image(picture.flux.width, picture.flux.height, static_cast<float>(std::sqrt(squares / lit)));
  ReconstructionInput input;
  input.views = {{&e.scene, {}}};
  input.measurements = {m};
  input.unknowns = e.unknowns.get();
  ReconstructionSettings settings;
  settings.rays.samples = 192;
  settings.draws = settings.probes = 0;
  const Reconstruction found = reconstruct(input, settings);
  double light = 0;
  for (std::size_t j = 0; j < e.truth.size(); ++j) light += e.unknowns->volume(j) * found.values[j];
  EXPECT_LT(e.error(found.values), 0.15);
  EXPECT_TRUE(relative(light, light_of_glow(), 0.01));
}

// The whole chain anew each time: rays of the picture, whose standard errors are those of two
// replicates, and rays of the reconstruction. Stated deviations hold the scatter and most of the
// error: smoothing and the grid take from each picture alike. The grid is too coarse for this
// flame, and the error 1.6 of the stated deviation.
TEST(ReconstructionAccuracy, DeviationsHoldTheErrorsOfRepeatedPictures) {
  const Experiment e;
  constexpr int kRuns = 8;
  ReconstructionSettings settings;
  settings.rays.samples = 64;
  settings.probes = 0;
  const std::size_t n = e.truth.size();
  const double brightest = *std::max_element(e.truth.begin(), e.truth.end());
  std::vector<double> sum(n), squares(n);
  double stated = 0, error = 0, scatter = 0;
  for (int run = 0; run < kRuns; ++run) {
    RenderSettings how;
    how.samples = 64;
    how.seed = 7000 + static_cast<std::uint64_t>(run);
    ReconstructionInput input;
    input.views = {{&e.scene, {}}};
    input.measurements = {take_measurement(render(e.scene, how).light_field, e.scene.scene, 0, 0)};
    input.unknowns = e.unknowns.get();
    settings.rays.seed = 500 + static_cast<std::uint64_t>(run);
    const Reconstruction found = reconstruct(input, settings);
    settings.strength = found.strength;
    for (std::size_t j = 0; j < n; ++j) {
      if (e.truth[j] < 0.1 * brightest) continue;
      sum[j] += found.at_places[j];
      squares[j] += std::pow(found.at_places[j], 2);
      stated += std::pow(found.deviation[j], 2) / kRuns;
      error += std::pow(found.at_places[j] - e.truth[j], 2) / kRuns;
    }
  }
  for (std::size_t j = 0; j < n; ++j)
    scatter += (squares[j] - sum[j] * sum[j] / kRuns) / (kRuns - 1);
  std::printf("error %.3f, scatter %.3f of the stated deviation\n", std::sqrt(error / stated),
              std::sqrt(scatter / stated));
  EXPECT_GT(error, 0.25 * stated);
  EXPECT_LT(error, 3.3 * stated);
  EXPECT_LT(scatter, stated);
}

}  // namespace
}  // namespace plenoflame::test::reconstruction_accuracy_test
