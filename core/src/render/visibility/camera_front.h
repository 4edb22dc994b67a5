#pragma once
#include "plenoflame/camera/camera.h"

namespace plenoflame {

/// The plane, across the axis, behind which the whole camera lies.
class CameraFront {
 public:
  explicit CameraFront(const Camera& camera);
  /// [m] where a ray with a unit direction leaves the camera.
  double t_near(const Ray& ray) const {
    return (distance_ - dot(axis_, ray.origin - vertex_)) / dot(axis_, ray.direction);
  }

 private:
  Vec3 axis_, vertex_;
  double distance_ = 0;  ///< [m] from the front vertex: the rim of a concave front surface is ahead
};

}  // namespace plenoflame
