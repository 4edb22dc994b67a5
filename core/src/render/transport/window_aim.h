#pragma once
#include "render/transport/window_ways.h"
#include "render/visibility/aperture_cone.h"

namespace plenoflame {

/// Light from the scene through its windows into the camera.
class WindowAim {
 public:
  /// @param centre, radius of a sphere around everything that sends light [m] world
  WindowAim(const Camera& camera, const WindowSet& windows, Vec3 centre, double radius);

  /// Draws a direction in which a ray from a point may reach the camera. Most directions lead to a
  /// sphere around the aperture, which is enlarged by the displacement of nine tenths of the rays
  /// by windows. Others lead to spheres of two to eight times the size. Some are drawn from all
  /// directions, so that no path is left out.
  /// @param point, result in the camera's frame; solid_angle is one over the density and therefore
  /// differs between directions
  /// @param u, v uniform in (0, 1)
  ApertureCone::Direction draw(Vec3 point, double u, double v) const;

  /// Follows a ray to the plane of the camera's front, where the last stretch of the path then
  /// ends.
  /// @param world from a point in air @param arriving the stretch in the camera's frame
  /// @return false when the ray does not reach the plane
  bool follow(const Ray& world, WindowPath& path, Ray& arriving) const;

 private:
  const WindowSet& windows_;
  ApertureCone cone_;
  RigidTransform to_camera_;
  double spread_ = 0;  ///< [m] radius of the smallest sphere
};

}  // namespace plenoflame
