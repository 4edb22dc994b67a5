#pragma once
#include <array>
#include <vector>

#include "plenoflame/optics/window_set.h"

namespace plenoflame {

inline constexpr int kNoFace = -1;

/// A window in its place: the part of space on the glass side of all its faces.
class WindowSet::Body {
 public:
  explicit Body(const WindowSpec& spec);

  struct Hit {
    double t = 0;
    int face = kNoFace;  ///< kNoFace: none
  };
  /// The first face that a ray meets at 0 < t < far.
  /// @param from face of this window on which the ray starts, or kNoFace. The ray does not meet its
  ///        origin again, however it was rounded
  Hit intersect(const Ray& world, int from, double far) const;
  /// Unit normal of a face, out of the glass, in the world.
  Vec3 normal(int face, Vec3 world) const;
  /// Tells whether light passes a face: the others are ground, and black.
  bool is_polished(int face) const { return faces_[static_cast<std::size_t>(face)].polished; }
  bool contains(Vec3 world) const;
  std::vector<Vec3> points() const;
  std::vector<std::vector<Vec3>> outline() const;
  /// Tells whether a ray comes within the sphere around the window, ahead of its origin.
  bool may_meet(const Ray& world) const;

  double index() const { return spec_.index; }
  double absorption() const { return spec_.absorption; }
  bool fresnel() const { return spec_.fresnel; }

 private:
  enum class Kind { plane, cylinder, sphere };
  struct Face {
    Kind kind = Kind::plane;
    bool polished = false;
    Vec3 normal;          ///< plane: out of the glass
    double offset = 0;    ///< plane: dot(normal, p) on it [m]
    double radius = 0;    ///< [m] cylinder around z, sphere around the origin
    bool hollow = false;  ///< the glass is outside of it
  };
  static double beyond(const Face& face, Vec3 local);
  void add_rim();
  Vec3 point_of(double u, double v, double w) const;
  std::array<int, 3> counts() const;

  WindowSpec spec_;
  RigidTransform to_world_, to_local_;
  std::vector<Face> faces_;
  Vec3 centre_;              ///< world, of a sphere around the window
  double reach_square_ = 0;  ///< [m^2] its radius, squared
};

}  // namespace plenoflame
