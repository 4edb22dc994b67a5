// A part of a ray as kernels read and write it: plain, no inline functions, so that kernels
// compiled for different processors may share it.
#pragma once
#include <cstdint>

namespace plenoflame {

/// A part of a ray within one cell, with the two nodes of the Gauss rule, the nearer one first. A
/// field at node n is the sum of weight[n][c] * (sample number sample[c]) over all c. From `count`
/// on weights are 0 and samples are any of the field.
struct RayInterval {
  static constexpr int kCorners = 8;
  alignas(64) double weight[2][kCorners];
  std::uint32_t sample[kCorners];
  double length;  ///< [m]
  int count;
};

/// Places of the two nodes, in lengths of the interval: 1/2 -+ 1/(2 sqrt 3).
inline constexpr double kGaussNodes[2] = {0.21132486540518711775, 0.78867513459481288225};

}  // namespace plenoflame
