#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "plenoflame/math/ray_span.h"
#include "plenoflame/media/medium.h"
#include "plenoflame/sampling/noise.h"

namespace plenoflame {

/// Places in a medium where light may be absorbed or scattered. Delta tracking (Woodcock et al.,
/// ANL-7050, 1965) proposes them with a majorant for each cell of a coarse grid (Szirmay-Kalos et
/// al., Comput. Graph. Forum 30 (2011) 1823). A dense wisp in a wide thin cloud therefore costs
/// steps only where it is. Immutable.
class MajorantGrid {
 public:
  /// @throws InputError when the medium does not know its largest absorption
  explicit MajorantGrid(const Medium& medium);

  /// Proposes places along the ray within the bounds and the span, by the majorant of a node, until
  /// one is accepted. The function accept(t, majorant) [m, 1/m] must accept with the
  /// probability extinction / majorant.
  /// @return whether one was; t is its place then
  template <class Accept>
  bool draw(const Ray& ray, const RaySpan& within, std::size_t node, NoiseStream& noise, double& t,
            Accept accept) const;

  /// Most that absorption can be at a place of the bounds, over its largest anywhere; every node.
  double share_at(Vec3 world) const { return shares_[static_cast<std::size_t>(cell_at(world))]; }
  /// Mean of that over the bounds.
  double mean_share() const;
  double majorant(std::size_t node) const { return majorants_[node]; }
  std::size_t cells() const { return shares_.size(); }

 private:
  std::array<int, 3> index_at(Vec3 world) const;
  int cell_of(const std::array<int, 3>& index) const {
    return (index[0] * count_[1] + index[1]) * count_[2] + index[2];
  }
  int cell_at(Vec3 world) const { return cell_of(index_at(world)); }

  Box bounds_;
  std::vector<double> majorants_;
  std::array<int, 3> count_{1, 1, 1};
  std::array<double, 3> lower_{}, size_{};  ///< of the grid, of a cell [m]
  std::vector<float> shares_;
};

template <class Accept>
bool MajorantGrid::draw(const Ray& ray, const RaySpan& within, std::size_t node, NoiseStream& noise,
                        double& t, Accept accept) const {
  const RaySpan span = clip_to_box(bounds_, ray, within.near, within.far);
  const double majorant = majorants_[node];
  if (span.empty() || !(majorant > 0)) return false;
  t = span.near;
  std::array<int, 3> index = index_at(ray.at(t));
  const double origin[3] = {ray.origin.x, ray.origin.y, ray.origin.z};
  const double along[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  std::array<double, 3> leaves;  // where the ray leaves the cell through the faces of each axis
  const auto leave = [&](std::size_t a) {
    if (along[a] == 0) return span.far;
    const double face = lower_[a] + size_[a] * (index[a] + (along[a] > 0 ? 1 : 0));
    return (face - origin[a]) / along[a];
  };
  for (std::size_t a = 0; a < 3; ++a) leaves[a] = leave(a);
  double left = -std::log(noise.uniform());  // optical depth up to the next place
  for (;;) {
    std::size_t axis = leaves[0] < leaves[1] ? 0 : 1;
    if (leaves[2] < leaves[axis]) axis = 2;
    const double end = leaves[axis] < span.far ? leaves[axis] : span.far;
    const double most =
        majorant * static_cast<double>(shares_[static_cast<std::size_t>(cell_of(index))]);
    while (most * (end - t) > left) {
      t += left / most;
      if (accept(t, most)) return true;
      left = -std::log(noise.uniform());
    }
    left -= most * (end > t ? end - t : 0);
    if (end > t) t = end;
    index[axis] += along[axis] > 0 ? 1 : -1;
    if (!(t < span.far) || index[axis] < 0 || index[axis] >= count_[axis]) return false;
    leaves[axis] = leave(axis);
  }
}

}  // namespace plenoflame
