#pragma once
#include <array>
#include <optional>
#include <vector>

#include "plenoflame/camera/camera.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/scene/compile.h"
#include "render/visibility/pixel_row_kernel.h"

namespace plenoflame {

/// Boxes in the world that hold everything that can be seen; nullopt when light may come from
/// everywhere.
std::optional<std::vector<Box>> occupied_boxes(const CompiledScene& scene);

/// The region of a scene where anything can be seen, looked at along the optical axis: two planes
/// across the axis that bracket it, and a raster of the places between them where there is
/// anything.
class OccupiedRegion {
 public:
  OccupiedRegion(const Camera& camera, const std::vector<Box>& world);

  /// False: something is beside or behind the camera's front, and nothing can be said of beams.
  bool bounded() const { return bounded_; }
  /// Distance of the two planes from the front vertex [m].
  double near_plane() const { return planes_[0]; }
  double far_plane() const { return planes_[1]; }

  /// Tells whether there may be anything in a beam that lies within a disc on each of the two
  /// planes, and between the planes in their hull.
  /// @param centre camera x, y [m]; @param radius [m]
  bool meets(const Vec2 centre[2], double radius) const;
  /// Copies the raster's place and refers to it.
  void describe(KernelBeam& beam) const;

  /// Tells whether there is something, or nearly so, where a line along the axis passes: what goes
  /// through there needs no closer look.
  /// @param p camera x, y [m]
  bool holds(Vec2 p) const;

  /// Tells whether there is something wherever a ray of that beam crosses one of the planes:
  /// nothing in it is worth a closer look. May say no where the answer is yes.
  bool is_filled(const Vec2 centre[2], double radius) const;

 private:
  static constexpr int kSide = kRasterSide;
  bool is_beyond(Vec2 centre, double radius) const;
  std::size_t place_of(Vec2 p) const;
  bool bounded_ = false;
  double planes_[2] = {0, 0};
  Vec2 lower_, upper_;  ///< of the raster, camera x, y [m]
  Vec2 scale_;          ///< places per metre
  /// Distances of kSide^2 places: how far, at least, any point of each is from the nearest lit one,
  /// and from the nearest dark one [m].
  std::vector<double> to_lit_, to_dark_;
};

}  // namespace plenoflame
