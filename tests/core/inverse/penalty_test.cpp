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

// Slopes in units of 1 per smallest spacing: (2^2 + 3^2 + 5^2) over the edges of each axis.
TEST(Penalty, FirstDifferencesMeasureTheSlopeOfALinearFieldOnAnyAxis) {
  const PenaltyGrid grid{{4, 3, 5}, {0.5, 1, 2}};
  const auto x = sampled(grid, [](double a, double b, double c) { return 2 * a + 3 * b + 5 * c; });
  const auto penalty = make_penalty(PenaltyKind::first_differences, grid);
  const double expected = 0.25 * (4 * (3 * 3 * 5) + 9 * (4 * 2 * 5) + 25 * (4 * 3 * 4));
  EXPECT_TRUE(relative(squared(*penalty, x), expected, 1e-13));
  EXPECT_LT(squared(*make_penalty(PenaltyKind::second_differences, grid), x), 1e-26 * expected);
}

TEST(Penalty, SecondDifferencesMeasureCurvature) {
  const PenaltyGrid grid{{6, 1, 4}, {1, 1, 2}, {3, 1, 1}};
  const auto x = sampled(grid, [](double a, double, double c) { return a * a + 0.25 * c * c; });
  // Curvature 2 along the first axis with strength 3, 0.5 along the last, in units of the smallest
  // spacing.
  const double expected = 36 * (4 * 4) + 0.25 * (6 * 2);
  EXPECT_TRUE(
      relative(squared(*make_penalty(PenaltyKind::second_differences, grid), x), expected, 1e-13));
}

// Across two axes: a product of coordinates has no curvature along either. Each square of four
// samples counts twice its twist.
TEST(Penalty, SecondDifferencesMeasureTwist) {
  const PenaltyGrid grid{{4, 5, 1}, {1, 2, 1}};
  const auto x = sampled(grid, [](double a, double b, double) { return 3 * a * b; });
  const double expected = 2 * 9 * (3 * 4);  // in units of the smallest spacing
  EXPECT_TRUE(
      relative(squared(*make_penalty(PenaltyKind::second_differences, grid), x), expected, 1e-13));
}

// By hand: beyond 5 samples is nothing, and one that takes no part is empty.
TEST(Penalty, WhatIsEmptyOutsideCounts) {
  PenaltyGrid grid{{5, 1, 1}};
  grid.empty_outside = true;
  const std::vector<double> x{1, 2, 4, 5, 7};
  const auto measured = [&] {
    return squared(*make_penalty(PenaltyKind::second_differences, grid), x);
  };
  EXPECT_TRUE(relative(measured(), 0.0 * 0 + 1 * 1 + 1 * 1 + 1 * 1 + 9 * 9, 1e-13));
  grid.mask = {1, 1, 0, 1, 1};
  EXPECT_TRUE(relative(measured(), 0.0 * 0 + 3 * 3 + 3 * 3 + 9 * 9, 1e-13));
  // One sample alone in a plane: twice its value along each axis, and once in each of four squares.
  PenaltyGrid plane{{3, 3, 1}};
  plane.empty_outside = true;
  plane.mask = {0, 0, 0, 0, 1, 0, 0, 0, 0};
  EXPECT_TRUE(relative(
      squared(*make_penalty(PenaltyKind::second_differences, plane), {0, 0, 0, 0, 3, 0, 0, 0, 0}),
      2 * 36 + 2 * 4 * 9, 1e-13));
}

// A round field is even about its axis: 4 - r^2 has the same curvature there as elsewhere.
TEST(Penalty, FieldsAreEvenAboutACentre) {
  PenaltyGrid grid{{4, 1, 1}};
  const std::vector<double> x{4, 3, 0, -5};
  EXPECT_EQ(squared(*make_penalty(PenaltyKind::second_differences, grid), x), 2 * 4.0);
  grid.begins_at_centre = true;
  EXPECT_EQ(squared(*make_penalty(PenaltyKind::second_differences, grid), x), 3 * 4.0);
}

TEST(Penalty, MaskedUnknownsHaveNoPart) {
  PenaltyGrid grid{{5, 1, 1}};
  grid.mask = {1, 1, 0, 1, 1};
  const std::vector<double> x{1, 2, 1000, 5, 7};
  EXPECT_EQ(squared(*make_penalty(PenaltyKind::first_differences, grid), x), 1.0 + 4.0);
  EXPECT_EQ(squared(*make_penalty(PenaltyKind::identity, grid), x), 1.0 + 4 + 25 + 49);
  EXPECT_EQ(make_penalty(PenaltyKind::second_differences, grid)->rows(), 0u);
  EXPECT_EQ(squared(*make_gradient(grid), x), 1.0 + 4.0);
}

