#pragma once
#include <vector>

namespace plenoflame {

/// The need of a tile when further samples are handed out.
struct TileNeed {
  double lit = 0;      ///< pixels that count for the error
  double samples = 0;  ///< per replicate, so far
  /// Expected mean square error of a lit pixel at one sample per replicate, were it to go as
  /// samples^(-2 kErrorSlope); 0: nothing to gain
  double difficulty = 0;
};

/// The error falls with samples^-kErrorSlope: what tiles of the paper's flame show, those at its
/// rim less, the others more (docs/benchmarks.md). A wrong value costs time, not accuracy.
inline constexpr double kErrorSlope = 0.86;

/// The number of samples per replicate for each tile, so that the error over all lit pixels comes
/// down to a goal with the fewest rays in all, and never fewer than it has. Samples are doubled, as
/// nets of points have small errors only when they are whole (a quarter more points than 2^k gave 2
/// % less error, not 16): that of the tile first which gains most for each sample, which is
/// Lagrange's rule, n_t ~ difficulty^(1 / (2 kErrorSlope + 1)), in steps of two. At least one tile
/// grows as long as one can.
/// @param goal mean square error over lit pixels; @param limit of samples per replicate
std::vector<int> plan_samples(const std::vector<TileNeed>& tiles, double goal, int limit);

}  // namespace plenoflame
