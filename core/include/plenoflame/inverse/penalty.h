#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "plenoflame/inverse/linear_operator.h"

namespace plenoflame {

/// The property that a solution is asked to have little of, beside the misfit.
enum class PenaltyKind {
  identity,            ///< the values themselves
  first_differences,   ///< slopes: neighbouring values alike
  second_differences,  ///< curvature: slopes alike
};

/// A field on a regular lattice of up to three axes, last axis fastest.
struct PenaltyGrid {
  std::array<int, 3> shape{1, 1, 1};
  std::array<double, 3> spacing{1, 1, 1};  ///< [m]; ratios count, not the unit
  /// Relative strength along each axis: depth, for instance, may be smoothed more.
  std::array<double, 3> strength{1, 1, 1};
  /// Unknowns that take part; empty: all. Differences to one that does not are left out.
  std::vector<char> mask = {};
};

/// The penalty |L x|^2 as the operator L. Differences are divided by spacing^order, with the
/// smallest spacing as the unit, so that all axes measure the same slope.
/// @throws InputError for an axis without samples, a spacing or strength that is not above 0, a
///         mask of another size
std::unique_ptr<LinearOperator> make_penalty(PenaltyKind kind, const PenaltyGrid& grid);

/// The gradient with all axes of a place in one group of three rows (3 i, 3 i + 1, 3 i + 2), for
/// total variation; rows that lead out of the grid are 0.
std::unique_ptr<LinearOperator> make_gradient(const PenaltyGrid& grid);

/// Factor by which |L x|^2 is multiplied for a relative strength of 1: trace(A^T W^2 A) /
/// trace(L^T L): a number that does not depend on units, brightness and the number of rows. Of
/// differences it does depend on the grid.
/// @param weights W, of A's rows; empty: all 1
double penalty_unit(const LinearOperator& a, std::span<const double> weights,
                    const LinearOperator& penalty);

}  // namespace plenoflame
