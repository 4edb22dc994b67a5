#pragma once
#include <cstdint>

namespace plenoflame {

/// A part of each replicate's sequence of points.
struct PointRange {
  std::uint32_t first = 0;
  int points = 0;
  /// True: further ranges may continue the sequence. False: these are all points.
  bool part = false;
};

}  // namespace plenoflame
