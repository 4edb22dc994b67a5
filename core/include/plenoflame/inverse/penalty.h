#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "plenoflame/inverse/linear_operator.h"

namespace plenoflame {

/// The property that the penalty keeps small.
enum class PenaltyKind {
  identity = 0,        ///< the values themselves; the numbers are orders of differences
  first_differences,   ///< slopes: neighbouring values alike
  second_differences,  ///< curvature in all directions, also across the axes: slopes alike
};

/// A field on a regular lattice of up to three axes, last axis fastest.
struct PenaltyGrid {
  std::array<int, 3> shape{1, 1, 1};
  std::array<double, 3> spacing{1, 1, 1};  ///< [m]; ratios count, not the unit
  /// Relative strength along each axis: depth, for instance, may be smoothed more.
  std::array<double, 3> strength{1, 1, 1};
  /// Unknowns that take part; empty: all. First differences to others are left out.
  std::vector<char> mask = {};
  /// The field is 0 beyond the grid and at unknowns that take no part, and second differences to
  /// these places count. Otherwise they are left out.
  bool empty_outside = false;
  /// The first axis begins at a centre, on both sides of which the field is the same.
  bool begins_at_centre = false;
};

/// The penalty |L x|^2 as the operator L. Differences are divided by spacing^order, with the
/// smallest spacing as the unit, so that all axes measure the same slope.
/// @throws InputError for an axis without samples, a spacing or strength that is not above 0, a
///         mask of another size
std::unique_ptr<LinearOperator> make_penalty(PenaltyKind kind, const PenaltyGrid& grid);

/// The gradient for total variation. The axes of a place form one group of three rows (3 i, 3 i +
/// 1, 3 i + 2). Rows that lead out of the grid are 0.
std::unique_ptr<LinearOperator> make_gradient(const PenaltyGrid& grid);

/// |L x|^2 of a reference field, which makes penalties comparable for any step of the grid. Let d
/// be a tenth of the grid's longest side. Order 1: the field changes by 1 over d. Order 2: its
/// slope changes by 1 / d over d. Order 0: its values are 1.
/// @param order of the differences @param power 1: the sum of |L x| of total variation
double reference_penalty(const PenaltyGrid& grid, int order, int power = 2);

/// Factor on |L x|^2 for a relative strength of 1: |W A u|^2 / reference. The penalty of the
/// reference field is then as large as the misfit without the uniform flame u. The factor cancels
/// units, brightness, number of rows and the grid's step.
/// @param weights W, of A's rows; empty: all 1 @param uniform u: 1 for all unknowns that take part
/// @param reference reference_penalty()
double penalty_unit(const LinearOperator& a, std::span<const double> weights,
                    std::span<const double> uniform, double reference);

}  // namespace plenoflame
