#include "media/voxels/majorant_grid.h"

#include <algorithm>

namespace plenoflame {
namespace {

constexpr int kMostCells = 32;  ///< along the longest side
/// Margin of a box, relative to the medium's size: rounding may move a place near a cell's face to
/// the other side.
constexpr double kRounding = 1e-9;

}  // namespace

MajorantGrid::MajorantGrid(const Medium& medium)
    : bounds_(medium.bounds()), majorants_(medium.majorants()) {
  const Vec3 lower = bounds_.lower, sides = bounds_.upper - bounds_.lower;
  lower_ = {lower.x, lower.y, lower.z};
  size_ = {sides.x, sides.y, sides.z};
  const double longest = std::max({size_[0], size_[1], size_[2]});
  const double most = *std::max_element(majorants_.begin(), majorants_.end());
  // Crossing a cell takes a fraction of the time of looking up a place. One cell per mean free path
  // is therefore cheap, up to kMostCells.
  const double cells = std::clamp(most * longest, 1.0, static_cast<double>(kMostCells));
  for (std::size_t a = 0; a < 3; ++a) {
    count_[a] = std::max(1, static_cast<int>(std::ceil(cells * size_[a] / longest - kRounding)));
    size_[a] /= count_[a];
  }
  const double margin = kRounding * (longest + length(lower));
  const Vec3 wide{margin, margin, margin};
  for (int i = 0; i < count_[0]; ++i)
    for (int j = 0; j < count_[1]; ++j)
      for (int k = 0; k < count_[2]; ++k) {
        const Vec3 corner{lower.x + i * size_[0], lower.y + j * size_[1], lower.z + k * size_[2]};
        const Box box{corner - wide, corner + Vec3{size_[0], size_[1], size_[2]} + wide};
        // Rounded up.
        shares_.push_back(static_cast<float>(medium.largest_share(box)) * (1 + 0x1p-22F));
      }
}

std::array<int, 3> MajorantGrid::index_at(Vec3 world) const {
  const double at[3] = {world.x, world.y, world.z};
  std::array<int, 3> index;
  for (std::size_t a = 0; a < 3; ++a)
    // A flame that is nothing beside its distance from the origin may have no thickness.
    index[a] = size_[a] > 0 ? static_cast<int>(std::clamp(
                                  std::floor((at[a] - lower_[a]) / size_[a]), 0.0, count_[a] - 1.0))
                            : 0;
  return index;
}

double MajorantGrid::mean_share() const {
  double sum = 0;
  for (const float share : shares_) sum += static_cast<double>(share);
  return sum / static_cast<double>(shares_.size());
}

}  // namespace plenoflame
