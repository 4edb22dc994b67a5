#pragma once
#include "plenoflame/camera/camera.h"

namespace plenoflame {

/// The plane, perpendicular to the axis, that has the whole camera on one side.
class CameraFront {
 public:
  explicit CameraFront(const Camera& camera);
  /// [m] distance along a ray with a unit direction to this plane.
  double t_near(const Ray& ray) const {
    return (distance_ - dot(axis_, ray.origin - vertex_)) / dot(axis_, ray.direction);
  }

 private:
  Vec3 axis_, vertex_;
  double distance_ = 0;  ///< [m] from the front vertex, up to the rim of a concave front surface
};

}  // namespace plenoflame
