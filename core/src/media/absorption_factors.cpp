#include "media/absorption_factors.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {

std::vector<double> grey_or_checked(std::vector<double> factors, std::size_t channels) {
  if (std::all_of(factors.begin(), factors.end(), [](double f) { return f == 1; })) return {};
  if (factors.size() != channels)
    throw InputError("a medium needs one absorption factor per channel");
  for (const double factor : factors)
    if (!(factor >= 0) || !std::isfinite(factor))
      throw InputError("an absorption factor must be a number of at least 0");
  return factors;
}

}  // namespace plenoflame
