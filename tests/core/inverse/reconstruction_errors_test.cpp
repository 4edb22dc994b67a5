// Reconstructions whose errors are measured: many of them, or on fine grids.
#include "plenoflame/inverse/reconstruction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "core/inverse/glow_rig.h"
#include "plenoflame/base/error.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/flame_estimate.h"
#include "plenoflame/inverse/light_behind.h"
#include "plenoflame/render/render.h"
#include "plenoflame/sampling/noise.h"
#include "support/approx.h"

namespace plenoflame::test::reconstruction_errors_test {
namespace {

// A matrix that does not fit is refused before rays are drawn, as progress tells; the number is no
// more than what it takes.
TEST(Reconstruction, RefusesAMatrixBeforeRaysAreDrawn) {
  Rig rig = ring_rig();
  const ReconstructionInput input = rig.input(1e-3);
  rig.settings.form = OperatorForm::matrix;
  rig.settings.strength = 1e-4;
  rig.settings.iterations = 1;
  const double bytes = reconstruct(input, rig.settings).matrix_bytes;
  int calls = 0;
  Execution execution;
  execution.progress = [&](const Progress&) { ++calls; };
  const auto refused = [&](double memory) -> std::string {
    rig.settings.memory = memory;
    try {
      reconstruct(input, rig.settings, execution);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string message = refused(0.5 * bytes);
  EXPECT_EQ(calls, 0);
  EXPECT_NE(message.find("at least"), std::string::npos) << message;
  EXPECT_NE(message.find("'drawn'"), std::string::npos) << message;
  rig.settings.form = OperatorForm::automatic;
  rig.settings.solver = ReconstructionSolver::sart;
  EXPECT_NE(refused(0.5 * bytes).find("another solver"), std::string::npos);
  EXPECT_EQ(calls, 0);
  EXPECT_EQ(refused(1.5 * bytes), "");
  EXPECT_GT(calls, 0);
}

// The second camera, at right angles, tells depths apart that the first one can't; it also resolves
// more of the unknowns.
TEST(Reconstruction, TwoCamerasKnowMoreThanOne) {
  Rig one = voxel_rig(false), two = voxel_rig(true);
  one.settings.probes = two.settings.probes = 4;
  one.settings.strength = two.settings.strength = 3e-5;
  one.settings.ray_noise = two.settings.ray_noise = true;
  const Reconstruction single = reconstruct(one.finer_input(0.01), one.settings),
                       both = reconstruct(two.finer_input(0.01), two.settings);
  EXPECT_LT(two.error(both.values), 0.7 * one.error(single.values));
  EXPECT_GT(both.resolved_unknowns, 1.3 * single.resolved_unknowns);
  for (const double r : both.resolved) EXPECT_TRUE(r >= 0 && r <= 1);
}

// Stated deviations are the errors, of a flame that is no sum of the samples' hats; the scatter of
// what is found of new noise is a part of them (statistical/flame_families_test.cpp: of families).
TEST(Reconstruction, DeviationsAreTheErrors) {
  Rig rig = ring_rig();
  // Without a cusp on the axis and with ends within the rings: a prior draws no cusps.
  rig.field = [](Vec3 p) {
    const double x = (p.x - 1) / 4e-3, y = p.y / 4e-3, q = x * x + y * y, z = p.z / 9e-3;
    const auto end = [](double s) { return std::pow(std::max(0.0, 1 - s), 2); };
    return 1500 * std::exp(-6 * (q - 0.2) * (q - 0.2)) * end(q) * end(z * z);
  };
  rig.set_truth();
  rig.settings.ray_noise = true;
  rig.settings.rays.samples = 256;
  rig.settings.draws = 30;
  const Reconstruction stated = reconstruct(rig.finer_input(0.01), rig.settings);
  rig.settings.draws = 0;
  rig.settings.strength = stated.strength;
  std::vector<double> sum(rig.truth.size()), squares(rig.truth.size());
  constexpr int kRuns = 4;
  for (int run = 0; run < kRuns; ++run) {
    const Reconstruction again =
        reconstruct(rig.finer_input(0.01, 100 + static_cast<std::uint64_t>(run)), rig.settings);
    for (std::size_t j = 0; j < sum.size(); ++j) {
      sum[j] += again.at_places[j];
      squares[j] += again.at_places[j] * again.at_places[j];
    }
  }
  double pulls = 0, lit = 0, own = 0, scatter = 0;
  for (std::size_t j = 0; j < sum.size(); ++j) {
    if (rig.truth[j] < 50) continue;  // of some 800
    pulls += std::pow((stated.at_places[j] - rig.truth[j]) / stated.deviation[j], 2);
    ++lit;
    own += stated.deviation[j] * stated.deviation[j];
    scatter += (squares[j] - sum[j] * sum[j] / kRuns) / (kRuns - 1);
  }
  EXPECT_TRUE(relative(std::sqrt(pulls / lit), 1, 0.3));
  EXPECT_LT(scatter, own);
  EXPECT_GT(scatter, 0.03 * own);
}

// The strength of least cross-validation, with the settings of the command, is that of the least
// error but for a part: no strength that is tried is much better.
TEST(Reconstruction, NoOtherStrengthIsMuchBetter) {
  Rig rig = ring_rig();
  rig.settings.ray_noise = true;
  rig.settings.rays.samples = 256;
  rig.settings.iterations = ReconstructionSettings().iterations;
  for (const double noise : {0.003, 0.03}) {
    const ReconstructionInput input = rig.finer_input(noise);
    ReconstructionSettings settings = rig.settings;
    const Reconstruction found = reconstruct(input, settings);
    EXPECT_FALSE(found.strength_at_end);
    EXPECT_TRUE(found.explained_by_noise);
    double least = 1e300;
    for (const auto& trial : found.trials) {
      settings.strength = trial.strength;
      least = std::min(least, rig.error(reconstruct(input, settings).at_places));
    }
    EXPECT_LT(rig.error(found.at_places), 1.2 * least) << noise;
  }
}

// Unknowns that no row sees are not made up by solvers that begin with light everywhere.
TEST(Reconstruction, UnknownsThatNothingSeesStayEmpty) {
  Rig rig = ring_rig();
  RingGrid high;
  high.base = {1, 0, -60e-3};
  high.radial_step = 0.5e-3;
  high.height_step = 2e-3;
  high.rings = 9;
  high.heights = 61;
  rig.unknowns = make_ring_unknowns(high);
  rig.set_truth();
  rig.settings.support = false;
  rig.settings.iterations = 5;
  const ReconstructionInput input = rig.input(0.01);
  const CameraRays rays = draw_camera_rays(input.views, rig.unknowns->bounds(), rig.settings.rays);
  const auto a = make_emission_operator({&rays, rig.unknowns.get()}, {});
  const std::vector<double> seen = transposed_times(*a, std::vector<double>(a->rows(), 1.0));
  for (const auto solver :
       {ReconstructionSolver::sirt, ReconstructionSolver::sart, ReconstructionSolver::mlem,
        ReconstructionSolver::osem, ReconstructionSolver::mart}) {
    rig.settings.solver = solver;
    const Reconstruction found = reconstruct(input, rig.settings);
    double made_up = 0, light = 0;
    for (std::size_t j = 0; j < seen.size(); ++j)
      (seen[j] > 0 ? light : made_up) += found.values[j];
    EXPECT_GT(found.unseen, 100u);
    EXPECT_EQ(made_up, 0) << static_cast<int>(solver);
    EXPECT_GT(light, 0);
  }
}

// Surroundings as bright as the flame, whose pictures the renderer makes, are no part of what is
// found.
TEST(Reconstruction, LightBehindIsNotTheFlames) {
  Rig rig = ring_rig();
  rig.settings.rays.samples = 256;
  const ReconstructionInput dark = rig.input(0.01);
  const double alone = rig.error(reconstruct(dark, rig.settings).values);
  Scene lit = camera_scene(false);
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 5;
  lit.lights = {sky};
  Scene empty = lit;
  empty.flames.clear();
  RenderSettings settings;
  settings.samples = 256;
  const LightFieldChannel sky_only = render(compile(empty), settings).light_field.channels[0];
  const Image& behind = sky_only.flux;
  rig.scenes.clear();
  rig.scenes.push_back(compile(lit));
  ReconstructionInput input = rig.input(0.01);
  Image& flux = input.measurements[0].flux;
  double flame = 0, other = 0;
  for (std::size_t k = 0; k < flux.pixels.size(); ++k) {
    flame = std::max(flame, static_cast<double>(flux.pixels[k]));
    other = std::max(other, static_cast<double>(behind.pixels[k]));
    flux.pixels[k] += behind.pixels[k];
    // The picture's rays and the reconstruction's err alike.
    float& deviation = input.measurements[0].deviation.pixels[k];
    deviation = std::hypot(deviation, std::sqrt(2.0F) * sky_only.standard_error.pixels[k]);
  }
  EXPECT_GT(other, 0.3 * flame);
  EXPECT_LT(rig.error(reconstruct(input, rig.settings).values), 2 * alone);
}

}  // namespace
}  // namespace plenoflame::test::reconstruction_errors_test
