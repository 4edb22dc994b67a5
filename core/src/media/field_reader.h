#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <unordered_map>

#include "plenoflame/media/voxel_medium.h"

namespace plenoflame::voxel {

/// The index of a sample, a cell or a brick, along the three axes.
using Index = std::array<int, 3>;

/// Bricks beyond +- this are refused: their keys would collide, and single precision could not
/// place samples there.
inline constexpr int kFarthestBrick = 1 << 20;

/// a / b, rounded down; b > 0.
constexpr int floor_div(int a, int b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

/// Index of a field's value, by its place in the list of values.
Index index_of(const VoxelField& field, std::size_t value);

/// Access to the bricks of a VoxelField, which must outlive it.
class FieldReader {
 public:
  /// @throws InputError for values that are NaN, infinite or negative, misplaced or repeated
  ///         bricks, and a singular transform; messages name the field and the index.
  explicit FieldReader(const VoxelField& field);
  /// Values of a brick by its origin / 8, nullptr where the field is background.
  const float* brick(Index brick) const;
  /// Value of a sample.
  float at(Index sample) const;
  const VoxelField& field() const { return *field_; }

 private:
  const VoxelField* field_;
  std::unordered_map<std::uint64_t, std::size_t> bricks_;
};

/// Inverse of an affine map. @throws InputError naming `name` when it has none.
AffineTransform inverse(const AffineTransform& map, const std::string& name);

}  // namespace plenoflame::voxel
