#include "plenoflame/radiometry/two_colour.h"

#include <cmath>
#include <limits>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

SourceFunction weighted(const SpectralResponse& response, const AbsorptionSpectrum& law) {
  return SourceFunction::of(response.times([&](double at) { return law.factor(at); }));
}

}  // namespace

TwoColour::TwoColour(const SpectralResponse& first, const SpectralResponse& second,
                     const AbsorptionSpectrum& law)
    : first_(weighted(first, law)), second_(weighted(second, law)) {
  const double middle = 2000;
  const double s = slope(middle);
  sign_ = s > 0 ? 1 : -1;
  // Less than a hundredth of a nanometre apart: the ratio would be noise.
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
