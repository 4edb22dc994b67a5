#include "plenoflame/lightfield/pyrometry.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// Sums over the pixels of a bin, first and second channel.
struct Sums {
  double count = 0;
  double light[2] = {}, variance[2] = {};
  double temperature = 0, error = 0;  ///< [K]; 0: none
};

std::vector<Sums> sums_of(const LightFieldChannel& first, const LightFieldChannel& second,
                          bool errors, const PixelBins* bins) {
  std::vector<Sums> sums(bins ? bins->count : first.flux.pixels.size());
  for (std::size_t i = 0; i < first.flux.pixels.size(); ++i) {
    if (bins && bins->of_pixel[i] < 0) continue;
    const double values[2] = {first.flux.pixels[i], second.flux.pixels[i]};
    if (!std::isfinite(values[0]) || !std::isfinite(values[1])) continue;
    Sums& sum = sums[bins ? static_cast<std::size_t>(bins->of_pixel[i]) : i];
    sum.count += 1;
    for (int c = 0; c < 2; ++c) {
      sum.light[c] += values[c];
      if (!errors) continue;
      const double error = (c == 0 ? first : second).standard_error.pixels[i];
      sum.variance[c] += error * error;
    }
  }
  return sums;
}

/// Decides which bins have a temperature, and which.
void find_temperatures(std::vector<Sums>& sums, const TwoColour& law,
                       const PyrometrySettings& settings) {
  double largest[2] = {};
  for (const Sums& sum : sums)
    for (int c = 0; c < 2; ++c)
      if (sum.count > 0) largest[c] = std::max(largest[c], sum.light[c] / sum.count);
  const double least[2] = {settings.threshold * largest[0], settings.threshold * largest[1]};
  if (!(least[0] > 0) || !(least[1] > 0))
    throw InputError("no pixel has light in both channels, so there is no temperature");
  for (Sums& sum : sums) {
    bool good = sum.count > 0;
    for (int c = 0; c < 2 && good; ++c)
      good = sum.light[c] / sum.count > least[c] &&
             sum.light[c] > settings.least_signal_to_noise * std::sqrt(sum.variance[c]);
    if (!good) continue;
    const double t = law.temperature(sum.light[0] / sum.light[1]);
    if (!std::isfinite(t)) continue;
    sum.temperature = t;
    const double relative = std::hypot(std::sqrt(sum.variance[0]) / sum.light[0],
                                       std::sqrt(sum.variance[1]) / sum.light[1]);
    sum.error = relative / std::fabs(law.slope(t));
  }
}

}  // namespace

TemperatureMap two_colour_map(const LightFieldChannel& first, const LightFieldChannel& second,
                              const TwoColour& law, const PyrometrySettings& settings,
                              const PixelBins* bins) {
  const Image &a = first.flux, &b = second.flux;
  if (a.empty() || a.width != b.width || a.height != b.height)
    throw InputError("the two channels must have pixels, and the same number of them");
  if (bins && bins->of_pixel.size() != a.pixels.size())
    throw InputError("the bins must be those of the channels' pixels");
  const bool errors = !first.standard_error.empty() && !second.standard_error.empty();
  std::vector<Sums> sums = sums_of(first, second, errors, bins);
  find_temperatures(sums, law, settings);
  TemperatureMap map;
  map.lowest = TwoColour::kHottest;
  double squares = 0, error_squares = 0;
  for (const Sums& sum : sums) {
    if (!(sum.temperature > 0)) continue;
    ++map.bins;
    // Welford: no digits are lost to the mean.
    const double away = sum.temperature - map.mean;
    map.mean += away / static_cast<double>(map.bins);
    squares += away * (sum.temperature - map.mean);
    map.lowest = std::min(map.lowest, sum.temperature);
    map.highest = std::max(map.highest, sum.temperature);
    error_squares += sum.error * sum.error;
  }
  if (map.bins == 0)
    throw InputError("no pixel's ratio of the two channels is that of a temperature");
  const auto n = static_cast<double>(map.bins);
  map.deviation = map.bins > 1 ? std::sqrt(squares / (n - 1)) : 0;
  if (errors) map.expected_deviation = std::sqrt(error_squares / n);
  map.temperature = Image(a.width, a.height);
  if (errors) map.standard_error = Image(a.width, a.height);
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    if ((bins && bins->of_pixel[i] < 0) || !std::isfinite(a.pixels[i]) ||
        !std::isfinite(b.pixels[i]))
      continue;
    const Sums& sum = sums[bins ? static_cast<std::size_t>(bins->of_pixel[i]) : i];
    if (!(sum.temperature > 0)) continue;
    ++map.pixels;
    map.temperature.pixels[i] = static_cast<float>(sum.temperature);
    if (errors) map.standard_error.pixels[i] = static_cast<float>(sum.error);
  }
  return map;
}

}  // namespace plenoflame
