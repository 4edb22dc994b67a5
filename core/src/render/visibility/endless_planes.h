#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// The infinite planes of a scene, and points drawn on them where light can matter. A third of the
/// points lies in the cone of the camera's field, and a third in a wider cone around its whole
/// beam. The last third is drawn by directions from a point above the objects. Its density
/// decreases with the third power of the distance and is positive everywhere.
class EndlessPlanes {
 public:
  /// @param centre, radius of a sphere around all finite objects; radius 0: there are none
  /// @param field_versine 1 - cos of the largest angle of the camera's field
  EndlessPlanes(const CompiledScene& scene, Vec3 centre, double radius, double field_versine);

  std::size_t count() const { return planes_.size(); }
  /// The plane of this surface of the scene; nullopt: the surface is finite.
  std::optional<std::size_t> find(int surface) const;
  int surface(std::size_t plane) const { return planes_[plane].surface; }
  Vec3 normal(std::size_t plane) const { return planes_[plane].normal; }

  struct Place {
    Vec3 point;
    double density = 0;  ///< [1/m^2] with which it is drawn; 0: the direction misses the plane
  };
  /// @param choice, u, v uniform in (0, 1)
  Place draw(std::size_t plane, double choice, double u, double v) const;
  double density(std::size_t plane, Vec3 point) const;

  struct Leaving {
    Vec3 direction;
    double weight = 0;  ///< cos / pi over the density of directions; 0: no direction
  };
  /// Draws a direction to other surfaces for light that a plane reflects or emits diffusely. Light
  /// that starts at the distance r on a plane has r^3 times the weight of light near the objects.
  /// Directions drawn by the cosine alone would almost never meet visible objects, and their
  /// weights would be unbounded. Some directions are therefore drawn towards all finite objects,
  /// and some towards points on the other planes. The density is that of all ways together.
  ///
  /// Light goes from the distance r to another plane. A share of (R / r)^3 of it ends at the
  /// distance R, where its value is R^-3. Points on that plane are therefore drawn with equal
  /// probability in every octave of R up to r. Weights then stay bounded for a number of
  /// reflections.
  /// @param outwards from the point, along the normal on the side on which light leaves
  /// @param way, choice, u, v uniform in (0, 1)
  Leaving leave(std::size_t plane, const Ray& outwards, double way, double choice, double u,
                double v) const;

  /// Finds where a line crosses a plane. @return false when it is parallel to it
  bool crossing(std::size_t plane, const Ray& line, double& t) const;
  /// A number below all t at which the line crosses a plane, and not above `t`.
  double before(const Ray& line, double t) const;

 private:
  struct Plane {
    int surface;
    Vec3 origin, normal, x, y;
    Vec2 half;     ///< [m] half of the sides
    Vec3 lookout;  /// point above the objects, on the side of the camera
    double height;
  };
  bool on_plane(const Plane& plane, Vec3 point) const;
  static double per_area(const Plane& plane, Vec3 way);
  static Vec3 foot(const Plane& plane);
  Place meet(std::size_t index, Vec3 from, Vec3 direction) const;
  double cone_density(const Plane& plane, Vec3 point) const;
  double disc_reach(const Plane& plane, Vec3 from) const;
  /// Draws points for light that comes from a point of another plane.
  Place draw_from(std::size_t index, Vec3 from, double choice, double u, double v) const;
  double density_from(std::size_t index, Vec3 from, Vec3 point) const;
  /// 1 - cos of the half angle of the objects' sphere seen from a point; 0 from inside, or without
  /// objects.
  double versine_of_objects(Vec3 point) const;

  std::vector<Plane> planes_;
  struct Cone {
    Vec3 apex;
    double versine = 0;
  };
  Cone cones_[2];  ///< of the sharply imaged field, and of the whole visible field
  Vec3 axis_;      ///< axis of both cones
  Vec3 centre_;    ///< of a sphere around all finite objects
  double radius_;  ///< [m]; 0: there are none
};

}  // namespace plenoflame
