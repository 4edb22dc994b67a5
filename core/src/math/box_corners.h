#pragma once
#include <array>
#include <cstddef>

#include "plenoflame/math/vector.h"

namespace plenoflame {

inline std::array<Vec3, 8> corners(const Box& box) {
  std::array<Vec3, 8> points;
  for (std::size_t i = 0; i < 8; ++i)
    points[i] = {(i & 1) ? box.upper.x : box.lower.x, (i & 2) ? box.upper.y : box.lower.y,
                 (i & 4) ? box.upper.z : box.lower.z};
  return points;
}

}  // namespace plenoflame
