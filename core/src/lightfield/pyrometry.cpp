#include "plenoflame/lightfield/pyrometry.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

double largest(const Image& image) {
  float most = 0;
  for (const float value : image.pixels)
    if (std::isfinite(value)) most = std::max(most, value);
  return static_cast<double>(most);
}

}  // namespace

TemperatureMap two_colour_map(const LightFieldChannel& first, const LightFieldChannel& second,
                              const TwoColour& law, const PyrometrySettings& settings) {
  const Image &a = first.flux, &b = second.flux;
  if (a.empty() || a.width != b.width || a.height != b.height)
    throw InputError("the two channels must have pixels, and the same number of them");
  const double least_a = settings.threshold * largest(a), least_b = settings.threshold * largest(b);
  if (!(least_a > 0) || !(least_b > 0))
    throw InputError("no pixel has light in both channels, so there is no temperature");
  const bool errors = !first.standard_error.empty() && !second.standard_error.empty();
  TemperatureMap map;
  map.temperature = Image(a.width, a.height);
  if (errors) map.standard_error = Image(a.width, a.height);
  double sum = 0, squares = 0, error_squares = 0;
  map.lowest = TwoColour::kHottest;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const double u = a.pixels[i], v = b.pixels[i];
    if (!(u > least_a) || !(v > least_b)) continue;
    const double t = law.temperature(u / v);
    if (!std::isfinite(t)) continue;
    map.temperature.pixels[i] = static_cast<float>(t);
    ++map.pixels;
    // Welford: no digits are lost to the mean.
    const double away = t - sum;
    sum += away / static_cast<double>(map.pixels);
    squares += away * (t - sum);
    map.lowest = std::min(map.lowest, t);
    map.highest = std::max(map.highest, t);
    if (!errors) continue;
    const double relative = std::hypot(static_cast<double>(first.standard_error.pixels[i]) / u,
                                       static_cast<double>(second.standard_error.pixels[i]) / v);
    const double error = relative / std::fabs(law.slope(t));
    map.standard_error.pixels[i] = static_cast<float>(error);
    error_squares += error * error;
  }
  if (map.pixels == 0)
    throw InputError("no pixel's ratio of the two channels is that of a temperature");
  const auto n = static_cast<double>(map.pixels);
  map.mean = sum;
  map.deviation = map.pixels > 1 ? std::sqrt(squares / (n - 1)) : 0;
  if (errors) map.expected_deviation = std::sqrt(error_squares / n);
  return map;
}

}  // namespace plenoflame
