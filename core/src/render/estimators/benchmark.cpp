#include "plenoflame/render/benchmark.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "plenoflame/base/error.h"
#include "plenoflame/base/progress_share.h"
#include "render/run/run_control.h"

namespace plenoflame {

double BenchmarkPoint::median_seconds() const {
  if (seconds.empty()) return 0;
  std::vector<double> sorted = seconds;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  return n % 2 ? sorted[n / 2] : 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]);
}

double BenchmarkPoint::efficiency() const {
  return 1 / (relative_rmse * relative_rmse * median_seconds());
}

BenchmarkPoint benchmark_point(const CompiledScene& scene, RenderSettings settings, int repeat,
                               const BenchmarkReference& reference, const Execution& execution) {
  const LightFieldChannel& truth = reference.light_field.channels.front();
  settings.window = reference.light_field.window;
  BenchmarkPoint point;
  point.estimator = settings.estimator;
  const float limit = static_cast<float>(kLitShare) *
                      *std::max_element(truth.flux.pixels.begin(), truth.flux.pixels.end());
  double squares = 0, difference = 0, variance = 0;
  double lit = 0, total = 0, truth_variance = 0;
  const double runs = repeat;
  for (int run = 0; run < repeat; ++run) {
    const auto start = std::chrono::steady_clock::now();
    const RenderResult result =
        render(scene, settings, share_of(execution, run / runs, (run + 1) / runs));
    point.seconds.push_back(seconds_since(start));
    if (!result.statistics.complete) throw Cancelled();
    ++settings.seed;
    point.samples = result.light_field.samples;
    point.rays = result.statistics.rays;
    const LightFieldChannel& channel = result.light_field.channels.front();
    for (std::size_t i = 0; i < truth.flux.pixels.size(); ++i) {
      if (!(truth.flux.pixels[i] > limit)) continue;
      const auto b = static_cast<double>(truth.flux.pixels[i]);
      const double d = static_cast<double>(channel.flux.pixels[i]) - b;
      squares += d * d;
      difference += d;
      if (!channel.standard_error.empty())
        variance += std::pow(static_cast<double>(channel.standard_error.pixels[i]), 2);
      if (run > 0) continue;
      lit += 1;
      total += b;
      truth_variance += std::pow(static_cast<double>(truth.standard_error.pixels[i]), 2);
    }
  }
  // Both errors are independent, so their squares add up in the difference.
  const double own = squares / repeat - truth_variance;
  point.relative_rmse = std::sqrt(std::max(0.0, own) / lit) / (total / lit);
  point.relative_bias = difference / repeat / total;
  point.relative_bias_error = std::sqrt(variance / (repeat * repeat) + truth_variance) / total;
  return point;
}

double fitted_slope(const std::vector<BenchmarkPoint>& points, Estimator estimator) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const BenchmarkPoint& point : points) {
    if (point.estimator != estimator || !(point.relative_rmse > 0)) continue;
    const double a = std::log(point.samples), b = std::log(point.relative_rmse);
    n += 1, x += a, y += b, xx += a * a, xy += a * b;
  }
  const double spread = n * xx - x * x;
  if (n < 2 || !(spread > 0)) return std::numeric_limits<double>::quiet_NaN();
  return (n * xy - x * y) / spread;
}

}  // namespace plenoflame
