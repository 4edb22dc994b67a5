#include "inverse/dark_pixels.h"

#include <gtest/gtest.h>

#include "core/inverse/dense.h"
#include "support/approx.h"

namespace plenoflame::dark_pixels_test {
namespace {

using namespace test;

struct Pictures {
  CameraRays rays;
  MeasuredRows measured;
  void add(int view, double flux, double deviation) {
    rays.rows.emplace_back().view = view;
    measured.flux.push_back(flux);
    measured.deviation.push_back(deviation);
  }
};

// A place that dark pixels see alone hides the light that is as bright as a deviation there, or in
// the picture that tells most.
TEST(DarkPixels, HideTheLightOfTheirDeviation) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(5, 3);
  a(0, 0) = 0.5;
  a(1, 1) = 0.25;
  a(2, 1) = 0.5;
  a(3, 2) = a(4, 1) = 1;
  Pictures of;
  of.add(0, 100, 1);
  of.add(0, 0.4, 0.5);
  of.add(0, -0.3, 2);
  of.add(1, 80, 1);
  of.add(1, 0.1, 0.75);
  const TwinMatrix matrix = twin_of(a);
  const auto product = make_csr_operator(matrix.sparse, {});
  const RuledOut one = behind_dark(*product, of.rays, of.measured, 1, {}),
                 both = behind_dark(*product, of.rays, of.measured, 2, {});
  EXPECT_EQ(one.empty, (std::vector<char>{0, 1, 0}));
  EXPECT_EQ(both.empty, one.empty);
  const double in_first = (0.25 * 0.5 + 0.5 * 2) / (0.25 * 0.25 + 0.5 * 0.5);
  EXPECT_TRUE(relative(one.hidden[1], in_first, 1e-14));
  EXPECT_TRUE(relative(both.hidden[1], 0.75, 1e-14));
  EXPECT_EQ(both.hidden[0], 0);
}

// The light of all places on the rays is independent: squares add up to that of the deviation.
TEST(DarkPixels, HideTheLightOfManyPlaces) {
  const TwinMatrix a = random_matrix(401, 60, 0.3, 11);
  Eigen::MatrixXd with_bright = a.dense;
  with_bright.row(400).setConstant(1e-3);
  Pictures of;
  for (int row = 0; row < 400; ++row) of.add(0, 0, 0.1);
  of.add(0, 50, 0.1);
  const TwinMatrix matrix = twin_of(with_bright);
  // A fifth of the places is known to be without light.
  std::vector<char> support(60, 1);
  std::fill_n(support.begin(), 12, 0);
  const RuledOut ruled =
      behind_dark(*make_csr_operator(matrix.sparse, {}), of.rays, of.measured, 1, support);
  const Eigen::VectorXd lengths = a.dense.block(0, 12, 400, 48).rowwise().norm();
  for (Eigen::Index j = 12; j < 60; ++j) {
    const Eigen::VectorXd column = a.dense.col(j).head(400);
    const double expected = 0.1 * column.sum() / column.dot(lengths);
    EXPECT_TRUE(relative(ruled.hidden[static_cast<std::size_t>(j)], expected, 0.2)) << j;
  }
}

}  // namespace
}  // namespace plenoflame::dark_pixels_test
