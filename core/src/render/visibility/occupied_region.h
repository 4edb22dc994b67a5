#pragma once
#include <optional>
#include <vector>

#include "plenoflame/camera/camera.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// World boxes that contain everything visible; nullopt if light may come from everywhere.
std::optional<std::vector<Box>> occupied_boxes(const CompiledScene& scene);

/// The region of a scene that may contain anything visible. Two planes perpendicular to the optical
/// axis bracket it. A raster marks the cells between them that contain something.
class OccupiedRegion {
 public:
  OccupiedRegion(const Camera& camera, const std::vector<Box>& world);

  /// False: something is beside or behind the camera's front, so that beams have no bounds.
  bool bounded() const { return bounded_; }
  /// Distance of the two planes from the front vertex [m].
  double near_plane() const { return planes_[0]; }
  double far_plane() const { return planes_[1]; }

  /// Tells whether a beam may meet anything. On each of the two planes the beam is inside a disc,
  /// and between the planes inside their hull.
  /// @param centre camera x, y [m] @param radius [m]
  bool meets(const Vec2 centre[2], double radius) const;

  /// Tells whether a line parallel to the axis meets something, or nearly so. A beam through this
  /// point needs no further test.
  /// @param p camera x, y [m]
  bool holds(Vec2 p) const;

 private:
  static constexpr int kSide = 128;
  bool is_beyond(Vec2 centre, double radius) const;
  std::size_t place_of(Vec2 p) const;
  bool bounded_ = false;
  double planes_[2] = {0, 0};
  Vec2 lower_, upper_;  ///< corners of the raster, camera x, y [m]
  Vec2 scale_;          ///< cells per metre
  /// Lower bounds of the distance from any point of a cell to the nearest lit cell [m]; kSide^2
  /// entries.
  std::vector<double> to_lit_;
};

}  // namespace plenoflame
