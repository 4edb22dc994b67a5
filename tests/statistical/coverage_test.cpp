// The stated error against the true one: over 100 seeds the true error lies below the stated bound
// as often as its confidence says, and the bound is not wide.
#include <string>
#include <vector>

#include "statistical/measured_errors.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"
#include "support/length.h"

namespace plenoflame::test::coverage_test {
namespace {

const int kReferenceSamples = in_full() ? 1 << 15 : 1 << 12;
const int kSide = in_full() ? 200 : 48;
const std::vector<double> kTargets =
    in_full() ? std::vector{0.2, 0.07, 0.03} : std::vector{0.2, 0.1};

PixelWindow middle(int columns, int rows) {
  return {(columns - kSide) / 2, (rows - kSide) / 2, kSide, kSide};
}

TEST(Coverage, FixedSamples) {
  const CompiledScene scene = compile(paper_flame(400, 400, 0.004));
  RenderSettings settings;
  settings.window = middle(400, 400);
  const Truth truth(scene, settings, kReferenceSamples);
  for (const int replicates : {2, 4})
    for (const int samples : {4, 16, 128}) {
      // Few replicates are the harder case for many samples, few samples for many replicates.
      if (!in_full() && (samples == 16 || (samples == 128 && replicates == 4))) continue;
      settings.samples = samples;
      settings.replicates = replicates;
      const Coverage c = coverage(scene, settings, truth);
      const std::string what =
          std::to_string(samples) + " samples, " + std::to_string(replicates) + " replicates";
      EXPECT_GE(c.below_bound, kLeastShare) << what;
      EXPECT_LT(c.median_of_bound, 1.12) << what;
      // Two points of each replicate or fewer miss that dim pixels are lit.
      EXPECT_GT(c.median_of_estimate, samples / replicates < 4 ? 0.93 : 0.97) << what;
      EXPECT_LT(c.median_of_estimate, 1.03) << what;
    }
}

TEST(Coverage, FewPixels) {
  // The errors of so few pixels are hardly known: the bound must say so, and does not need to be
  // tight. (A single pixel is not normally distributed: both replicates are often wrong alike.)
  const CompiledScene scene = compile(paper_flame(400, 400, 0.004));
  for (const int side : {4, 8}) {
    RenderSettings settings;
    settings.samples = 32;
    settings.window = {203, 198, side, side};
    const Truth truth(scene, settings, 1 << 16);
    EXPECT_GE(coverage(scene, settings, truth).below_bound, kLeastShare) << side;
  }
}

TEST(Coverage, TargetError) {
  // Nine tiles, the flame's edge through them.
  const CompiledScene scene = compile(paper_flame(140, 140, 0.006));
  RenderSettings settings;
  const Truth truth(scene, settings, kReferenceSamples / 2);
  settings.samples = 1 << 16;
  for (const double target : kTargets) {
    settings.target_error = target;
    const Coverage c = coverage(scene, settings, truth);
    EXPECT_GE(c.below_target, kLeastShare) << target;
    EXPECT_GE(c.below_bound, kLeastShare) << target;
    EXPECT_LT(c.median_of_bound, 1.12) << target;
  }
}

TEST(Coverage, ForwardEstimator) {
  const CompiledScene scene = compile(bare_flame(24, 20, 0.9e-3));
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  settings.replicates = 4;
  settings.samples = in_full() ? 50000 : 20000;
  const Truth truth(scene, settings, kReferenceSamples);
  const Coverage fixed = coverage(scene, settings, truth);
  EXPECT_GE(fixed.below_bound, kLeastShare);
  EXPECT_LT(fixed.median_of_bound, 1.2);
  settings.samples = 100000000;
  settings.target_error = in_full() ? 0.1 : 0.2;
  const Coverage target = coverage(scene, settings, truth);
  EXPECT_GE(target.below_bound, kLeastShare);
  EXPECT_GE(target.below_target, kLeastShare);
  EXPECT_LT(target.median_of_bound, 1.2);
}

}  // namespace
}  // namespace plenoflame::test::coverage_test
