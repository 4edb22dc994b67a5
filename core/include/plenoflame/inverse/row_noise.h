#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/measurement.h"

/// The expected deviation of a row of the linear problem from its model. It contains the noise of
/// the pictures and the error of the row itself, which has a finite number of rays. It also
/// contains the detail between the places of the unknowns.
namespace plenoflame {

/// Standard error of rows for the finite number of their rays, as a function of their flux. Dim
/// rows see only part of their microlenses and of the flame, so their relative errors are larger.
struct RayError {
  double overall = 0;         ///< RMS of the errors over RMS of the rows
  std::vector<double> flux;   ///< [W] ascending: RMS of groups of rows
  std::vector<double> error;  ///< [W] RMS in each group
  double largest = 0;         ///< [W] of all rows

  /// [W] At a flux: linear between the groups, constant below the dimmest one. Above, the last line
  /// is continued; it never falls, and rises at most in proportion to the flux. 0 if nothing is
  /// known.
  double at(double row_flux) const;
  /// For the same rays and rows that are brighter by a factor.
  RayError scaled(double factor) const;
};

/// Measured by the difference of the first two replicates of rows of A x, of some thousands of them
/// spread evenly. Nothing is known for rays of one replicate.
/// @throws Cancelled
RayError ray_error(const EmissionProblem& problem, std::span<const double> x,
                   const Execution& execution);

/// [W] Error of each row by detail between the places of the unknowns: a hundredth of the light
/// between arcs and their chords (errors_of_chords()). Experiments chose this share.
/// @param a of the problem @param x an estimate @param solved 0 for unknowns that stay 0
/// @return nothing if a stop ends the product
std::vector<double> grid_errors(const LinearOperator& a, const EmissionProblem& problem,
                                std::span<const double> x, const std::vector<char>& solved);

/// 1 / standard deviation of each row; 0 for rows that are left out. Shot noise is computed from
/// the light that a model explains. Weights by the counted light would prefer rows that counted too
/// little by chance, and lower every fit by about an electron per row.
/// @param explained [W] A x for an estimate of x; empty: shot noise by the counts, no error of rays
/// @param grid [W] errors by the grid; empty: none
std::vector<double> row_weights(const MeasuredRows& measured, std::span<const double> explained,
                                const RayError& rays, std::span<const double> grid = {});

/// |W (fluxes - b)|^2 of all rows.
double misfit_of(std::span<const double> fluxes, std::span<const double> b,
                 std::span<const double> weights);

}  // namespace plenoflame
