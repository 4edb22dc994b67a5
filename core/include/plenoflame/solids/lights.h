#pragma once
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/radiometry/source_function.h"
#include "plenoflame/scene/light_spec.h"

namespace plenoflame {

/// A point or parallel light, compiled.
struct DeltaLight {
  bool parallel = false;
  Vec3 position;       ///< [m] world; point
  Vec3 direction;      ///< unit, in which the light goes; axis of the cone
  double versine = 2;  ///< 1 - cos of half the cone's angle; 2: all directions
  /// Per channel: radiant intensity [W/sr] of a point, irradiance [W/m^2] across a parallel light.
  std::vector<double> strength;

  bool inside_cone(Vec3 way) const { return 1 - dot(way, direction) <= versine; }
  double solid_angle() const;  ///< [sr] of the cone
};

/// All lights of a scene, compiled.
struct Lights {
  std::vector<DeltaLight> delta;
  /// Radiance of the surroundings per channel [W/(m^2 sr)], all environment lights together; empty
  /// when there are none.
  std::vector<double> environment;

  bool empty() const { return delta.empty() && environment.empty(); }
};

/// @param channels one source function per channel, for lights with a temperature
Lights compile_lights(const std::vector<LightSpec>& lights,
                      const std::vector<SourceFunction>& channels);

}  // namespace plenoflame
