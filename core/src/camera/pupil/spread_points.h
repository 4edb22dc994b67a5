#pragma once
#include <cmath>
#include <cstddef>

namespace plenoflame {

/// Evenly spread points of the four-dimensional unit cube. This is the Kronecker sequence with the
/// powers of 1/g, g^5 = g + 1.
class SpreadPoints {
 public:
  /// @param first number of points that are skipped
  explicit SpreadPoints(std::size_t first = 0) {
    for (std::size_t d = 0; d < 4; ++d) {
      const double turns = 0.5 + static_cast<double>(first) * kStep[d];
      point_[d] = turns - std::floor(turns);
    }
  }
  void step() {
    for (std::size_t d = 0; d < 4; ++d) {
      point_[d] += kStep[d];
      point_[d] -= point_[d] >= 1 ? 1.0 : 0.0;
    }
  }
  double operator[](std::size_t d) const { return point_[d]; }

 private:
  static constexpr double kStep[4] = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                                      0.5385972572236101};
  double point_[4];
};

}  // namespace plenoflame
