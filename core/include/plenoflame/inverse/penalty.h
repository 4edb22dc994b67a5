#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "plenoflame/inverse/linear_operator.h"

namespace plenoflame {

/// A field on a regular lattice of up to three axes, last axis fastest.
struct PenaltyGrid {
  std::array<int, 3> shape{1, 1, 1};
  std::array<double, 3> spacing{1, 1, 1};  ///< [m]; ratios count, not the unit
  /// Relative strength along each axis: depth, for instance, may be smoothed more.
  std::array<double, 3> strength{1, 1, 1};
  /// Unknowns that take part; empty: all.
  std::vector<char> mask = {};
  /// The field is 0 beyond the grid and where no unknown takes part, and differences to there
  /// count. Otherwise they are left out.
  bool empty_outside = false;
  /// The first axis begins at a centre, on both sides of which the field is the same.
  bool begins_at_centre = false;
};

/// The penalty |L x|^2 as the operator L: second differences, which are the curvature in all
/// directions, also across the axes. They are divided by spacing^2, with the smallest spacing as
/// the unit, so that all axes measure the same curvature.
/// @throws InputError for an axis without samples, a spacing or strength that is not above 0, a
///         mask of another size
std::unique_ptr<LinearOperator> make_penalty(const PenaltyGrid& grid);

/// |L x|^2 of a reference field, which makes penalties comparable for any step of the grid. Let d
/// be a tenth of the grid's longest side: the field's slope changes by 1 / d over d.
double reference_penalty(const PenaltyGrid& grid);

/// Factor on |L x|^2 for a relative strength of 1: |W A u|^2 / reference. The penalty of the
/// reference field is then as large as the misfit without the uniform flame u. The factor cancels
/// units, brightness, number of rows and the grid's step.
/// @param weights W, of A's rows; empty: all 1 @param uniform u: 1 for all unknowns that take part
/// @param reference reference_penalty()
double penalty_unit(const LinearOperator& a, std::span<const double> weights,
                    std::span<const double> uniform, double reference);

}  // namespace plenoflame
