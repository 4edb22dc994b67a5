// Most fluxes are A x* of known samples, by the operator that is inverted: what is tested with them
// is the algebra of solvers, choices and deviations, and what is said of a result. Where a test
// claims how near the truth a result is, the fluxes are those of a grid four times finer along
// other rays, whose error counts as noise (finer_input());
// statistical/reconstruction_accuracy_test.cpp has pictures of the forward estimator.
#include "plenoflame/inverse/reconstruction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "core/inverse/glow_scene.h"
#include "plenoflame/base/error.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/flame_estimate.h"
#include "plenoflame/inverse/light_behind.h"
#include "plenoflame/render/render.h"
#include "plenoflame/sampling/noise.h"
#include "support/approx.h"

namespace plenoflame::test::reconstruction_test {
namespace {

Scene camera_scene(bool from_side) {
  Scene scene = glow_scene(40);
  if (from_side) {
    scene.camera.position = {1, -1, 0};
    scene.camera.look_direction = {0, 1, 0};
  }
  return scene;
}

struct Rig {
  std::vector<CompiledScene> scenes;
  std::unique_ptr<Unknowns> unknowns, finer;  ///< the finer ones fill the same space
  /// The samples are of this field; times the factor of the place where unknowns fade beyond the
  /// last of them, which finer ones do not.
  std::function<double(Vec3)> field, edge = [](Vec3) { return 1.0; };
  std::vector<double> truth, absorption;  ///< an absorption is the same everywhere
  ReconstructionSettings settings;

  void set_truth() {
    truth.clear();
    for (std::size_t j = 0; j < unknowns->size(); ++j) truth.push_back(field(unknowns->place(j)));
  }

