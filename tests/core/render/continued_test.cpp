// A run that was stopped and continued gives the bits of a run in one go.
#include <optional>
#include <stop_token>

#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"

namespace plenoflame::test {
namespace {

/// Stops at the n-th checkpoint, and goes on from what that one was given, with other threads.
RenderResult in_two_parts(const CompiledScene& scene, RenderSettings settings, int checkpoints) {
  std::optional<Film> kept;
  std::stop_source stop;
  Execution execution = threads(3);
  execution.stop = stop.get_token();
  int count = 0;
  settings.checkpoint_seconds = 0;
  settings.checkpoint = [&](const Film& film) {
    if (++count == checkpoints) {
      kept = film;
      stop.request_stop();
    }
  };
  const RenderResult part = render(scene, settings, execution);
  EXPECT_FALSE(part.statistics.complete) << "was not stopped";
  EXPECT_TRUE(kept.has_value());
  settings.checkpoint = {};
  settings.resume = &*kept;
  return render(scene, settings, one_thread());
}

void expect_same(const CompiledScene& scene, const RenderSettings& settings, int checkpoints) {
  const RenderResult whole = render(scene, settings, threads(2));
  const RenderResult parts = in_two_parts(scene, settings, checkpoints);
  EXPECT_TRUE(parts.statistics.complete);
  EXPECT_GT(whole.statistics.flux, 0);
  EXPECT_LT(parts.statistics.rays, whole.statistics.rays) << "nothing was taken over";
  EXPECT_EQ(parts.light_field.samples, whole.light_field.samples);
  EXPECT_TRUE(parts.film == whole.film);
  EXPECT_EQ(parts.light_field.channels[0].flux.pixels, whole.light_field.channels[0].flux.pixels);
}

TEST(Continued, BackwardWithFixedSamples) {
  RenderSettings settings;
  settings.samples = 8;
  expect_same(compile(paper_flame(200, 170, 0.004)), settings, 3);
}

TEST(Continued, BackwardToATarget) {
  RenderSettings settings;
  settings.samples = 1 << 16;
  settings.target_error = 0.06;
  const CompiledScene scene = compile(paper_flame(200, 170, 0.004));
  for (const int checkpoints : {1, 2}) expect_same(scene, settings, checkpoints);
}

TEST(Continued, ForwardWithFixedSamples) {
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  settings.replicates = 4;
  settings.samples = 3000001;  // a last chunk that is not whole
  expect_same(compile(bare_flame(24, 20, 0.9e-3)), settings, 1);
}

TEST(Continued, ForwardToATarget) {
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  settings.replicates = 4;
  settings.samples = 100000000;
  settings.target_error = 0.025;
  const CompiledScene scene = compile(bare_flame(24, 20, 0.9e-3));
  for (const int checkpoints : {1, 2}) expect_same(scene, settings, checkpoints);
}

TEST(Continued, AForwardTimeLimitIsNoInterruption) {
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  settings.replicates = 4;
  settings.samples = 1 << 30;
  settings.time_limit = 0.3;
  const RenderResult result = render(compile(bare_flame(24, 20, 0.9e-3)), settings);
  EXPECT_TRUE(result.statistics.complete);
  EXPECT_TRUE(result.statistics.target_reached);
  EXPECT_LT(result.light_field.samples, 1 << 30);
}

TEST(Continued, AForwardTargetThatCannotBeReached) {
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  settings.replicates = 4;
  settings.samples = 200000;
  settings.target_error = 1e-4;
  const RenderResult result = render(compile(bare_flame(24, 20, 0.9e-3)), settings);
  EXPECT_TRUE(result.statistics.complete);
  EXPECT_FALSE(result.statistics.target_reached);
  EXPECT_EQ(result.light_field.samples, 200000);
}

}  // namespace
}  // namespace plenoflame::test
