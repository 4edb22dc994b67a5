#include "plenoflame/render/exposure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/film/checkpoint.h"
#include "plenoflame/media/brightened_medium.h"
#include "plenoflame/media/layered_medium.h"
#include "support/approx.h"
#include "support/small_scene.h"
#include "support/temporary_folder.h"

namespace plenoflame::exposure_test {
namespace {

Scene flame_at(double y, double brightness = 1) {
  Scene scene =
      test::small_scene(test::singlet(), test::large_array(Lattice::hexagonal, LensModel::real));
  scene.flames[0].position.y = y;
  scene.flames[0].brightness = brightness;
  return scene;
}

RenderResult expose(const std::vector<SceneMoment>& moments, const RenderSettings& settings,
                    const ExposureKeeping& keeping = {}, const Execution& execution = {}) {
  std::optional<CompiledScene> compiled;
  return render_exposure(
      moments,
      [&](const Scene& scene) -> const CompiledScene& {
        compiled = compile(scene, load_core_medium, {}, {}, {compiled ? &*compiled : nullptr});
        return *compiled;
      },
      settings, execution, keeping);
}

/// Three moments on a sensor of 3 x 2 tiles.
std::vector<SceneMoment> three_moments() {
  std::vector<SceneMoment> moments{
      {flame_at(0.001), 0.25}, {flame_at(0.003, 0.1), 0.5}, {flame_at(-0.002, 3), 0.25}};
  for (SceneMoment& moment : moments) {
    moment.scene.camera.sensor.columns = 160;
    moment.scene.camera.sensor.rows = 100;
  }
  return moments;
}

/// Stops a run at a number of times that its state was kept; the state goes through a file.
struct StoppedRun {
  ExposureState state;
  int kept = 0;
  RenderResult result;
};
StoppedRun stop_at(int time, const std::vector<SceneMoment>& moments, RenderSettings settings,
                   const ExposureState* resume = nullptr) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("state");
  settings.checkpoint_seconds = 1e-9;  // a tile at a time
  StoppedRun run;
  std::stop_source stop;
  Execution execution;
  execution.threads = 1;
  execution.stop = stop.get_token();
  ExposureKeeping keeping;
  keeping.resume = resume;
  keeping.keep = [&](const ExposureState& state, const Film& current) {
    run.state.progress = state.progress;
    std::vector<const Film*> films{&state.sums};
    for (const Film& film : state.films) films.push_back(&film);
    films[1 + state.progress.done] = &current;
    write_checkpoint(path, films, "key");
    if (++run.kept == time) stop.request_stop();
  };
  run.result = expose(moments, settings, keeping, execution);
  if (run.kept > 0) {
    run.state.films = read_checkpoint_films(path, "key");
    run.state.sums = std::move(run.state.films.front());
    run.state.films.erase(run.state.films.begin());
  }
  return run;
}

RenderSettings settings_of(int samples, std::uint64_t seed) {
  RenderSettings settings;
  settings.samples = samples;
  settings.seed = seed;
  return settings;
}

const Image& flux_of(const RenderResult& result) {
  return result.light_field.channels.front().flux;
}
const Image& error_of(const RenderResult& result) {
  return result.light_field.channels.front().standard_error;
}

TEST(Exposure, OneMomentIsThatPicture) {
  const Scene scene = flame_at(0.001);
  const RenderSettings settings = settings_of(8, 3);
  const RenderResult alone = render(compile(scene), settings);
  const RenderResult exposed = expose({{scene, 1}}, settings);
  EXPECT_EQ(flux_of(exposed), flux_of(alone));
  EXPECT_EQ(error_of(exposed), error_of(alone));
  EXPECT_FALSE(exposed.light_field.numbers.contains("exposure.moments"));
}

// The reference: each moment by itself with many more samples, summed here. Differences in units of
// the stated errors follow Student's t with 7 degrees of freedom, half of which is below 0.711 by
// magnitude; the median does not mind pixels that hardly any ray reaches.
TEST(Exposure, ItIsTheMeanWithHonestErrors) {
  const double shares[] = {0.2, 0.5, 0.3};
  const Scene scenes[] = {flame_at(0.001), flame_at(0.004), flame_at(-0.003, 3)};
  std::vector<SceneMoment> moments;
  std::vector<double> expected(60 * 60);
  for (std::size_t i = 0; i < 3; ++i) {
    moments.push_back({scenes[i], shares[i]});
    const RenderResult fine = render(compile(scenes[i]), settings_of(4096, 7));
    for (std::size_t p = 0; p < expected.size(); ++p)
      expected[p] += shares[i] * static_cast<double>(flux_of(fine).pixels[p]);
  }
  RenderSettings settings = settings_of(96, 1);
  settings.replicates = 8;
  const RenderResult result = expose(moments, settings);
  const double lit = 0.01 * *std::max_element(expected.begin(), expected.end());
  std::vector<double> differences;
  double sum = 0, whole = 0;
  for (std::size_t p = 0; p < expected.size(); ++p) {
    const double flux = static_cast<double>(flux_of(result).pixels[p]);
    sum += flux;
    whole += expected[p];
    if (expected[p] > lit)
      differences.push_back(std::fabs(flux - expected[p]) /
                            static_cast<double>(error_of(result).pixels[p]));
  }
  ASSERT_GT(differences.size(), 300u);
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  EXPECT_TRUE(test::relative(*middle, 0.711, 0.12));
  EXPECT_TRUE(test::relative(sum, whole, 2e-3));
  EXPECT_EQ(result.light_field.numbers.at("exposure.moments"), 3);
  EXPECT_TRUE(test::relative(result.statistics.flux, sum, 1e-12));
}

TEST(Exposure, TheTargetIsThatOfTheMean) {
  std::vector<SceneMoment> moments{{flame_at(0.001), 0.5}, {flame_at(0.003, 0.1), 0.5}};
  RenderSettings settings = settings_of(kMostSamples, 1);
  settings.target_error = 0.02;
  const RenderResult result = expose(moments, settings);
  EXPECT_TRUE(result.statistics.target_reached);
  EXPECT_LE(result.statistics.relative_error_bound, 0.02);
  EXPECT_GT(result.statistics.relative_error_bound, 0.005);  // no more work than that asks for
}

/// Each `step`-th of the stops that there are, gone on with to the end, and once one after the
/// other.
void check_stops(const std::vector<SceneMoment>& moments, const RenderSettings& settings, int stops,
                 int step = 1, int least_inside = 1) {
  const RenderResult whole = expose(moments, settings);
  ASSERT_TRUE(whole.statistics.complete);
  const auto is_whole = [&](const RenderResult& result) {
    return result.statistics.complete && flux_of(result) == flux_of(whole) &&
           error_of(result) == error_of(whole) &&
           result.light_field.samples == whole.light_field.samples &&
           result.light_field.texts == whole.light_field.texts &&
           result.light_field.numbers == whole.light_field.numbers &&
           result.statistics.relative_error_bound == whole.statistics.relative_error_bound;
  };
  int stopped = 0, inside = 0;
  for (int time = 1;; time += step) {
    const StoppedRun run = stop_at(time, moments, settings);
    if (run.kept < time) break;
    if (run.result.statistics.complete) continue;  // it was the last
    EXPECT_TRUE(run.result.light_field.channels.empty());
    ++stopped;
    const Film& current = run.state.films[run.state.progress.done];
    inside += current.channels() > 0 && current.all_tile_samples().back() > 0 ? 1 : 0;
    ExposureKeeping keeping;
    keeping.resume = &run.state;
    const RenderResult rest = expose(moments, settings, keeping);
    EXPECT_TRUE(is_whole(rest)) << time;
    EXPECT_LT(rest.statistics.rays, whole.statistics.rays);
  }
  EXPECT_GE(stopped, stops);
  EXPECT_GE(inside, least_inside);
  std::optional<ExposureState> state;
  for (int runs = 0; runs < 1000; ++runs) {
    StoppedRun run = stop_at(3, moments, settings, state ? &*state : nullptr);
    if (!run.result.statistics.complete) {
      state = std::move(run.state);
      continue;
    }
    EXPECT_TRUE(is_whole(run.result));
    EXPECT_GT(runs, 0);
    return;
  }
  FAIL() << "it does not end";
}

TEST(Exposure, GoesOnWhereverItWasStopped) {
  RenderSettings settings = settings_of(8, 5);
  check_stops(three_moments(), settings, 6, 2);
  settings.replicates = 1;  // without standard errors
  check_stops(three_moments(), settings, 3, 5);
  settings = settings_of(3000, 2);
  settings.estimator = Estimator::forward;
  check_stops(three_moments(), settings, 2, 1, 0);  // a moment is a single piece of work
}

TEST(Exposure, GoesOnInEveryPassOfATarget) {
  RenderSettings settings = settings_of(kMostSamples, 1);
  settings.target_error = 0.1;
  check_stops(three_moments(), settings, 3, 9);
  // A lower target takes another pass: one of its stops is beyond the first.
  settings.target_error = 0.05;
  int pass = 0;
  for (int time = 3; pass == 0; time += 3) {
    const StoppedRun run = stop_at(time, three_moments(), settings);
    ASSERT_GE(run.kept, time);
    pass = run.state.progress.pass;
  }
}

TEST(Exposure, AStateOfAnotherExposureIsRefused) {
  const std::vector<SceneMoment> moments = three_moments();
  const RenderSettings settings = settings_of(16, 5);
  ExposureState state = stop_at(9, moments, settings).state;
  ASSERT_GT(state.progress.done, 0U);
  ExposureKeeping keeping;
  keeping.resume = &state;
  EXPECT_THROW(expose({moments[0], moments[1]}, settings, keeping), UsageError);
  RenderSettings other = settings;
  other.window = {10, 10, 70, 70};
  EXPECT_THROW(expose(moments, other, keeping), UsageError);
  other = settings;
  other.standard_error = false;
  EXPECT_THROW(expose(moments, other, keeping), UsageError);
}

// Closed form: along the diameter of a sphere b (1 - exp(-2 kappa R)) S.
TEST(Exposure, BrightnessIsAFactorOnTheLight) {
  const auto medium = std::shared_ptr<const Medium>(make_layered_medium(
      {{{0, 0, 0}, {0.01, 0.01, 0.01}, 1500, 40}}, {}, {SourceFunction::total()}));
  const auto bright = brightened(medium, 2.5);
  EXPECT_EQ(brightened(medium, 1), medium);
  const double source = 5.670374419e-8 * std::pow(1500.0, 4) / 3.14159265358979323846;
  const Ray ray{{-1, 0, 0}, {1, 0, 0}};
  const std::vector<double> seen = integrate_reference(*bright, ray, 0, 2);
  EXPECT_TRUE(test::relative(seen[0], 2.5 * source * -std::expm1(-0.8), 1e-9));
  EXPECT_TRUE(test::relative(seen[1], 0.8, 1e-9));  // what it absorbs stays
  // The way of the renderer: two scenes, the flame's light twice as bright.
  const RenderSettings settings = settings_of(8, 3);
  const RenderResult one = expose({{flame_at(0.001), 1}}, settings);
  const RenderResult two = expose({{flame_at(0.001, 2), 1}}, settings);
  for (std::size_t p = 0; p < flux_of(one).pixels.size(); ++p)
    ASSERT_TRUE(test::relative(static_cast<double>(flux_of(two).pixels[p]),
                               2 * static_cast<double>(flux_of(one).pixels[p]), 1e-6));
}

}  // namespace
}  // namespace plenoflame::exposure_test
