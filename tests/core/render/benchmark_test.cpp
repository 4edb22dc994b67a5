#include "plenoflame/render/benchmark.h"

#include <gtest/gtest.h>

#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::benchmark_test {
namespace {

// A reference that is the measured image plus a constant d everywhere, with a standard error of 0.6
// d: the difference is d in every pixel, of which sqrt(1 - 0.36) d is the image's own.
TEST(Benchmark, ErrorsOfAKnownDifference) {
  Scene scene = small_scene(singlet(), {});
  const CompiledScene compiled = compile(scene);
  RenderSettings settings;
  settings.samples = 4;
  BenchmarkReference reference;
  reference.light_field = render(compiled, settings).light_field;
  LightFieldChannel& truth = reference.light_field.channels[0];
  float largest = 0;
  for (const float value : truth.flux.pixels) largest = std::max(largest, value);
  const float d = 0.5f * largest;
  double mean = 0;
  for (float& value : truth.flux.pixels) {
    value += d;
    mean += static_cast<double>(value) / static_cast<double>(truth.flux.pixels.size());
  }
  for (float& value : truth.standard_error.pixels) value = 0.6f * d;
  const BenchmarkPoint point = benchmark_point(compiled, settings, 1, reference, {});
  EXPECT_TRUE(relative(point.relative_rmse, 0.8 * static_cast<double>(d) / mean, 1e-5));
  EXPECT_TRUE(relative(point.relative_bias, -static_cast<double>(d) / mean, 1e-5));
  EXPECT_EQ(point.samples, 4);
  EXPECT_EQ(point.seconds.size(), 1u);
  // A reference that is worse than what it should judge hides the error.
  for (float& value : truth.standard_error.pixels) value = 1.1f * d;
  EXPECT_EQ(benchmark_point(compiled, settings, 1, reference, {}).relative_rmse, 0.0);
}

TEST(Benchmark, MedianAndEfficiency) {
  BenchmarkPoint point;
  point.seconds = {3, 1, 2};
  EXPECT_EQ(point.median_seconds(), 2.0);
  point.seconds = {4, 1, 2, 3};
  EXPECT_EQ(point.median_seconds(), 2.5);
  point.relative_rmse = 0.1;
  point.rays = 10;
  EXPECT_TRUE(relative(point.efficiency(), 40.0, 1e-14));
  EXPECT_EQ(point.rays_per_second(), 4.0);
}

TEST(Benchmark, SlopeOfAPowerLaw) {
  std::vector<BenchmarkPoint> points(4);
  double samples = 3;
  for (BenchmarkPoint& point : points) {
    point.samples = samples;
    point.relative_rmse = 0.7 * std::pow(samples, -0.8);
    samples *= 2.5;
  }
  EXPECT_TRUE(relative(fitted_slope(points, Estimator::backward), -0.8, 1e-13));
  points[1].relative_rmse = 0;  // hidden by the reference: left out
  EXPECT_TRUE(relative(fitted_slope(points, Estimator::backward), -0.8, 1e-13));
  EXPECT_TRUE(std::isnan(fitted_slope(points, Estimator::forward)));
}

}  // namespace
}  // namespace plenoflame::test::benchmark_test
