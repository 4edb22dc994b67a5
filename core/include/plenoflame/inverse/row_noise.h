#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/measurement.h"

/// The amount by which a row of the linear problem may differ from its model: noise of the
/// pictures, and the error of the row itself, whose rays are finite in number.
namespace plenoflame {

/// Standard error of rows for the finite number of their rays, by how bright they are: dim rows,
/// whose microlenses and flame are seen in part, err more for their light than bright ones.
struct RayError {
  double overall = 0;         ///< RMS of the errors over RMS of the rows
  std::vector<double> flux;   ///< [W] ascending: RMS of groups of rows
  std::vector<double> error;  ///< [W] RMS in each group
  double largest = 0;         ///< [W] of all rows

  /// [W] At a flux: linear between the groups, as that of the dimmest one below. Above, the last
  /// line goes on, but never falls nor rises more than in proportion to the flux. 0 where nothing
  /// is known.
  double at(double row_flux) const;
  /// For rows of the same rays that are so many times as bright.
  RayError scaled(double factor) const;
};

/// Measured by the difference of the first two replicates of rows of A x, of some thousands of them
/// spread evenly. Nothing is known for rays of one replicate.
/// @throws Cancelled
RayError ray_error(const EmissionProblem& problem, std::span<const double> x,
                   const Execution& execution);

/// 1 / standard deviation of each row, 0 for those that are left out. Shot noise is that of the
/// light which a model explains, not of what was counted: weights by counts prefer the rows that
/// happened to count little, and pull every fit down by about an electron per row.
/// @param explained [W] A x for an estimate of x; empty: shot noise by the counts, no error of rays
std::vector<double> row_weights(const MeasuredRows& measured, std::span<const double> explained,
                                const RayError& rays);

}  // namespace plenoflame
