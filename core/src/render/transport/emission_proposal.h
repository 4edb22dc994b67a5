#pragma once
#include <cstdint>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/media/medium.h"

namespace plenoflame {

/// Draws points of a medium nearly in proportion to its emission: a coarse grid over the medium's
/// bounds, uniform within each cell. Cells are weighted by the root mean square of the emission at
/// a few points; since those can miss something, every cell of the bounds keeps a share, so that an
/// estimate weighted by 1 / density is unbiased for any medium.
class EmissionProposal {
 public:
  static constexpr int kCellsAlong = 64;
  /// @param cells_along the longest side, at most
  /// @param seed of the points at which the emission is looked up
  /// @throws Cancelled when stopped before it is complete
  EmissionProposal(const Medium& medium, std::uint64_t seed, const Execution& execution,
                   int cells_along = kCellsAlong);

  /// Nothing emits: there is nothing to draw.
  bool dark() const { return cumulative_.empty(); }

  struct Point {
    Vec3 position;       ///< world
    double density = 0;  ///< [1/m^3] with which this place is drawn
  };
  /// @param choice, u, v, w uniform in (0, 1): for the cell, and the place in it
  Point draw(double choice, double u, double v, double w) const;

  /// [1/sr] with which draw() gives a point in this direction from the ray's origin: the integral
  /// of the density of points times distance^2 along the ray.
  double direction_density(const Ray& ray) const;

 private:
  std::size_t cell_count() const;
  std::vector<double> cell_emission(const Medium& medium, std::uint64_t seed,
                                    const Execution& execution) const;
  void set_weights(std::vector<double> weights);

  Box bounds_;
  int nx_ = 1, ny_ = 1, nz_ = 1;
  double cell_volume_ = 0;
  std::vector<double> cumulative_;    ///< share of all cells up to and including this one
  std::vector<std::uint32_t> guide_;  ///< first cell that may hold a choice in [k, k + 1) / size
};

}  // namespace plenoflame
