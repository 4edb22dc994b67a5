#pragma once
#include <cstddef>
#include <optional>
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
  /// The plane that is this surface of the scene; nullopt: it has an end.
  std::optional<std::size_t> find(int surface) const;
  int surface(std::size_t plane) const { return planes_[plane].surface; }
  Vec3 normal(std::size_t plane) const { return planes_[plane].normal; }

  struct Place {
    Vec3 point;
    double density = 0;  ///< [1/m^2] with which it is drawn; 0: the direction met nothing
  };
  /// @param choice, u, v uniform in (0, 1)
  Place draw(std::size_t plane, double choice, double u, double v) const;
  double density(std::size_t plane, Vec3 point) const;

  struct Leaving {
    Vec3 direction;
    double weight = 0;  ///< cos / pi over the density of directions; 0: there is none
  };
  /// A direction in which light that a plane reflects or emits diffusely goes on to other surfaces.
  /// Light that starts at the distance r on a plane stands for r^3 times as much as near the
  /// objects: directions drawn by the cosine alone would all but never meet what the camera sees,
  /// and carry a weight without bound when they do. So directions towards everything with an end,
  /// and towards points drawn on the other planes, are drawn as well, and the density is that of
  /// all ways together. Of the light that goes from the distance r to another plane a share of
  /// (R / r)^3 ends at the distance R, where it is worth R^-3: points are drawn there with the same
  /// probability in every octave of R up to r: weights stay bounded for a number of reflections.
  /// @param normal of the plane, on the side that light leaves from
  /// @param way, choice, u, v uniform in (0, 1)
  Leaving leave(std::size_t plane, Vec3 point, Vec3 normal, double way, double choice, double u,
                double v) const;

  /// Finds where a line crosses a plane. @return false when it is parallel to it
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
  static double per_area(const Plane& plane, Vec3 way);
  static Vec3 foot(const Plane& plane);
  Place meet(std::size_t index, Vec3 from, Vec3 direction) const;
  double cone_density(const Plane& plane, Vec3 point) const;
  double disc_reach(const Plane& plane, Vec3 from) const;
  /// Points for light that comes from a point of another plane.
  Place draw_from(std::size_t index, Vec3 from, double choice, double u, double v) const;
  double density_from(std::size_t index, Vec3 from, Vec3 point) const;
  /// The versine of a sphere seen from a point: 1 - cos of its half angle; 0 from inside, or where
  /// there is none.
  double versine_of_objects(Vec3 point) const;

  std::vector<Plane> planes_;
  struct Cone {
    Vec3 apex;
    double versine = 0;
  };
  Cone cones_[2];  ///< of what is imaged sharply, and of everything that the camera sees
  Vec3 axis_;      ///< of both
  Vec3 centre_;    ///< of a sphere around everything with an end
  double radius_;  ///< [m]; 0: there is nothing
};

}  // namespace plenoflame
