#pragma once
#include <cstddef>

#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Rays as a structure of arrays, in world axes. Positions are relative to `anchor`, which is
/// chosen near the medium so that single precision suffices. A ray is the full line anchor + p + t
/// d with p = (x, y, z) and d = (dx, dy, dz). It runs from the camera (t = t_near) into the scene.
/// The point p may be any point of the line; it should be the one nearest to the anchor's depth.
/// Arrays are 64-byte aligned and padded to a multiple of kRayPadding with valid (repeated) rays.
template <class Real>
struct RayBatch {
  int size = 0;  ///< multiple of kRayPadding
  Vec3 anchor;   ///< [m] world
  const Real* x = nullptr;
  const Real* y = nullptr;
  const Real* z = nullptr;
  const Real* dx = nullptr;  ///< unit length
  const Real* dy = nullptr;
  const Real* dz = nullptr;
  const Real* t_near = nullptr;  ///< [m] start of the segment (the camera); nullptr: -infinity
  const Real* t_far = nullptr;   ///< [m] end of the segment (a surface); nullptr: infinity
};

inline constexpr int kRayPadding = 16;
inline constexpr int kMaxBatch = 1024;  ///< no batch is larger

}  // namespace plenoflame
