#pragma once
#include <vector>

namespace plenoflame {

/// The data of a tile for the distribution of further samples.
struct TileNeed {
  double lit = 0;      ///< pixels that count for the error
  double samples = 0;  ///< per replicate, so far
  /// Error coefficient: expected mean square error of a lit pixel at one sample per replicate. The
  /// error is taken to decrease as samples^(-2 kErrorSlope). 0: further samples gain nothing.
  double difficulty = 0;
};

/// The error falls with samples^-kErrorSlope, measured on tiles of the paper's flame. Tiles at its
/// rim have a smaller exponent, others a larger one (docs/benchmarks.md). A wrong value costs time
/// and leaves the accuracy unchanged.
inline constexpr double kErrorSlope = 0.86;

/// Plans the number of samples per replicate of each tile. The error over all lit pixels falls to a
/// goal with the fewest rays, and no tile loses samples. Samples are doubled, because point nets
/// have small errors only when they are complete. A quarter more points than 2^k gave 2 % less
/// error, not 16. The tile with the largest gain per sample comes first. This is Lagrange's rule,
/// n_t ~ C_t^(1 / (2 kErrorSlope + 1)) with the error coefficient C_t, in steps of two. At least
/// one tile gets more samples as long as one can.
/// @param goal mean square error over lit pixels; @param limit of samples per replicate
std::vector<int> plan_samples(const std::vector<TileNeed>& tiles, double goal, int limit);

}  // namespace plenoflame
