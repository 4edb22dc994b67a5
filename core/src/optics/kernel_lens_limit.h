#pragma once

namespace plenoflame {

/// Surfaces of a main lens, the stop included: as many as the vector kernels have room for.
inline constexpr int kMaxLensSurfaces = 64;

}  // namespace plenoflame
