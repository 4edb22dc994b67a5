#include "plenoflame/math/ray_span.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/approx.h"

namespace plenoflame::test::ray_span_test {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const Box kBox{{1, -2, -3}, {4, 5, 6}};

TEST(RaySpan, IsWhereTheRayIsInTheBox) {
  const RaySpan across = clip_to_box(kBox, {{-1, 0, 0}, {2, 0, 0}}, -kInf, kInf);
  EXPECT_TRUE(relative(across.near, 1, 1e-14));
  EXPECT_TRUE(relative(across.far, 2.5, 1e-14));
  // Towards the origin of its parameter, through two corners: (1, -2, -3) and (4, 5, 6).
  const RaySpan diagonal = clip_to_box(kBox, {{7, 12, 15}, {-3, -7, -9}}, -kInf, kInf);
  EXPECT_TRUE(relative(diagonal.near, 1, 1e-14));
  EXPECT_TRUE(relative(diagonal.far, 2, 1e-14));
}

TEST(RaySpan, KeepsTheGivenEnds) {
  const Ray ray{{-1, 0, 0}, {1, 0, 0}};
  const RaySpan part = clip_to_box(kBox, ray, 2.5, 3.5);
  EXPECT_EQ(part.near, 2.5);
  EXPECT_EQ(part.far, 3.5);
  EXPECT_TRUE(clip_to_box(kBox, ray, 5.5, kInf).empty());
  EXPECT_TRUE(clip_to_box(kBox, ray, 0, 1.5).empty());
  EXPECT_TRUE(clip_to_box(kBox, ray, 3, 3).empty());
  EXPECT_TRUE(clip_to_box(kBox, ray, 4, 3).empty());
}

TEST(RaySpan, RaysAlongAFaceAreInside) {
  for (const double y : {-2.0, 5.0}) {
    EXPECT_FALSE(clip_to_box(kBox, {{0, y, 0}, {1, 0, 0}}, 0, kInf).empty());
    EXPECT_TRUE(clip_to_box(kBox, {{0, 1.001 * y, 0}, {1, 0, 0}}, 0, kInf).empty());
  }
  EXPECT_FALSE(clip_to_box(kBox, {{0, 5, 6}, {1, 0, 0}}, 0, kInf).empty());  // an edge
  EXPECT_TRUE(clip_to_box(kBox, {{0, 9, 0}, {1, 0, 0}}, 0, kInf).empty());
}

TEST(RaySpan, NothingOfABoxFarAwayIsCutOff) {
  // Rounding may widen the box, by a few ulp of the distance, but must not make it narrower.
  const Box far{{1e6 + 1, -1, -1}, {1e6 + 2, 1, 1}};
  for (const double slope : {0.0, 1e-7, -3e-7}) {
    const RaySpan span = clip_to_box(far, {{0, 0, 0}, {1, slope, -slope}}, 0, kInf);
    EXPECT_LE(span.near, 1e6 + 1);
    EXPECT_GE(span.far, 1e6 + 2);
    EXPECT_LT(span.far - span.near, 1 + 1e-8);
  }
}

TEST(RaySpan, IsEmptyWithoutABoxOrARay) {
  EXPECT_TRUE(clip_to_box({}, {{0, 0, 0}, {1, 0, 0}}, 0, kInf).empty());
  EXPECT_TRUE(clip_to_box(kBox, {{kNan, 0, 0}, {1, 0, 0}}, 0, kInf).empty());
  EXPECT_TRUE(clip_to_box(kBox, {{kInf, 0, 0}, {-1, 0, 0}}, 0, kInf).empty());
  EXPECT_TRUE(clip_to_box(kBox, {{2, 0, 0}, {0, 0, 0}}, 0, kInf).empty());
  EXPECT_TRUE(clip_to_box(kBox, {{2, 0, 0}, {kNan, kNan, kNan}}, 0, 1).empty());
}

}  // namespace
}  // namespace plenoflame::test::ray_span_test
