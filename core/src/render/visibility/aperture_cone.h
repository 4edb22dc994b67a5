#pragma once
#include "plenoflame/camera/camera.h"

namespace plenoflame {

/// The directions in which light may enter a camera, in the camera frame. Seen from a point of the
/// scene, they form the cone around a sphere. The sphere encloses the front surface's clear
/// aperture, or the entrance pupil of an ideal main lens.
class ApertureCone {
 public:
  explicit ApertureCone(const Camera& camera);

  /// Tells whether a point lies on the scene's side of the camera.
  bool in_front(Vec3 point) const { return point.z > front_; }

  /// [m] along a direction with z < 0, from a point in front, to the plane of the camera's front.
  double distance_to_front(Vec3 point, Vec3 direction) const {
    return (point.z - front_) / -direction.z;
  }

  /// z of the plane where the scene begins [m].
  double front() const { return front_; }
  /// Centre and radius of the sphere [m]; radius 0: there is no sphere.
  Vec3 centre() const { return centre_; }
  double radius() const { return telecentric_ > 0 ? 0 : radius_; }

  struct Direction {
    Vec3 direction;  ///< towards -z
    double solid_angle =
        0;  ///< [sr] over which directions are drawn evenly; 0: away from the camera
  };
  /// @param u, v uniform in (0, 1)
  Direction draw(Vec3 point, double u, double v) const;

 private:
  void widen_by_distortion(const Camera& camera);
  void move_with(const Camera& camera);
  double front_ = 0;   ///< z of the plane where the scene begins [m]
  Vec3 centre_;        ///< of the sphere [m]
  double radius_ = 0;  ///< [m]
  /// Lines through the sphere count in both directions, since a pupil may be behind the flame.
  bool pupil_ = false;
  double telecentric_ = 0;  ///< > 0: no sphere; tangent of the largest angle with the axis
};

}  // namespace plenoflame
