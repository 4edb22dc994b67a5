#pragma once
#include <cmath>
#include <optional>

#include "plenoflame/base/constants.h"
#include "plenoflame/solids/lights.h"

namespace plenoflame {

/// A light as a point sees it.
struct LightDirection {
  Vec3 way;                     ///< unit, towards the light
  double distance = kInfinity;  ///< [m]
  double fall = 1;              ///< irradiance across the way, per strength of the light
};

/// None where the light shines past the point, or stands there.
inline std::optional<LightDirection> direction_to(const DeltaLight& light, Vec3 point) {
  if (light.parallel) return LightDirection{-light.direction};
  const Vec3 to_light = light.position - point;
  const double square = dot(to_light, to_light);
  if (!(square > 0)) return std::nullopt;
  const double distance = std::sqrt(square);
  const Vec3 way = (1 / distance) * to_light;
  if (!light.inside_cone(-way)) return std::nullopt;
  return LightDirection{way, distance, 1 / square};
}

}  // namespace plenoflame
