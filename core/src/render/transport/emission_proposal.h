#pragma once
#include <cstdint>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/media/medium.h"

namespace plenoflame {

/// Draws points of a medium nearly in proportion to its emission. A coarse grid covers the medium's
/// bounds, and points are uniform within each cell. The weight of a cell is the root mean square of
/// the emission at a few points. These points can miss emission, so every cell keeps a share. An
/// estimate weighted by 1 / density is therefore unbiased for any medium.
class EmissionProposal {
 public:
  static constexpr int kCellsAlong = 64;
  /// @param cells_along largest number of cells along the longest side
  /// @param seed of the points at which the emission is evaluated
  /// @throws Cancelled when stopped before it is complete
  EmissionProposal(const Medium& medium, std::uint64_t seed, const Execution& execution,
                   int cells_along = kCellsAlong);

  /// Nothing emits, so that no point can be drawn.
  bool dark() const { return cumulative_.empty(); }

  struct Point {
    Vec3 position;       ///< world
    double density = 0;  ///< [1/m^3] density with which this place is drawn
  };
  /// @param choice, u, v, w uniform in (0, 1): for the cell, and the position in it
  Point draw(double choice, double u, double v, double w) const;

  /// [1/sr] Density with which draw() gives a point in this direction from the ray's origin. It is
  /// the integral of the density of points times distance^2 along the ray.
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
  std::vector<std::uint32_t> guide_;  ///< first cell for a choice in [k, k + 1) / size
};

}  // namespace plenoflame
