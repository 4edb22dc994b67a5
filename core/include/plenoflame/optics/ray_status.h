#pragma once
#include <string>

namespace plenoflame {

/// The end of a ray through the camera.
enum class RayStatus {
  reached,                    ///< left the camera towards the scene (or arrived at the sensor)
  vignetted,                  ///< outside the clear aperture of `surface`
  total_internal_reflection,  ///< at `surface`
  missed,                     ///< did not meet `surface` at all
};

/// Status with the surface that caused it, numbered as the system that traced the ray says.
struct TraceStatus {
  RayStatus status = RayStatus::reached;
  int surface = -1;
  friend bool operator==(const TraceStatus&, const TraceStatus&) = default;
};

std::string to_string(RayStatus status);

}  // namespace plenoflame
