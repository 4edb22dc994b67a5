#include "render/visibility/aperture_cone.h"

#include <gtest/gtest.h>

#include <random>

#include "plenoflame/base/constants.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::aperture_cone_test {
namespace {

// A plane front of radius a: the cone around a sphere of that radius.
TEST(ApertureCone, SolidAngleOnTheAxis) {
  MainLensSpec lens = singlet();
  lens.surfaces[0].radius = kInfinity;
  const ApertureCone cone{Camera(small_scene(lens, {}).camera)};
  for (const double distance : {0.1, 1.0, 1e4}) {
    const double sine = 0.06 / distance;
    // 2 pi (1 - cos) without its cancellation.
    const double expected = 4 * constants::pi * std::pow(std::sin(0.5 * std::asin(sine)), 2);
    EXPECT_TRUE(relative(cone.draw({0, 0, distance}, 0.3, 0.4).solid_angle, expected, 1e-7));
  }
}

// Draws reach the edge of the cone, evenly in its cosine, and point to the camera.
TEST(ApertureCone, DirectionsFillTheCone) {
  const ApertureCone cone{Camera(small_scene(singlet(), {}).camera)};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Vec3 point{0.3, -0.2, 0.4};
  const double half = 0.06, depth = 0.3 - std::sqrt(0.3 * 0.3 - half * half);
  const Vec3 to_centre = Vec3{0, 0, -depth} - point;
  const double cos_edge = std::sqrt(1 - half * half / dot(to_centre, to_centre));
  double sum = 0, least = 1;
  const int count = 20000;
  for (int i = 0; i < count; ++i) {
    const auto drawn = cone.draw(point, uniform(random), uniform(random));
    EXPECT_TRUE(relative(length(drawn.direction), 1, 1e-14));
    EXPECT_LT(drawn.direction.z, 0);
    const double place = (1 - dot(drawn.direction, normalize(to_centre))) / (1 - cos_edge);
    EXPECT_LE(place, 1 + 1e-6);
    least = std::min(least, 1 - place);
    sum += place;
  }
  EXPECT_LT(least, 1e-3);
  EXPECT_TRUE(within_standard_errors(sum / count, 0.5, std::sqrt(1.0 / 12 / count), 4));
}

// Every point of a bulging or hollow front lies within the cone, seen from anywhere in front of it.
TEST(ApertureCone, HoldsTheWholeFront) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double radius : {0.3, -0.3, 0.0601, -0.0601, kInfinity}) {
    MainLensSpec lens = singlet();
    lens.surfaces[0].radius = radius;
    lens.surfaces[0].thickness = 0.07;
    lens.surfaces[1].radius = -0.03;
    lens.surfaces[1].diameter = 0.05;
    const ApertureCone cone{Camera(small_scene(lens, {}).camera)};
    for (int i = 0; i < 2000; ++i) {
      const Vec3 point{0.5 * uniform(random), 0.5 * uniform(random), 0.8 + 0.5 * uniform(random)};
      const double height = 0.06 * std::sqrt(std::fabs(uniform(random))),
                   azimuth = 4 * uniform(random);
      const double sag =
          std::isfinite(radius)
              ? radius - std::copysign(std::sqrt(radius * radius - height * height), radius)
              : 0;
      const Vec3 on_front{height * std::cos(azimuth), height * std::sin(azimuth), -sag};
      // The edge of the cone in the direction of that point: u = 1 is as far from the axis as it
      // gets.
      const auto edge = cone.draw(point, 1, 0.1);
      const double cos_edge = 1 - edge.solid_angle / (2 * constants::pi);
      Vec3 axis = edge.direction;  // for v = 0.1 and 0.6 opposite edges; their middle is the axis
      axis = normalize(axis + cone.draw(point, 1, 0.6).direction);
      EXPECT_GE(dot(normalize(on_front - point), axis), cos_edge - 1e-12) << "radius " << radius;
    }
  }
}

}  // namespace
}  // namespace plenoflame::test::aperture_cone_test
