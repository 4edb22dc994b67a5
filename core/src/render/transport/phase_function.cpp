#include "render/transport/phase_function.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"

namespace plenoflame {

double phase_function(const ScatteringSpec& spec, double cosine) {
  if (spec.phase == PhaseFunction::rayleigh)
    return 3 * (1 + cosine * cosine) / (16 * constants::pi);
  const double g = spec.asymmetry, base = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (4 * constants::pi * base * std::sqrt(base));
}

double draw_cosine(const ScatteringSpec& spec, double u) {
  if (spec.phase == PhaseFunction::rayleigh) {
    // Solves c^3 + 3 c = 8 u - 4 by Cardano's formula.
    const double a = 4 * u - 2, root = std::cbrt(a + std::sqrt(a * a + 1));
    return std::clamp(root - 1 / root, -1.0, 1.0);
  }
  const double g = spec.asymmetry;
  if (std::fabs(g) < 1e-3) {
    // The first terms in g of the inverse, which would lose its digits for small g.
    const double c = 1 - 2 * u;
    return std::clamp(-c + 1.5 * g * (1 - c * c), -1.0, 1.0);
  }
  const double s = (1 - g * g) / (1 - g + 2 * g * u);
  return std::clamp((1 + g * g - s * s) / (2 * g), -1.0, 1.0);
}

}  // namespace plenoflame
