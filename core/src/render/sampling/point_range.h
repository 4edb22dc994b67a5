#pragma once
#include <cstdint>

namespace plenoflame {

/// A part of each replicate's sequence of points.
struct PointRange {
  std::uint32_t first = 0;
  int points = 0;
  /// One of several that go on with one another, rather than all there will be.
  bool part = false;
};

}  // namespace plenoflame
