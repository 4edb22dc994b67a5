#pragma once
#include <cstddef>
#include <vector>

#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// The planes without end of a scene, and points drawn on them where light can matter: a third of
/// them each by directions within the cone of the camera's field, within a wider one around its
/// whole beam, and below a point above the objects, so that their density falls with the third
/// power of the distance, and no place has none.
class EndlessPlanes {
 public:
  /// @param centre, radius of a sphere around everything with an end; radius 0: there is nothing
  /// @param field_versine 1 - cos of the widest angle at which the camera looks
  EndlessPlanes(const CompiledScene& scene, Vec3 centre, double radius, double field_versine);

  std::size_t count() const { return planes_.size(); }
  int surface(std::size_t plane) const { return planes_[plane].surface; }
  Vec3 normal(std::size_t plane) const { return planes_[plane].normal; }

  struct Place {
    Vec3 point;
    double density = 0;  ///< [1/m^2] with which it is drawn; 0: the direction met nothing
  };
  /// @param choice, u, v uniform in (0, 1)
  Place draw(std::size_t plane, double choice, double u, double v) const;
  double density(std::size_t plane, Vec3 point) const;

  /// Where a line crosses a plane. @return false when it is parallel to it
  bool crossing(std::size_t plane, const Ray& line, double& t) const;
  /// A number below all t at which the line crosses a plane, and at most `t`.
  double before(const Ray& line, double t) const;

 private:
  struct Plane {
    int surface;
    Vec3 origin, normal, x, y;
    Vec2 half;     ///< [m] of its sides
    Vec3 lookout;  /// above the objects, on the side of the camera
    double height;
  };
  bool on_plane(const Plane& plane, Vec3 point) const;

  std::vector<Plane> planes_;
  struct Cone {
    Vec3 apex;
    double versine = 0;
  };
  Cone cones_[2];  ///< of what is imaged sharply, and of everything that the camera sees
  Vec3 axis_;      ///< of both
};

}  // namespace plenoflame
