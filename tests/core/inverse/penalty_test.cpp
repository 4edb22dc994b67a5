#include "plenoflame/inverse/penalty.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/inverse/dense.h"
#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::penalty_test {
namespace {

using namespace test;

/// Samples of a polynomial of x, y, z on the grid.
template <class Field>
std::vector<double> sampled(const PenaltyGrid& grid, const Field& field) {
  std::vector<double> values;
  for (int i = 0; i < grid.shape[0]; ++i)
    for (int j = 0; j < grid.shape[1]; ++j)
      for (int k = 0; k < grid.shape[2]; ++k)
        values.push_back(field(i * grid.spacing[0], j * grid.spacing[1], k * grid.spacing[2]));
  return values;
}

double squared(const LinearOperator& penalty, const std::vector<double>& x) {
  return dense(penalty * x).squaredNorm();
}

TEST(Penalty, MeasuresCurvature) {
  const PenaltyGrid grid{{6, 1, 4}, {1, 1, 2}, {3, 1, 1}};
  const auto x = sampled(grid, [](double a, double, double c) { return a * a + 0.25 * c * c; });
  // Curvature 2 along the first axis with strength 3, 0.5 along the last, in units of the smallest
  // spacing.
  const double expected = 36 * (4 * 4) + 0.25 * (6 * 2);
  EXPECT_TRUE(relative(squared(*make_penalty(grid), x), expected, 1e-13));
}

// Across two axes: a product of coordinates has no curvature along either. Each square of four
// samples counts twice its twist.
TEST(Penalty, MeasuresTwist) {
  const PenaltyGrid grid{{4, 5, 1}, {1, 2, 1}};
  const auto x = sampled(grid, [](double a, double b, double) { return 3 * a * b; });
  const double expected = 2 * 9 * (3 * 4);  // in units of the smallest spacing
  EXPECT_TRUE(relative(squared(*make_penalty(grid), x), expected, 1e-13));
}

// By hand: beyond 5 samples is nothing, and one that takes no part is empty.
TEST(Penalty, WhatIsEmptyOutsideCounts) {
  PenaltyGrid grid{{5, 1, 1}};
  grid.empty_outside = true;
  const std::vector<double> x{1, 2, 4, 5, 7};
  const auto measured = [&] { return squared(*make_penalty(grid), x); };
  EXPECT_TRUE(relative(measured(), 0.0 * 0 + 1 * 1 + 1 * 1 + 1 * 1 + 9 * 9, 1e-13));
  grid.mask = {1, 1, 0, 1, 1};
  EXPECT_TRUE(relative(measured(), 0.0 * 0 + 3 * 3 + 3 * 3 + 9 * 9, 1e-13));
  // One sample alone in a plane: twice its value along each axis, and once in each of four squares.
  PenaltyGrid plane{{3, 3, 1}};
  plane.empty_outside = true;
  plane.mask = {0, 0, 0, 0, 1, 0, 0, 0, 0};
  EXPECT_TRUE(relative(squared(*make_penalty(plane), {0, 0, 0, 0, 3, 0, 0, 0, 0}),
                       2 * 36 + 2 * 4 * 9, 1e-13));
}

// A round field is even about its axis: 4 - r^2 has the same curvature there as elsewhere.
TEST(Penalty, FieldsAreEvenAboutACentre) {
  PenaltyGrid grid{{4, 1, 1}};
  const std::vector<double> x{4, 3, 0, -5};
  EXPECT_EQ(squared(*make_penalty(grid), x), 2 * 4.0);
  grid.begins_at_centre = true;
  EXPECT_EQ(squared(*make_penalty(grid), x), 3 * 4.0);
}

TEST(Penalty, MaskedUnknownsHaveNoPart) {
  PenaltyGrid grid{{7, 1, 1}};
  grid.mask = {1, 1, 0, 1, 1, 1, 1};
  EXPECT_EQ(squared(*make_penalty(grid), {1, 2, 1000, 5, 7, 8, 11}), 1.0 + 4.0);
}

TEST(Penalty, TransposesAreExact) {
  const PenaltyGrid grid{{3, 4, 5}, {1, 2, 0.5}, {1, 0.25, 4}};
  const auto penalty = make_penalty(grid);
  const auto y = random_vector(penalty->rows(), -1, 1, 3);
  EXPECT_LT(distance(transposed_times(*penalty, y), dense(*penalty).transpose() * dense(y)), 1e-15);
  EXPECT_TRUE(relative(penalty->squared_norm({}), dense(*penalty).squaredNorm(), 1e-14));
}

// A parabola whose curvature is 1, in units of a tenth of the grid's longest side, has the
// reference's penalty on every grid, up to the differences that lack at the ends of the first axis.
TEST(Penalty, ReferenceIsThatOfAParabolaOnAnyGrid) {
  for (const PenaltyGrid& grid :
       {PenaltyGrid{{200, 1, 1}, {0.5, 1, 1}}, PenaltyGrid{{300, 4, 1}, {2e-3, 1e-3, 1}},
        PenaltyGrid{{150, 3, 5}, {1, 4, 2}}}) {
    const double tenth = 0.1 * grid.shape[0] * grid.spacing[0];
    const auto x = sampled(grid, [=](double a, double, double) { return 0.5 * a * a; });
    EXPECT_TRUE(relative(squared(*make_penalty(grid), x) / std::pow(tenth, 4),
                         reference_penalty(grid), 2.5 / grid.shape[0]));
  }
}

// Fails where weights are left out, or what does not take part is counted.
TEST(Penalty, UnitIsTheMisfitOfAUniformFlame) {
  const TwinMatrix a = random_matrix(20, 12, 0.5, 4);
  const auto w = random_vector(20, 1, 3, 5);
  const auto u = random_vector(12, 0, 1, 6);
  const Eigen::MatrixXd wa = dense(w).asDiagonal() * a.dense;
  EXPECT_TRUE(relative(penalty_unit(*make_csr_operator(a.sparse), w, u, 7),
                       (wa * dense(u)).squaredNorm() / 7, 1e-13));
  PenaltyGrid grid{{3, 4, 1}};
  const double all = reference_penalty(grid);
  grid.mask.assign(12, 1);
  grid.mask[3] = grid.mask[7] = grid.mask[8] = 0;
  EXPECT_TRUE(relative(reference_penalty(grid), all * 9 / 12, 1e-14));
}

TEST(Penalty, RefusesGridsThatAreNone) {
  EXPECT_THROW(make_penalty({{0, 1, 1}}), InputError);
  EXPECT_THROW(make_penalty({{2, 1, 1}, {0, 1, 1}}), InputError);
  EXPECT_THROW(make_penalty({{2, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1}}), InputError);
  EXPECT_THROW(reference_penalty({}), InputError);
  EXPECT_THROW(reference_penalty({{2, 1, 1}, {1, 1, 1}, {1, 1, 1}, {0, 0}}), InputError);
}

}  // namespace
}  // namespace plenoflame::penalty_test
