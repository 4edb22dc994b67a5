#include "plenoflame/camera/pupil_filters.h"

#include <cmath>

#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::test::pupil_filters_test {
namespace {

const double kPi = std::acos(-1.0);

PupilFilterSpec sector(double angle, double extent, double inner = 0, double outer = 1) {
  PupilFilterSpec filter;
  filter.angle = angle;
  filter.extent = extent;
  filter.inner = inner;
  filter.outer = outer;
  return filter;
}

PupilFilterSpec polygon(std::vector<Vec2> corners) {
  PupilFilterSpec filter;
  filter.shape = PupilPartShape::polygon;
  filter.corners = std::move(corners);
  return filter;
}

TEST(PupilFilters, AreasInClosedForm) {
  // A quarter of a ring, a half disc, a triangle, the rest.
  const PupilFilters filters({sector(0.1, kPi / 2, 0.5, 0.8), sector(kPi + 0.2, kPi / 2),
                              polygon({{-0.7, 0.1}, {-0.1, 0.1}, {-0.1, 0.6}})});
  const std::vector<double> areas = filters.areas();
  ASSERT_EQ(areas.size(), 4u);
  EXPECT_TRUE(relative(areas[0], 0.25 * (0.64 - 0.25), 3e-3));
  EXPECT_TRUE(relative(areas[1], 0.25, 3e-3));
  EXPECT_TRUE(relative(areas[2], 0.5 * 0.6 * 0.5 / kPi, 5e-3));
  EXPECT_TRUE(relative(areas[0] + areas[1] + areas[2] + areas[3], 1, 1e-12));
}

TEST(PupilFilters, PartsByAngleAndRadius) {
  const PupilFilters filters({sector(-kPi / 2, kPi), sector(kPi / 2, kPi)});
  EXPECT_EQ(filters.part_at({0.3, 0.2}), 0);  // right
  EXPECT_EQ(filters.part_at({0.3, -0.9}), 0);
  EXPECT_EQ(filters.part_at({-0.3, 0.2}), 1);
  EXPECT_EQ(filters.part_at({-0.01, -0.9}), 1);
  // y points down: a sector from 0 over a quarter lies at the lower right.
  const PupilFilters quarter({sector(0, kPi / 2)});
  EXPECT_EQ(quarter.part_at({0.5, 0.5}), 0);
  EXPECT_EQ(quarter.part_at({0.5, -0.5}), 1);
  EXPECT_EQ(PupilFilters().part_at({0.5, -0.5}), 0);
}

TEST(PupilFilters, PolygonsEitherWayAround) {
  for (const bool turned : {false, true}) {
    std::vector<Vec2> corners{{0, 0}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
    if (turned) std::reverse(corners.begin(), corners.end());
    const PupilFilterSpec square = polygon(corners);
    EXPECT_TRUE(covers(square, {0.25, 0.1}));
    EXPECT_FALSE(covers(square, {0.25, -0.1}));
    EXPECT_FALSE(covers(square, {0.6, 0.25}));
    EXPECT_TRUE(covers(square, {0.25, 0.25}, 0.2));
    EXPECT_FALSE(covers(square, {0.25, 0.1}, 0.2));
  }
}

TEST(PupilFilters, OverlapsAndWhatOnlyTouches) {
  EXPECT_FALSE(overlap(sector(0, kPi), sector(kPi, kPi)));
  EXPECT_TRUE(overlap(sector(0, kPi), sector(kPi - 0.02, kPi)));
  EXPECT_FALSE(overlap(sector(0, 0, 0, 0.5), sector(0, 0, 0.5, 1)));
  EXPECT_TRUE(overlap(sector(0, 0, 0, 0.51), sector(0, 0, 0.5, 1)));
  const PupilFilterSpec left = polygon({{-1, -1}, {0, -1}, {0, 1}, {-1, 1}});
  EXPECT_FALSE(overlap(left, polygon({{0, -1}, {1, -1}, {1, 1}, {0, 1}})));
  EXPECT_TRUE(overlap(left, polygon({{-0.01, -1}, {1, -1}, {1, 1}, {-0.01, 1}})));
  EXPECT_FALSE(overlap(left, sector(-kPi / 2, kPi)));
}

TEST(PupilFilters, CornersAsText) {
  const std::vector<Vec2> corners{{0, -1}, {1, -1e-3}, {0.25, 1}};
  EXPECT_EQ(parse_corners(format_corners(corners)), corners);
  EXPECT_EQ(parse_corners(" 0 -1,1 -0.001 ,0.25 +1"), corners);
  EXPECT_TRUE(parse_corners("").empty());
  for (const char* wrong : {"0", "0 1 2, 3 4", "0 1; 2 3", "a b", "0 nan", "1 2,"})
    EXPECT_THROW(static_cast<void>(parse_corners(wrong)), InputError) << wrong;
}

}  // namespace
}  // namespace plenoflame::test::pupil_filters_test