TEST(Penalty, TransposesAreExact) {
  const PenaltyGrid grid{{3, 4, 5}, {1, 2, 0.5}, {1, 0.25, 4}};
  for (const PenaltyKind kind :
       {PenaltyKind::identity, PenaltyKind::first_differences, PenaltyKind::second_differences}) {
    const auto penalty = make_penalty(kind, grid);
    const auto y = random_vector(penalty->rows(), -1, 1, 3);
    EXPECT_LT(distance(transposed_times(*penalty, y), dense(*penalty).transpose() * dense(y)),
              1e-15);
    EXPECT_TRUE(relative(penalty->squared_norm({}), dense(*penalty).squaredNorm(), 1e-14));
  }
}

/// A field of a place in units of a tenth of the grid's longest side, at the samples' places.
std::vector<double> along_first(const PenaltyGrid& grid, double (*field)(double)) {
  double longest = 0;
  for (std::size_t a = 0; a < 3; ++a)
    if (grid.shape[a] > 1) longest = std::max(longest, grid.shape[a] * grid.spacing[a]);
  std::vector<double> x;
  for (int i = 0; i < grid.shape[0]; ++i)
    for (int j = 0; j < grid.shape[1]; ++j)
      for (int k = 0; k < grid.shape[2]; ++k)
        x.push_back(field(i * grid.spacing[0] / (0.1 * longest)));
  return x;
}

// Fields whose slope, curvature or value is 1 everywhere have the reference's penalty on every
// grid, up to the differences that lack at the two ends of the first axis.
TEST(Penalty, ReferenceIsThatOfTheFieldOnAnyGrid) {
  const auto line = [](double t) { return t; };
  const auto parabola = [](double t) { return 0.5 * t * t; };
  const auto one = [](double) { return 1.0; };
  for (const PenaltyGrid& grid :
       {PenaltyGrid{{200, 1, 1}, {0.5, 1, 1}}, PenaltyGrid{{300, 4, 1}, {2e-3, 1e-3, 1}},
        PenaltyGrid{{150, 3, 5}, {1, 4, 2}}}) {
    const double ends = 2.5 / grid.shape[0];
    const auto square = [&](PenaltyKind kind, double (*field)(double)) {
      const auto l = make_penalty(kind, grid);
      return (dense(*l) * dense(along_first(grid, field))).squaredNorm();
    };
    EXPECT_TRUE(relative(square(PenaltyKind::identity, one), reference_penalty(grid, 0), 1e-12));
    EXPECT_TRUE(
        relative(square(PenaltyKind::first_differences, line), reference_penalty(grid, 1), ends));
    EXPECT_TRUE(relative(square(PenaltyKind::second_differences, parabola),
                         reference_penalty(grid, 2), ends));
    const auto gradient = make_gradient(grid);
    double variation = 0;
    for (const double value : plain(dense(*gradient) * dense(along_first(grid, line))))
      variation += std::abs(value);  // along the first axis alone
    EXPECT_TRUE(relative(variation, reference_penalty(grid, 1, 1), ends));
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
  const double all = reference_penalty(grid, 1);
  grid.mask.assign(12, 1);
  grid.mask[3] = grid.mask[7] = grid.mask[8] = 0;
  EXPECT_TRUE(relative(reference_penalty(grid, 1), all * 9 / 12, 1e-14));
}

TEST(Penalty, RefusesGridsThatAreNone) {
  EXPECT_THROW(make_penalty(PenaltyKind::identity, {{0, 1, 1}}), InputError);
  EXPECT_THROW(make_penalty(PenaltyKind::identity, {{2, 1, 1}, {0, 1, 1}}), InputError);
  EXPECT_THROW(make_penalty(PenaltyKind::identity, {{2, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1}}),
               InputError);
  EXPECT_THROW(reference_penalty({}, 1), InputError);
  EXPECT_THROW(reference_penalty({{2, 1, 1}, {1, 1, 1}, {1, 1, 1}, {0, 0}}, 0), InputError);
}

}  // namespace
}  // namespace plenoflame::penalty_test
