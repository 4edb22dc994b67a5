#include "radiometry/gauss_legendre.h"

#include <cmath>

#include "plenoflame/base/constants.h"

namespace plenoflame {

GaussLegendreRule::GaussLegendreRule(int count)
    : nodes(static_cast<std::size_t>(count)), weights(static_cast<std::size_t>(count)) {
  for (int i = 0; i < count; ++i) {
    // long double: the weights then keep all digits of a double although 1 - x^2 cancels.
    long double x = std::cos(static_cast<long double>(constants::pi) * (i + 0.75L) /
                             (static_cast<long double>(count) + 0.5L));
    long double slope = 1;
    for (int step = 0; step < 20; ++step) {
      long double previous = 1, value = x;  // P_0 and P_1
      for (int k = 2; k <= count; ++k) {
        const long double next = ((2 * k - 1) * x * value - (k - 1) * previous) / k;
        previous = value;
        value = next;
      }
      slope = count * (x * value - previous) / (x * x - 1);
      const long double change = value / slope;
      x -= change;
      if (std::fabs(change) < 1e-18L) break;
    }
    const auto place = static_cast<std::size_t>(count - 1 - i);
    nodes[place] = static_cast<double>(x);
    weights[place] = static_cast<double>(2 / ((1 - x * x) * slope * slope));
  }
}

}  // namespace plenoflame
