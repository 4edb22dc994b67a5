#pragma once
#include <limits>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/scene/solid_spec.h"

namespace plenoflame {

inline constexpr int kNoPart = -1;

/// An analytic shape in its place. Intersections are those of the exact shape, computed in double
/// precision in its own frame.
///
/// A ray that starts on a part of the shape does not meet it again at its origin. A curved part has
/// two roots; the one nearest to t = 0 is the origin itself and is left out. A flat part cannot be
/// met a second time. This needs no minimum distance, whatever the scene's size.
class Shape {
 public:
  /// @param spec of any kind but mesh, its sizes above 0
  explicit Shape(const SolidSurfaceSpec& spec);

  /// The first root at t_near < t < t_far. @param from part on which the ray starts, or kNoPart
  /// @return part that is met, kNoPart for none; t is set to where
  int intersect(const Ray& ray, double t_near, double t_far, int from, double& t) const;

  /// Outward unit normal in the world.
  Vec3 normal(int part, Vec3 world) const;
  /// Coordinates on the surface [m]: x, y of flat parts; arc lengths of curved ones, from the
  /// direction +x on, and heights.
  Vec2 coordinates(int part, Vec3 world) const;
  /// World point of such coordinates on part 0 of a disc or plane.
  Vec3 flat_point(Vec2 coordinates) const {
    return to_world_.point({coordinates.x, coordinates.y, 0});
  }

  Box bounds() const;  ///< world; infinite for a plane without end
  bool endless() const;
  double area() const;
  double feature_size() const;
  /// Inside a closed body.
  bool contains(Vec3 world) const;
  /// A point drawn evenly. @param choice, u, v uniform in (0, 1)
  Vec3 draw(double choice, double u, double v, int& part) const;

 private:
  int parts() const;
  double part_area(int part) const;
  void roots(int part, Vec3 o, Vec3 d, double (&t)[2], int& count) const;
  bool bounded(int part, Vec3 p) const;

  SolidShape shape_;
  bool caps_ = true;
  double radius_ = 0, height_ = 0;
  Vec3 half_;  ///< box: half sides in x, y and the full one in z; plane: half sides
  RigidTransform to_world_, to_local_;
};

}  // namespace plenoflame
