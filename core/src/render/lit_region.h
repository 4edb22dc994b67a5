#pragma once
#include <optional>
#include <vector>

#include "plenoflame/camera/camera.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// Boxes in the world that hold everything that can be seen; nullopt when light may come from
/// everywhere.
std::optional<std::vector<Box>> lit_boxes(const CompiledScene& scene);

/// What can be seen of a scene, looked at along the optical axis: two planes across the axis that
/// bracket it, and a raster of the places between them where there is anything.
class LitRegion {
 public:
  LitRegion(const Camera& camera, const std::vector<Box>& world);

  /// False: something is beside or behind the camera's front, and nothing can be said of beams.
  bool bounded() const { return bounded_; }
  /// Distance of the two planes from the front vertex [m].
  double near_plane() const { return planes_[0]; }
  double far_plane() const { return planes_[1]; }

  /// Whether there may be anything in a beam that lies within a disc on each of the two planes, and
  /// between the planes in their hull.
  /// @param centre camera x, y [m]; @param radius [m]
  bool meets(const Vec2 centre[2], double radius) const;

 private:
  static constexpr int kSide = 128;
  int count(int column0, int row0, int column1, int row1) const;
  bool bounded_ = false;
  double planes_[2] = {0, 0};
  Vec2 lower_, upper_;     ///< of the raster, camera x, y [m]
  Vec2 scale_;             ///< places per metre
  std::vector<int> sums_;  ///< (kSide + 1)^2: how many lit places before and above
};

}  // namespace plenoflame