  /// Fluxes of the operator that is inverted.
  ReconstructionInput input(double noise, std::uint64_t seed = 5) const {
    return measured(*unknowns, truth, absorption, settings.rays, noise, seed);
  }
  /// Fluxes of the same field on the finer grid, seen along other rays, and more of them.
  ReconstructionInput finer_input(double noise, std::uint64_t seed = 5) const {
    std::vector<double> samples, absorbing;
    for (std::size_t j = 0; j < finer->size(); ++j) {
      const Vec3 p = finer->place(j);
      samples.push_back(field(p) * edge(p));
      if (!absorption.empty()) absorbing.push_back(absorption[0] * edge(p));
    }
    CameraRaySettings other = settings.rays;
    other.samples *= 8;
    other.seed += 77;
    return measured(*finer, samples, absorbing, other, noise, seed);
  }
  ReconstructionInput measured(const Unknowns& shining, const std::vector<double>& samples,
                               const std::vector<double>& absorbing, const CameraRaySettings& how,
                               double noise, std::uint64_t seed) const {
    ReconstructionInput in;
    in.unknowns = unknowns.get();
    in.absorption = absorption;
    for (const CompiledScene& scene : scenes) in.views.push_back({&scene, {}});
    const CameraRays rays = draw_camera_rays(in.views, shining.bounds(), how);
    const EmissionProblem problem{
        &rays, &shining, absorbing.empty() ? RowModel::emission : RowModel::source, absorbing};
    const auto a = make_emission_operator(problem, {});
    std::vector<double> b(a->rows());
    a->apply(samples, b);
    double largest = 0;
    for (const double value : b) largest = std::max(largest, value);
    for (const CompiledScene& scene : scenes) {
      const SensorSpec& sensor = scene.scene.camera.sensor;
      Measurement m;
      m.window = {0, 0, sensor.columns, sensor.rows};
      m.flux = Image(sensor.columns, sensor.rows);
      m.deviation =
          Image(sensor.columns, sensor.rows, static_cast<float>(std::max(noise, 1e-5) * largest));
      in.measurements.push_back(std::move(m));
    }
    for (std::size_t i = 0; i < b.size(); ++i) {
      const CameraRays::Row& row = rays.rows[i];
      in.measurements[static_cast<std::size_t>(row.view)].flux.at(row.column, row.row) =
          static_cast<float>(b[i] + noise * largest * NoiseStream(seed, i).gaussian());
    }
    return in;
  }
  double error(const std::vector<double>& values) const {
    double away = 0, all = 0;
    for (std::size_t j = 0; j < truth.size(); ++j) {
      away += unknowns->volume(j) * (values[j] - truth[j]) * (values[j] - truth[j]);
      all += unknowns->volume(j) * truth[j] * truth[j];
    }
    return std::sqrt(away / all);
  }
};

Rig ring_rig() {
  Rig rig;
  rig.scenes.push_back(compile(camera_scene(false)));
  RingGrid grid = glow_rings();
  rig.unknowns = make_ring_unknowns(grid);
  rig.field = glow_at;
  rig.edge = [grid](Vec3 p) {
    return std::min(1.0, grid.rings - std::hypot(p.x - grid.base.x, p.y) / grid.radial_step);
  };
  grid.radial_step /= 4;
  grid.height_step /= 4;
  grid.rings *= 4;
  grid.heights = 4 * (grid.heights - 1) + 1;
  rig.finer = make_ring_unknowns(grid);
  rig.set_truth();
  rig.settings.rays.samples = 16;
  rig.settings.iterations = 400;
  rig.settings.draws = rig.settings.probes = 0;
  rig.settings.ray_noise = false;  // the pictures are made of the same rays
  return rig;
}

Rig voxel_rig(bool two) {
  Rig rig;
  rig.scenes.push_back(compile(camera_scene(false)));
  if (two) rig.scenes.push_back(compile(camera_scene(true)));
  RegularLattice lattice;
  lattice.count = {9, 9, 9};
  lattice.index_to_world.linear = {{{{1.1e-3, 0, 0}, {0, 1.1e-3, 0}, {0, 0, 2e-3}}}};
  lattice.index_to_world.translation = {1 - 4.4e-3, -4.4e-3, -8e-3};
  rig.unknowns = make_voxel_unknowns(lattice);
  rig.field = [](Vec3 p) {
    const double end = std::max(0.0, 1 - p.z * p.z / (8e-3 * 8e-3));
    return end * glow_at(p) * (1 + 0.5 * std::sin(900 * (p.x - 1) + 500 * p.y));
  };
  lattice.count = {33, 33, 33};
  lattice.index_to_world.linear = {{{{0.275e-3, 0, 0}, {0, 0.275e-3, 0}, {0, 0, 0.5e-3}}}};
  rig.finer = make_voxel_unknowns(lattice);
  rig.set_truth();
  rig.settings.rays.samples = 16;
  rig.settings.iterations = 200;
  rig.settings.draws = rig.settings.probes = 0;
  rig.settings.ray_noise = false;  // the pictures are made of the same rays
  return rig;
}

// Algebra: without noise and without a penalty the rings come back. Fails when rows are not
// weighted alike in A and b.
TEST(Reconstruction, RingsOfTheirOwnRows) {
  Rig rig = ring_rig();
  rig.settings.strength = 0;
  rig.settings.iterations = 4000;
  const Reconstruction exact = reconstruct(rig.input(0), rig.settings);
  EXPECT_LT(rig.error(exact.values), 0.01);
  EXPECT_EQ(exact.unseen, 0u);
  EXPECT_TRUE(exact.stored);
}

// Cross-validation finds a strength that leaves as much of a finer flame's fluxes as their noise of
// 0.3 %, that of the rays included, and what is found is near the truth.
TEST(Reconstruction, RingsFromOneCamera) {
  Rig rig = ring_rig();
  rig.settings.ray_noise = true;
  rig.settings.rays.samples = 256;  // 16 of them err by 10 % of a row
  const ReconstructionInput input = rig.finer_input(0.003);
  const Reconstruction noisy = reconstruct(input, rig.settings);
  EXPECT_LT(rig.error(noisy.values), 0.12);
  EXPECT_TRUE(relative(noisy.chi_squared, 1, 0.1));
  EXPECT_GT(noisy.strength, 0);
  EXPECT_GE(noisy.trials.size(), 4u);
  // A penalty that is a thousand times as strong flattens what is seen.
  rig.settings.strength = 1000 * noisy.strength;
  EXPECT_GT(rig.error(reconstruct(input, rig.settings).values), 2 * rig.error(noisy.values));
}

// Stored and followed again: the same solution; the same to the bit for any number of threads.
TEST(Reconstruction, WithoutAMatrixAndForAnyNumberOfThreads) {
  Rig rig = ring_rig();
  rig.settings.strength = 1e-4;
  rig.settings.iterations = 50;
  Execution one, two;
  one.threads = 1;
  two.threads = 2;
  const ReconstructionInput input = rig.input(0.01);
  const Reconstruction stored = reconstruct(input, rig.settings, two);
  EXPECT_EQ(stored.values, reconstruct(input, rig.settings, one).values);
  rig.settings.memory = 1;
  const Reconstruction followed = reconstruct(input, rig.settings, two);
  EXPECT_FALSE(followed.stored);
  for (std::size_t j = 0; j < stored.values.size(); ++j)
    EXPECT_TRUE(within(followed.values[j], stored.values[j], 1e-5, 1000));
}

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

// Rings beyond the light are behind dark pixels, those within are not. Fails when a view's dark
// pixels are those of another one.
TEST(Reconstruction, DarkPixelsRuleOutWhatIsBehindThem) {
  Rig rig = ring_rig();
  RingGrid wide = glow_rings();
  wide.rings = 20;
  rig.unknowns = make_ring_unknowns(wide);
  rig.set_truth();
  rig.settings.strength = 1e-4;
  const auto outside = [&](const Reconstruction& found) {
    double lost = 0, beyond = 0;
    for (std::size_t j = 0; j < rig.truth.size(); ++j) {
      if (rig.truth[j] > 100) lost += found.values[j] == 0;
      if (j / 13 > 11) beyond += found.values[j] != 0;
    }
    EXPECT_EQ(lost, 0);
    return beyond;
  };
  EXPECT_EQ(outside(reconstruct(rig.input(0), rig.settings)), 0);
  // One dark pixel in six is above a deviation of its noise: next to the light chance leaves some.
  // It was 1.1 % of these 104 rings in 12 seeds of the noise, and none in every other seed.
  constexpr std::uint64_t kSeeds = 6;
  double left = 0;
  std::size_t empty = 0;
  for (std::uint64_t seed = 5; seed < 5 + kSeeds; ++seed) {
    const Reconstruction found = reconstruct(rig.input(0.01, seed), rig.settings);
    left += outside(found);
    empty += found.empty;
  }
  EXPECT_GT(empty, kSeeds * 8 * 13);
  EXPECT_LT(left, 0.03 * kSeeds * 104);
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

// Solutions end before their last iteration, and draws of noise take as long as all the rest: what
// is reported goes on through both, up to the whole.
TEST(Reconstruction, ProgressGoesOnToTheEnd) {
  Rig rig = ring_rig();
  rig.settings.draws = 50;
  rig.settings.probes = 20;
  std::vector<double> seen;
  Execution execution;
  execution.progress = [&](const Progress& progress) { seen.push_back(progress.fraction); };
  reconstruct(rig.input(0.01), rig.settings, execution);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(seen.back(), 1);
  double largest_step = 0;
  for (std::size_t i = 1; i < seen.size(); ++i)
    largest_step = std::max(largest_step, seen[i] - seen[i - 1]);
  EXPECT_LT(largest_step, 0.5);
  // The solution ends at 0.45.
  EXPECT_GT(std::count_if(seen.begin(), seen.end(), [](double f) { return f > 0.45; }),
            50 + 20 - 1);
}

TEST(Reconstruction, DeviationsDoNotDependOnTheIterationsThatAreLeft) {
  Rig rig = ring_rig();
  rig.settings.draws = 3;
  rig.settings.support = false;
  rig.settings.strength = 1e-2;
  const ReconstructionInput input = rig.input(0.1);
  for (const auto solver : {ReconstructionSolver::fista, ReconstructionSolver::mlem}) {
    rig.settings.solver = solver;
    rig.settings.iterations = 400;
    const Reconstruction some = reconstruct(input, rig.settings);
    EXPECT_NE(some.reason, StopReason::iterations) << static_cast<int>(solver);
    rig.settings.iterations = 1000;
    const Reconstruction more = reconstruct(input, rig.settings);
    EXPECT_EQ(some.values, more.values);
    EXPECT_EQ(some.deviation, more.deviation);
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

// Said of any solver and of a strength by hand, by the misfit that is handed out.
TEST(Reconstruction, SaysWhetherNoiseExplainsThePictures) {
  Rig rig = ring_rig();
  const ReconstructionInput input = rig.input(0.01);
  const Reconstruction chosen = reconstruct(input, rig.settings);
  EXPECT_TRUE(chosen.explained_by_noise);
  rig.settings.strength = 1000 * chosen.strength;
  const Reconstruction flat = reconstruct(input, rig.settings);
  EXPECT_GT(flat.chi_squared, 1.5);
  EXPECT_FALSE(flat.explained_by_noise);
  std::size_t not_explained = 0;
  for (const auto solver :
       {ReconstructionSolver::cgls, ReconstructionSolver::sirt, ReconstructionSolver::mlem})
    for (const int iterations : {1, 30}) {
      rig.settings.solver = solver;
      rig.settings.iterations = iterations;
      const Reconstruction found = reconstruct(input, rig.settings);
      const double m = static_cast<double>(found.rows - found.left_out);
      EXPECT_EQ(found.explained_by_noise,
                found.chi_squared <= 1 + std::max(0.05, 5 * std::sqrt(2 / m)));
      not_explained += !found.explained_by_noise;
    }
  EXPECT_GE(not_explained, 3u);
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

// Matter of one temperature before a background that is as bright as its source function is not
// seen at all (Kirchhoff): what it emits makes up for what it takes away.
TEST(Reconstruction, LightBehindIsWeakenedByWhatAbsorbs) {
  Rig rig = ring_rig();
  Scene lit = camera_scene(false);
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 5;
  lit.lights = {sky};
  const CompiledScene scene = compile(lit);
  const std::vector<CameraView> views{{&scene, {}}};
  CameraRaySettings how;
  how.samples = 64;
  const CameraRays rays = draw_camera_rays(views, rig.unknowns->bounds(), how);
  // Source functions fall to 0 beyond the outermost samples, where nothing absorbs here.
  std::vector<double> absorption(rig.unknowns->size(), 0.0);
  for (std::size_t j = 0; j < absorption.size(); ++j)
    if (j / 13 < 8 && j % 13 > 0 && j % 13 < 12) absorption[j] = 200;
  const EmissionProblem problem{&rays, rig.unknowns.get(), RowModel::source, absorption};
  const std::vector<double> own =
      *make_emission_operator(problem, {}) * std::vector<double>(absorption.size(), 5.0);
  const std::vector<double> clear = light_behind(views, rays, *rig.unknowns, {}, how, {}),
                            behind = light_behind(views, rays, *rig.unknowns, absorption, how, {});
  const auto sum = [](const std::vector<double>& v) {
    return std::accumulate(v.begin(), v.end(), 0.0);
  };
  EXPECT_GT(sum(own), 0.1 * sum(clear));
  EXPECT_TRUE(relative(sum(own) + sum(behind), sum(clear), 0.01));
  Execution one;
  one.threads = 1;
  EXPECT_EQ(behind, light_behind(views, rays, *rig.unknowns, absorption, how, one));
  EXPECT_TRUE(light_behind({{&rig.scenes[0], {}}}, rays, *rig.unknowns, {}, how, {}).empty());
}

// Temperatures are interpolated before they shine: beside what shines there must be none that are
// cold. Where nothing shines any more they end.
TEST(Reconstruction, TemperaturesExplainThePicturesAsRendered) {
  Rig rig = ring_rig();
  const SourceFunction source = channel_source(rig.scenes[0].scene, 0);
  rig.absorption.assign(rig.truth.size(), 30);
  for (std::size_t j = 0; j < rig.truth.size(); ++j)
    rig.truth[j] = j / 13 < 5 ? source(1600 + 100 * std::cos(400 * rig.unknowns->place(j).z)) : 0;
  ReconstructionInput input = rig.input(0.01);
  input.source = &source;
  const Reconstruction found = reconstruct(input, rig.settings);
  EXPECT_TRUE(found.explained_by_noise);
  EXPECT_LT(found.rendered_chi_squared, 1.5);
  const FlameEstimate estimate = estimate_flame(found, *rig.unknowns, rig.absorption, source);
  std::size_t borrowed = 0;
  for (std::size_t j = 0; j < rig.truth.size(); ++j) {
    EXPECT_TRUE(estimate.absorption[j] <= rig.absorption[j]);
    if (!estimate.decided[j] && estimate.temperature[j] > 0) {
      ++borrowed;
      EXPECT_TRUE(relative(estimate.absorption[j] * source(estimate.temperature[j]),
                           estimate.emission[j], 1e-12) ||
                  estimate.emission[j] == 0);
    }
  }
  EXPECT_GT(borrowed, 5u);
}

// With an absorption the samples are source functions, and temperatures follow from them: ring by
// ring from fluxes of the model, in the mean from those of the finer flame.
TEST(Reconstruction, TemperaturesWhereTheAbsorptionIsKnown) {
  Rig rig = ring_rig();
  const SourceFunction source = channel_source(rig.scenes[0].scene, 0);
  rig.absorption.assign(rig.truth.size(), 30);
  rig.field = [&](Vec3 p) { return source(1600 + 100 * std::cos(400 * p.z)); };
  rig.set_truth();
  rig.settings.support = false;
  const auto errors = [&](const ReconstructionInput& input) {
    const Reconstruction found = reconstruct(input, rig.settings);
    const FlameEstimate estimate = estimate_flame(found, *rig.unknowns, rig.absorption, source);
    struct {
      double worst = 0, mean = 0;
    } out;
    double volume = 0;
    for (std::size_t j = 0; j < rig.truth.size(); ++j) {
      const std::size_t ring = j / 13;
      if (ring == 0 || ring > 7) continue;
      const double t = 1600 + 100 * std::cos(400 * rig.unknowns->place(j).z);
      const double error = std::fabs(estimate.temperature[j] / t - 1);
      out.worst = std::max(out.worst, error);
      out.mean += rig.unknowns->volume(j) * error;
      volume += rig.unknowns->volume(j);
      EXPECT_TRUE(relative(estimate.emission[j], 30 * found.at_places[j], 1e-12));
    }
    out.mean /= volume;
    return out;
  };
  EXPECT_LT(errors(rig.input(0.002)).worst, 0.03);
  rig.settings.ray_noise = true;
  rig.settings.rays.samples = 64;
  EXPECT_LT(errors(rig.finer_input(0.002)).mean, 0.02);  // 1600 K everywhere would err by 0.04
}

// A pixel that is left out, with a value that is far off, changes nothing; an unknown that no ray
// meets is counted.
TEST(Reconstruction, LeavesOutAndCounts) {
  Rig rig = ring_rig();
  rig.settings.strength = 1e-4;
  rig.settings.iterations = 50;
  ReconstructionInput input = rig.input(0.01);
  input.measurements[0].deviation.at(20, 30) = 0;
  const Reconstruction without = reconstruct(input, rig.settings);
  EXPECT_EQ(without.left_out, 1u);
  input.measurements[0].flux.at(20, 30) = 1;
  EXPECT_EQ(reconstruct(input, rig.settings).values, without.values);

  RingGrid high;
  high.base = {1, 0, -9e-3};
  high.radial_step = 0.5e-3;
  high.height_step = 10e-3;
  high.rings = 9;
  high.heights = 13;
  rig.unknowns = make_ring_unknowns(high);
  input.unknowns = rig.unknowns.get();
  EXPECT_GT(reconstruct(input, rig.settings).unseen, 50u);
  high.base = {1, 0.5, 0};
  rig.unknowns = make_ring_unknowns(high);
  input.unknowns = rig.unknowns.get();
  EXPECT_THROW(reconstruct(input, rig.settings), InputError);
}

}  // namespace
}  // namespace plenoflame::test::reconstruction_test
