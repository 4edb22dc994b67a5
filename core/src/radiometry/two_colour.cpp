#include "plenoflame/radiometry/two_colour.h"

#include <cmath>
#include <limits>
#include <vector>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// The response times the law, at points that are far closer than either varies.
SourceFunction weighted(const SpectralResponse& response, const AbsorptionSpectrum& law) {
  if (law.is_grey()) return SourceFunction::of(response);
  std::vector<SpectralPoint> points;
  const auto& breaks = response.breakpoints();
  constexpr int kParts = 64;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
    for (int p = 0; p < kParts; ++p)
      points.push_back({breaks[k] + (breaks[k + 1] - breaks[k]) * p / kParts, 0});
  points.push_back({breaks.back(), 0});
  for (SpectralPoint& point : points)
    point.value = response(point.wavelength) * law.factor(point.wavelength);
  return SourceFunction::of(SpectralResponse::curve(std::move(points)));
}

}  // namespace

TwoColour::TwoColour(const SpectralResponse& first, const SpectralResponse& second,
                     const AbsorptionSpectrum& law)
    : first_(weighted(first, law)), second_(weighted(second, law)) {
  const double middle = 2000;
  const double s = slope(middle);
  sign_ = s > 0 ? 1 : -1;
  // Less than a hundredth of a nanometre apart: nothing but noise would be told apart.
  if (std::fabs(first.centroid() - second.centroid()) < 1e-11 || !(std::fabs(s) > 1e-9))
    throw InputError("two-colour pyrometry needs two channels of different wavelengths");
}

double TwoColour::log_ratio(double temperature) const {
  return std::log(first_(temperature) / second_(temperature));
}

double TwoColour::slope(double temperature) const {
  const double step = 1e-4 * temperature;
  return (log_ratio(temperature + step) - log_ratio(temperature - step)) / (2 * step);
}

double TwoColour::temperature(double ratio) const {
  const double none = std::numeric_limits<double>::quiet_NaN();
  if (!(ratio > 0) || !std::isfinite(ratio)) return none;
  const double goal = std::log(ratio);
  // ln of the ratio is all but a straight line in 1/T: the secant method within a bracket.
  double low = 1 / kHottest, high = 1 / kColdest;
  const auto miss = [&](double inverse) { return sign_ * (goal - log_ratio(1 / inverse)); };
  double at_low = miss(low), at_high = miss(high);
  if (!(at_low <= 0) || !(at_high >= 0)) return none;
  for (int i = 0; i < 100 && high - low > 1e-14 * low; ++i) {
    double x = low - at_low * (high - low) / (at_high - at_low);
    if (i % 3 == 2 || !(x > low && x < high)) x = 0.5 * (low + high);
    const double at = miss(x);
    if (at == 0) return 1 / x;
    (at < 0 ? low : high) = x;
    (at < 0 ? at_low : at_high) = at;
  }
  return 2 / (low + high);
}

}  // namespace plenoflame
