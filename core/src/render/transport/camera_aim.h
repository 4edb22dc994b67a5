#pragma once
#include "plenoflame/scene/compile.h"
#include "render/visibility/aperture_cone.h"

namespace plenoflame {

/// Light from the scene into the camera, through windows if there are any.
class CameraAim {
 public:
  /// @param scene kept by reference
  /// @param centre, radius of a sphere around everything that sends light [m] world
  CameraAim(const CompiledScene& scene, Vec3 centre, double radius);

  /// Draws a direction in which a ray from a point may reach the camera. Without windows it is that
  /// of the aperture's cone. With windows most directions lead to a sphere around the aperture,
  /// which is enlarged by the displacement of nine tenths of the rays by windows. Others lead to
  /// spheres of two to eight times the size. Some are drawn from all directions, so that no path is
  /// left out.
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
  const CompiledScene& scene_;
  ApertureCone cone_;
  RigidTransform to_camera_;
  double spread_ = 0;  ///< [m] radius of the smallest sphere
};

}  // namespace plenoflame
