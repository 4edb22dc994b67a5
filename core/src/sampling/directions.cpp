#include "sampling/directions.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

/// cosine * axis + sine * (a direction across it). The orthonormal basis has no branch on the axis'
/// size: Duff et al., JCGT 6 (2017) 1.
Vec3 at_azimuth(Vec3 axis, double cosine, double sine, double v) {
  const double sign = std::copysign(1.0, axis.z);
  const double a = -1 / (sign + axis.z), b = axis.x * axis.y * a;
  const Vec3 e1{1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x};
  const Vec3 e2{b, sign + axis.y * axis.y * a, -axis.y};
  const double azimuth = 2 * constants::pi * v;
  return normalize(cosine * axis + sine * std::cos(azimuth) * e1 + sine * std::sin(azimuth) * e2);
}

}  // namespace

Vec3 cone_direction(Vec3 axis, double versine, double v) {
  return at_azimuth(axis, 1 - versine, std::sqrt(std::max(0.0, versine * (2 - versine))), v);
}

Vec3 cosine_direction(Vec3 normal, double u, double v) {
  return at_azimuth(normal, std::sqrt(1 - u), std::sqrt(u), v);
}

}  // namespace plenoflame
