#pragma once
#include <vector>

namespace plenoflame {

/// What is known of a tile when further samples are handed out.
struct TileNeed {
  double lit = 0;      ///< pixels that count for the error
  double samples = 0;  ///< per replicate, so far
  /// Expected mean square error of a lit pixel at one sample per replicate, were it to go as
  /// samples^(-2 kErrorSlope); 0: nothing to gain
  double difficulty = 0;
};

/// The error falls with samples^-kErrorSlope: what tiles of the paper's flame show, those at its
/// rim less, the others more (docs/benchmarks.md). A wrong value costs time, not accuracy.
inline constexpr double kErrorSlope = 0.8;

/// How many samples per replicate each tile shall have, so that the error over all lit pixels comes
/// down to a goal with the fewest rays in all: n_t ~ difficulty^(1 / (2 kErrorSlope + 1)), by
/// Lagrange's rule, and never fewer than it has. Growth is by powers of two where it is twofold or
/// more, by quarters below that; less than an eighth is left to other tiles. At least one tile
/// grows as long as one can.
/// @param goal mean square error over lit pixels; @param limit of samples per replicate
std::vector<int> plan_samples(const std::vector<TileNeed>& tiles, double goal, int limit);

}  // namespace plenoflame
