#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "plenoflame/math/vector.h"

namespace plenoflame {

inline constexpr std::uint32_t kMostCorners = 4096;  ///< of a polygon: cutting takes their square

/// Cuts a polygon into corners - 2 triangles that keep its sense of rotation. The polygon may have
/// notches and needs to be only roughly flat. For a polygon that crosses itself the triangles are
/// arbitrary.
/// @param corners 3 to kMostCorners @param triangles numbers of corners; overwritten
void cut_polygon(const std::vector<Vec3>& corners,
                 std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace plenoflame
