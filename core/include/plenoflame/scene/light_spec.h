#pragma once
#include <string>

#include "plenoflame/math/vector.h"

/// Light sources as plain values (scene.h).
namespace plenoflame {

enum class LightKind {
  point,        ///< evenly into a cone
  parallel,     ///< from infinitely far in one direction
  environment,  ///< the same radiance from everywhere
};

/// A light source. Its figure holds in every channel, or, with a temperature, for all wavelengths
/// together. In the second case a channel has its share of a blackbody of that temperature.
struct LightSpec {
  LightKind kind = LightKind::point;
  std::string name;
  Vec3 position;             ///< [m] world; point
  Vec3 direction{0, 0, -1};  ///< world, in which the light goes; point, parallel
  double cone = 0;           ///< [rad] point: full angle of the cone; 0: all directions
  double power = 0;          ///< [W] point: into the cone
  double irradiance = 0;     ///< [W/m^2] parallel: on a plane across the direction
  double radiance = 0;       ///< [W/(m^2 sr)] environment
  double temperature = 0;    ///< [K] 0: the same in every channel
  friend bool operator==(const LightSpec&, const LightSpec&) = default;
};

}  // namespace plenoflame
