#pragma once
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace plenoflame {

inline constexpr std::size_t kRun = 256;  ///< pixels that are looked at together

/// Whether any of some pixels is not 0.
inline bool any_lit(const float* pixels, std::size_t count) {
  std::uint32_t bits = 0;  // all but the sign
  for (std::size_t i = 0; i < count; ++i) bits |= std::bit_cast<std::uint32_t>(pixels[i]) << 1;
  return bits != 0;
}

/// Calls `take` with the first pixel of every run that is not all 0, and the one behind its last:
/// most of a picture may be dark, and what is dark shall cost next to nothing.
template <class Take>
void for_lit_runs(const std::vector<float>& pixels, const Take& take) {
  for (std::size_t first = 0; first < pixels.size(); first += kRun) {
    const std::size_t end = std::min(first + kRun, pixels.size());
    if (any_lit(pixels.data() + first, end - first)) take(first, end);
  }
}

/// The largest of some pixels, none of which is negative; 0 without any.
inline float largest_of(const std::vector<float>& pixels) {
  float largest = 0;
  for_lit_runs(pixels, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) largest = std::max(largest, pixels[i]);
  });
  return largest;
}

/// In double precision, in the order of the pixels.
inline double sum_of(const std::vector<float>& pixels) {
  double sum = 0;
  for_lit_runs(pixels, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) sum += static_cast<double>(pixels[i]);
  });
  return sum;
}

}  // namespace plenoflame
