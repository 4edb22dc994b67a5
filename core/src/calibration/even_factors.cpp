#include "calibration/even_factors.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {
namespace {

double middle_ratio(std::vector<float> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

}  // namespace

EvenFactors even_factors(
    const CountFrames& measured, const Image* expected, std::size_t colours,
    const std::function<std::size_t(std::size_t pixel)>& colour_of,
    const std::function<std::pair<double, double>(std::size_t pixel)>& light_of) {
  const std::size_t pixels = measured.pixel_count();
  EvenFactors even{std::vector<float>(pixels, 0.0F), std::vector<float>(pixels, 0.0F)};
  double brightest = 0;
  if (expected != nullptr)
    for (const float value : expected->pixels)
      brightest = std::max(brightest, static_cast<double>(value));
  constexpr double kLeastLight = 0.05;  // of the brightest: below nothing is known of the factor
  std::vector<std::vector<float>> usual(colours);
  for (std::size_t i = 0; i < pixels; ++i) {
    const double wanted = expected != nullptr ? static_cast<double>(expected->pixels[i]) : 1;
    if (wanted < kLeastLight * brightest || measured.state[i] != 0) continue;
    const auto [light, variance] = light_of(i);
    // A pixel that saw next to nothing where light was to be has no factor.
    if (!(light > 5 * std::sqrt(variance))) {
      even.factors[i] = -1;
      continue;
    }
    even.factors[i] = static_cast<float>(wanted / light);
    even.relative_variance[i] = static_cast<float>(variance / light / light);
    usual[colour_of(i)].push_back(even.factors[i]);
  }
  std::vector<double> middle;
  for (std::vector<float>& ratios : usual) middle.push_back(middle_ratio(std::move(ratios)));
  constexpr double kLargestFactor = 4;  // darker than it should be by far
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!(even.factors[i] > 0)) continue;
    const double factor = static_cast<double>(even.factors[i]) / middle[colour_of(i)];
    even.factors[i] = factor > kLargestFactor ? -1.0F : static_cast<float>(factor);
  }
  return even;
}

double sensor_variance(const CountFrames& frames, double above_black,
                       const SensorResponse& sensor) {
  double variance = kRoundingVariance;
  if (sensor.gain > 0)
    variance += std::max(0.0, above_black) / sensor.gain +
                sensor.read_noise * sensor.read_noise / sensor.gain / sensor.gain;
  return variance / frames.frames;
}

void make_linear(double curvature, double& counts, double& variance) {
  const double slope = 1 + 2 * curvature * counts;
  counts *= 1 + curvature * counts;
  variance *= slope * slope;
}

}  // namespace plenoflame
