#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>

namespace plenoflame {

inline constexpr std::size_t kRun = 256;  ///< pixels that are tested together

/// Tells whether any of some pixels is not 0.
inline bool any_lit(const float* pixels, std::size_t count) {
  std::uint32_t bits = 0;  // all but the sign
  for (std::size_t i = 0; i < count; ++i) bits |= std::bit_cast<std::uint32_t>(pixels[i]) << 1;
  return bits != 0;
}

}  // namespace plenoflame
