#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "plenoflame/media/voxel_medium.h"

/// Helpers for VoxelField that need no OpenVDB.
namespace plenoflame::detail {

inline constexpr int kBrickSize = 8;
inline constexpr std::size_t kBrickValues = 512;

/// Index of value v (0 to 511) of brick b.
std::array<int, 3> voxel_index(const VoxelField& field, std::size_t brick, std::size_t value);

double determinant(const Mat3& m);
/// False for a singular matrix or one that holds NaN or infinity.
bool is_regular(const AffineTransform& transform);
AffineTransform inverse(const AffineTransform& transform);

struct FieldRange {
  float minimum = 0;
  float maximum = 0;
};
/// Smallest and largest stored value; empty when there are no bricks.
std::optional<FieldRange> range(const VoxelField& field);

/// Number of values that differ from the background.
std::uint64_t occupied_voxels(const VoxelField& field);

/// "(12, -3, 8)"
std::string to_string(const std::array<int, 3>& index);

/// Lower case, ASCII only.
std::string lower_case(std::string text);

}  // namespace plenoflame::detail
