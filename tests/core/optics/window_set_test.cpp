// Rays through windows against closed forms: Snell's law for plates and wedges, Bouguer's invariant
// (index times distance from the axis or centre) for tubes and domes, the series of reflections.
#include "plenoflame/optics/window_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "plenoflame/base/constants.h"
#include "support/approx.h"

namespace plenoflame::window_set_test {
namespace {

using test::relative;
using test::within;

constexpr double kDegree = constants::pi / 180;

WindowSpec plate(double thickness, double index) {
  WindowSpec spec;
  spec.thickness = thickness;
  spec.extent = {0.2, 0.2};
  spec.index = index;
  return spec;
}

WindowSpec tube(double radius, double wall, double index) {
  WindowSpec spec;
  spec.shape = WindowShape::tube;
  spec.radius = radius;
  spec.thickness = wall;
  spec.height = 0.4;
  spec.position = {0, 0, -0.2};
  spec.index = index;
  return spec;
}

WindowSpec dome(double radius, double wall, double index) {
  WindowSpec spec;
  spec.shape = WindowShape::dome;
  spec.radius = radius;
  spec.thickness = wall;
  spec.height = radius;
  spec.index = index;
  return spec;
}

WindowPath through(const WindowSpec& spec, const Ray& ray) {
  WindowPath path;
  WindowSet({spec}).trace(ray, path);
  return path;
}

/// Angle by which a ray turns, in a plane across y [rad].
double turn(Vec3 from, Vec3 to) {
  return std::asin(cross(from, to).y);
}

class PlateAtAngle : public ::testing::TestWithParam<double> {};

TEST_P(PlateAtAngle, DisplacesAndShifts) {
  const double angle = GetParam(), t = 0.012, n = 1.4585;
  const Ray ray{{0.01, -0.02, -0.03}, {std::sin(angle), 0, std::cos(angle)}};
  const WindowPath path = through(plate(t, n), ray);
  ASSERT_EQ(path.segments.size(), 2U);
  EXPECT_FALSE(path.stopped);
  const Ray& out = path.segments[1].ray;
  EXPECT_TRUE(within(out.direction.x, ray.direction.x, 1e-15, 1));
  const double root = std::sqrt(n * n - std::pow(std::sin(angle), 2));
  // Across the ray: t sin (1 - cos / sqrt(n^2 - sin^2)).
  const Vec3 apart = cross(out.origin - ray.origin, ray.direction);
  EXPECT_TRUE(relative(length(apart), t * std::sin(angle) * (1 - std::cos(angle) / root), 1e-12));
  // Along the axis: where it crosses the plane that the straight ray crosses at x = 0.1.
  const double straight = ray.origin.z + (0.1 - ray.origin.x) / std::tan(angle);
  const double bent = out.origin.z + (0.1 - out.origin.x) * out.direction.z / out.direction.x;
  EXPECT_TRUE(within(bent - straight, t * (1 - std::cos(angle) / root), 1e-12, straight));
}

INSTANTIATE_TEST_SUITE_P(Angles, PlateAtAngle,
                         ::testing::Values(2 * kDegree, 30 * kDegree, 60 * kDegree));

TEST(Plate, ShiftsTheFocusParaxiallyByThicknessTimesOneMinusOneOverIndex) {
  const double angle = 1e-5, t = 0.012, n = 1.5168;
  const Ray ray{{0, 0, -0.1}, {std::sin(angle), 0, std::cos(angle)}};
  const Ray out = through(plate(t, n), ray).segments[1].ray;
  const double crossing = out.origin.z - out.origin.x * out.direction.z / out.direction.x;
  EXPECT_TRUE(relative(crossing - ray.origin.z, t * (1 - 1 / n), 1e-9));
}

TEST(Plate, IsMissedBeyondItsEdgeAndStopsWhatMeetsItsRim) {
  WindowSpec round = plate(0.01, 1.5);
  round.diameter = 0.1;
  EXPECT_EQ(through(round, {{0.051, 0, -1}, {0, 0, 1}}).segments.size(), 1U);
  EXPECT_EQ(through(round, {{0.049, 0, -1}, {0, 0, 1}}).segments.size(), 2U);
  const WindowPath at_rim = through(round, {{0.2, 0, 0.005}, {-1, 0, 0}});
  EXPECT_TRUE(at_rim.stopped);
  EXPECT_TRUE(relative(at_rim.segments[0].far, 0.15, 1e-12));
  // In through the front, towards the rim at an angle at which it would let light out.
  round.index = 1.2;
  EXPECT_TRUE(through(round, {{0.0485, 0, -1e-5}, normalize({5.67, 0, 1})}).stopped);
  EXPECT_EQ(through(plate(0.01, 1.5), {{0.099, 0.099, -1}, {0, 0, 1}}).segments.size(), 2U);
  EXPECT_EQ(through(plate(0.01, 1.5), {{0.099, 0.101, -1}, {0, 0, 1}}).segments.size(), 1U);
}

TEST(Wedge, DeviatesBySnellsLawAtBothFaces) {
  WindowSpec spec = plate(0.02, 1.5168);
  spec.shape = WindowShape::wedge;
  spec.angle = 6 * kDegree;
  // As it comes: perpendicular to the first face.
  Vec3 out = through(spec, {{0, 0, -1}, {0, 0, 1}}).segments[1].ray.direction;
  const double deviation = std::asin(1.5168 * std::sin(spec.angle)) - spec.angle;
  EXPECT_TRUE(relative(std::asin(out.y), deviation, 1e-12));  // towards the thick side
  // Symmetric: the least deviation of a prism.
  const double in = std::asin(1.5168 * std::sin(0.5 * spec.angle));
  const Vec3 from{0, -std::sin(in), std::cos(in)};
  out = through(spec, {{0, 0.001, -0.01}, from}).segments[1].ray.direction;
  EXPECT_TRUE(relative(std::asin(cross(out, from).x), 2 * in - spec.angle, 1e-11));
}

/// Towards the axis, from air through a wall to air at the distance b of the line from the axis.
double turn_of_wall(double b, double outer, double inner, double n) {
  return std::asin(b / outer) - std::asin(b / (n * outer)) + std::asin(b / (n * inner)) -
         std::asin(b / inner);
}

TEST(Tube, TurnsRaysAcrossItByBouguersInvariant) {
  const double outer = 0.05, inner = 0.0475, n = 1.4585;
  for (const double b : {0.001, 0.01, 0.03, 0.045}) {
    const Ray ray{{b, 0, -1}, {0, 0, 1}};
    WindowSpec spec = tube(outer, outer - inner, n);
    spec.rotation = {0.5 * constants::pi, 0, 0};
    spec.position = {0, 0.2, 0};  // along y
    const WindowPath path = through(spec, ray);
    ASSERT_EQ(path.segments.size(), 3U) << b;
    const Vec3 out = path.segments[2].ray.direction;
    EXPECT_TRUE(relative(turn(ray.direction, out), -2 * turn_of_wall(b, outer, inner, n), 1e-11));
    // In the bore the distance from the axis is what it was outside.
    const Ray& bore = path.segments[1].ray;
    EXPECT_TRUE(relative(std::fabs(cross(bore.origin, bore.direction).y), b, 1e-12));
  }
}

TEST(Tube, IsParaxiallyALensAndLeavesRaysThroughItsAxisAlone) {
  const double outer = 0.03, inner = 0.027, n = 1.46, b = 1e-7;
  const WindowSpec spec = tube(outer, outer - inner, n);
  const Ray near{{-1, b, 0.01}, {1, 0, 0}};
  const Vec3 out = through(spec, near).segments[2].ray.direction;
  EXPECT_TRUE(relative(-out.y / b, 2 * (1 - 1 / n) * (1 / outer - 1 / inner), 1e-8));
  const Ray through_axis{{-1, 0, 0}, normalize({1, 0, 0.1})};
  const Vec3 same = through(spec, through_axis).segments[2].ray.direction;
  EXPECT_TRUE(within(length(same - through_axis.direction), 0, 1e-15, 1));
}

TEST(Tube, TotalReflectionAtTheInnerFaceStopsARay) {
  const double outer = 0.05, inner = 0.04, n = 1.5;
  // Outside of the bore in air, inside of it in glass: n sin > 1 at the inner face.
  EXPECT_TRUE(through(tube(outer, outer - inner, n), {{-1, 0.042, 0}, {1, 0, 0}}).stopped);
}

TEST(Tube, GlassBesideTheBoreIsOneBody) {
  const double outer = 0.05, inner = 0.03, n = 1.5, b = 0.046;  // b / n > inner
  const WindowPath path = through(tube(outer, outer - inner, n), {{-1, b, 0}, {1, 0, 0}});
  ASSERT_EQ(path.segments.size(), 2U);
  const double expected = 2 * (std::asin(b / outer) - std::asin(b / (n * outer)));
  EXPECT_TRUE(relative(-std::asin(path.segments[1].ray.direction.y), expected, 1e-12));
}

TEST(Dome, LeavesChiefRaysThroughItsCentreAloneAndTurnsOthers) {
  const double outer = 0.06, inner = 0.054, n = 1.5168;
  const WindowSpec spec = dome(outer, outer - inner, n);
  for (const double angle : {0.0, 0.3, 1.2}) {
    const Ray chief{{0, 0, 0}, {0.6 * std::sin(angle), 0.8 * std::sin(angle), std::cos(angle)}};
    const WindowPath path = through(spec, chief);
    ASSERT_EQ(path.segments.size(), 2U);
    EXPECT_TRUE(within(length(path.segments[1].ray.direction - chief.direction), 0, 1e-15, 1));
  }
  const double b = 0.02;
  const Ray beside{{b, 0, 0}, {0, 0, 1}};
  const Vec3 out = through(spec, beside).segments[1].ray.direction;
  EXPECT_TRUE(relative(turn(beside.direction, out), -turn_of_wall(b, outer, inner, n), 1e-12));
}

TEST(Dome, IsCutOffAtItsRim) {
  WindowSpec spec = dome(0.06, 0.006, 1.5);
  spec.height = 0.02;
  EXPECT_EQ(through(spec, {{0, 0, 0}, normalize({1, 0, 0.6})}).segments.size(), 1U);
  EXPECT_EQ(through(spec, {{0, 0, 0}, normalize({0.8, 0, 1})}).segments.size(), 2U);
  EXPECT_TRUE(through(spec, {{0.04, 0, -0.1}, {0, 0, 1}}).stopped);
}

/// The beams that leave a plate behind it, one after the other, of one polarisation.
double series(double reflected, double clear) {
  double passed = 0, beam = (1 - reflected) * clear;
  for (int i = 0; i < 200; ++i) {
    passed += beam * (1 - reflected);
    beam *= reflected * reflected * clear * clear;
  }
  return passed;
}

TEST(Transmission, OfAPlateIsTheSumOfItsReflections) {
  const double n = 1.4585;
  for (const double degrees : {0.0, 30.0, 60.0})
    for (const double absorption : {0.0, 40.0}) {
      WindowSpec spec = plate(0.01, n);
      spec.fresnel = true;
      spec.absorption = absorption;
      const double in = degrees * kDegree, inside = std::asin(std::sin(in) / n);
      const WindowPath path = through(spec, {{0, 0, -0.05}, {std::sin(in), 0, std::cos(in)}});
      // Fresnel's formulas by sine and tangent of the sum and difference of the angles.
      const double straight = std::pow((n - 1) / (n + 1), 2);
      const double across =
          in > 0 ? std::pow(std::sin(in - inside) / std::sin(in + inside), 2) : straight;
      const double along =
          in > 0 ? std::pow(std::tan(in - inside) / std::tan(in + inside), 2) : straight;
      const double clear = std::exp(-absorption * 0.01 / std::cos(inside));
      EXPECT_TRUE(relative(path.segments[1].throughput,
                           0.5 * (series(across, clear) + series(along, clear)), 1e-12))
          << degrees;
    }
  // The classical figure at perpendicular incidence.
  EXPECT_TRUE(relative(wall_transmission(n, {1, 1}, 1, true), 2 * n / (n * n + 1), 1e-12));
  EXPECT_EQ(wall_transmission(n, {1, 1}, 0.25, false), 0.25);
}

TEST(WindowSet, RaysGoTheSameWayBack) {
  WindowSpec front = plate(0.008, 1.52), back = dome(0.1, 0.004, 1.6);
  front.rotation = {0.2, 0.1, 0};
  front.position = {0, 0, 0.2};
  front.fresnel = back.fresnel = true;
  back.position = {0.01, 0, -0.02};
  WindowSpec pipe = tube(0.03, 0.003, 1.46);
  pipe.rotation = {0.5 * constants::pi, 0, 0};
  pipe.position = {0, 0.2, 0.4};
  const WindowSet windows({front, back, pipe});
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> draw(-0.02, 0.02);
  WindowPath path, reverse;
  int whole = 0;
  for (int i = 0; i < 200; ++i) {
    const Ray ray{{draw(engine), draw(engine), 0},
                  normalize({4 * draw(engine), 4 * draw(engine), 1})};
    windows.trace(ray, path);
    if (path.stopped || path.segments.size() != 5) continue;
    ++whole;
    const AirSegment& last = path.segments.back();
    windows.trace({last.ray.at(0.5), -last.ray.direction}, reverse);
    ASSERT_EQ(reverse.segments.size(), path.segments.size());
    const AirSegment& home = reverse.segments.back();
    EXPECT_TRUE(within(length(home.ray.direction + ray.direction), 0, 1e-12, 1));
    EXPECT_TRUE(within(length(cross(ray.origin - home.ray.origin, ray.direction)), 0, 1e-12, 1));
    EXPECT_TRUE(relative(home.throughput, last.throughput, 1e-12));
  }
  EXPECT_GT(whole, 50);
}

TEST(WindowSet, KnowsWhereItsGlassIs) {
  const WindowSet windows({tube(0.03, 0.003, 1.46), dome(0.1, 0.004, 1.5)});
  EXPECT_EQ(windows.glass_at({0.0285, 0, 0}), 0);
  EXPECT_EQ(windows.glass_at({0.0265, 0, 0}), -1);
  EXPECT_EQ(windows.glass_at({0.0305, 0, 0}), -1);
  EXPECT_EQ(windows.glass_at({0, 0, 0.098}), 1);
  EXPECT_EQ(windows.glass_at({0, 0, -0.098}), -1);
  for (int w = 0; w < 2; ++w) {
    int inside = 0, total = 0;
    for (const Vec3 p : windows.points_of(w)) {
      ++total;
      // Two of three lie in a face: a millionth inwards or outwards of it.
      inside += windows.glass_at(p) == w;
    }
    EXPECT_GT(inside, total / 4);
  }
}

}  // namespace
}  // namespace plenoflame::window_set_test
