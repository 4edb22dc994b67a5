#include "sampling/directions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "support/approx.h"

namespace plenoflame::test::directions_test {
namespace {

constexpr double kUlp = std::numeric_limits<double>::epsilon();
constexpr double kTurn = 6.283185307179586;

/// Axes in all octants, along the frame's axes, and nearly along the one where bases turn over.
std::vector<Vec3> axes() {
  std::vector<Vec3> list{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
  for (const double x : {-0.3, 0.8})
    for (const double y : {-0.5, 0.1})
      for (const double z : {-0.7, 0.2, 1e-9, -1e-9}) list.push_back(normalize({x, y, z}));
  list.push_back(normalize({1e-8, -2e-8, -1}));
  return list;
}

TEST(Directions, ConesHaveTheirAngleAndTurnEvenly) {
  for (const Vec3 axis : axes())
    for (const double versine : {1e-12, 1e-4, 0.3, 1.0, 1.7, 2.0}) {
      Vec3 sum{};
      constexpr int kSteps = 12;
      const Vec3 first = cone_direction(axis, versine, 0);
      for (int i = 0; i < kSteps; ++i) {
        const Vec3 d = cone_direction(axis, versine, (i + 0.0) / kSteps);
        EXPECT_TRUE(relative(length(d), 1, 4 * kUlp));
        // 1 - cos = |d - axis|^2 / 2 has all its digits for narrow cones, too.
        const Vec3 apart = d - axis;
        EXPECT_LT(std::fabs(0.5 * dot(apart, apart) - versine), 8 * kUlp * std::sqrt(versine));
        // The chord to the first one: 2 sine sin(azimuth / 2).
        const double sine = std::sqrt(versine * (2 - versine));
        EXPECT_LT(std::fabs(length(d - first) - 2 * sine * std::sin(0.5 * kTurn * i / kSteps)),
                  16 * kUlp);
        sum = sum + d;
      }
      EXPECT_LT(length((1.0 / kSteps) * sum - (1 - versine) * axis), 16 * kUlp);
    }
}

TEST(Directions, CosinesAreDrawnInProportion) {
  for (const Vec3 normal : axes())
    for (const double u : {1e-9, 0.1, 0.5, 0.99, 1 - 1e-12}) {
      // P(cosine > c) = 1 - c^2.
      const Vec3 a = cosine_direction(normal, u, 0.15), b = cosine_direction(normal, u, 0.65);
      EXPECT_LT(std::fabs(dot(a, normal) - std::sqrt(1 - u)), 8 * kUlp);
      EXPECT_LT(length(a + b - 2 * std::sqrt(1 - u) * normal), 16 * kUlp);  // half a turn apart
      EXPECT_LT(std::fabs(length(a - b) - 2 * std::sqrt(u)), 16 * kUlp);
    }
}

}  // namespace
}  // namespace plenoflame::test::directions_test
