#include "emission_span.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace plenoflame {

double thermal_emission(double temperature, double absorption) {
  return absorption * std::pow(temperature / 1000, 4);
}

std::array<double, 2> emission_span(std::span<const float> temperature,
                                    std::span<const float> absorption) {
  double low = 1e300, high = 0;
  for (std::size_t i = 0; i < temperature.size(); ++i) {
    if (!(absorption[i] > 0)) continue;
    low = std::min(low, static_cast<double>(temperature[i]));
    high = std::max(high, static_cast<double>(temperature[i]));
  }
  if (low > high) return {0, 0};
  constexpr double kLeast = 100;  // [K]: less would show rounding as a pattern
  constexpr std::size_t kBins = 1000;
  constexpr double kBelow = 0.01, kAbove = 0.001;  // shares of the emission beyond the ends
  std::array<double, kBins> bins{};
  double total = 0;
  const double step = (high - low) / kBins;
  for (std::size_t i = 0; i < temperature.size(); ++i) {
    if (!(absorption[i] > 0)) continue;
    const double t = temperature[i];
    const auto bin = static_cast<std::size_t>(step > 0 ? (t - low) / step : 0);
    const double emission = thermal_emission(t, absorption[i]);
    bins[std::min(bin, kBins - 1)] += emission;
    total += emission;
  }
  std::size_t first = 0, last = kBins;
  for (double sum = 0; first + 1 < kBins && sum + bins[first] < kBelow * total; ++first)
    sum += bins[first];
  for (double sum = 0; last > first + 1 && sum + bins[last - 1] < kAbove * total; --last)
    sum += bins[last - 1];
  std::array<double, 2> span{low + static_cast<double>(first) * step,
                             low + static_cast<double>(last) * step};
  const double missing = kLeast - (span[1] - span[0]);
  if (missing > 0) {
    span[0] = std::max(0.0, span[0] - 0.5 * missing);
    span[1] = span[0] + kLeast;
  }
  return span;
}

}  // namespace plenoflame
