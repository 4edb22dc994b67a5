// Every shape by what its points satisfy, and rays that start on a surface, at sizes and places
// from a millionth to a million.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/solids/surface_samples.h"
#include "support/approx.h"

namespace plenoflame::test::shapes_test {
namespace {

constexpr SolidShape kShapes[] = {SolidShape::sphere, SolidShape::cylinder, SolidShape::cone,
                                  SolidShape::disc,   SolidShape::plane,    SolidShape::box};

/// The distance of a point from a shape of size s (in its own frame), by the shape's definition.
double distance_from(SolidShape shape, double s, Vec3 p) {
  const double r = std::hypot(p.x, p.y), h = 1.5 * s;
  switch (shape) {
    case SolidShape::sphere:
      return std::fabs(length(p) - s);
    case SolidShape::cylinder:
      return std::min({std::fabs(r - s), std::fabs(p.z), std::fabs(p.z - h)});
    case SolidShape::cone:
      return std::min(std::fabs(r - s * (1 - p.z / h)), std::fabs(p.z));
    case SolidShape::box:
      return std::min({std::fabs(std::fabs(p.x) - 0.5 * s), std::fabs(std::fabs(p.y) - s),
                       std::fabs(p.z), std::fabs(p.z - 0.7 * s)});
    default:
      return std::fabs(p.z);
  }
}

TEST(Shapes, HitsLieOnTheShape) {
  Random random(1);
  for (const SolidShape shape : kShapes)
    for (const double size : {1e-6, 1e-3, 1.0, 1e5}) {
      SolidSurfaceSpec spec = shaped(shape, size);
      spec.position = {0.3 * size, -2 * size, 5 * size};
      spec.rotation = {0.4, -1.1, 2.3};
      const RigidTransform to_local =
          RigidTransform{rotation_xyz(spec.rotation), spec.position}.inverse();
      const auto scene = scene_of({spec});
      int hits = 0;
      for (int i = 0; i < 2000; ++i) {
        const Vec3 target = spec.position + size * Vec3{random() - 0.5, random() - 0.5, random()};
        const Vec3 d = random.direction();
        SurfaceHit hit;
        if (!scene->intersect({target - 20 * size * d, d}, 0, kInfinity, {}, hit)) continue;
        ++hits;
        ASSERT_TRUE(
            within(distance_from(shape, size, to_local.point(hit.point)), 0, 1e-14, 20 * size));
        ASSERT_TRUE(relative(length(hit.normal), 1, 1e-14));
        ASSERT_LT(dot(hit.normal, d), 0);
      }
      EXPECT_GT(hits, 300);
    }
}

// Against the closed form of a chord: a ray that starts on a sphere, or inside of a tube, must not
// stop where it starts, and must not miss the other side.
TEST(Shapes, ChordsOfASphere) {
  Random random(2);
  for (const double size : {1e-6, 1.0, 1e6})
    for (const double away : {0.0, 1.0, 1000.0}) {
      SolidSurfaceSpec spec = shaped(SolidShape::sphere, size);
      spec.position = away * size * Vec3{0.5, -0.7, 0.3};
      const auto scene = scene_of({spec});
      for (int i = 0; i < 5000; ++i) {
        const Vec3 n = random.direction();
        SurfaceHit start;
        ASSERT_TRUE(scene->intersect({spec.position + 3 * size * n, -n}, 0, kInfinity, {}, start));
        ASSERT_TRUE(start.front);
        const Vec3 d = random.direction();
        SurfaceHit hit;
        const bool hits = scene->intersect({start.point, d}, 0, kInfinity, start.where, hit);
        ASSERT_EQ(hits, dot(n, d) < 0);
        ASSERT_EQ(scene->occluded({start.point, d}, 0, kInfinity, start.where), dot(n, d) < 0);
        if (!hits) continue;
        // The place where a grazing line crosses a sphere is less certain than its distance from
        // it.
        ASSERT_TRUE(
            within(hit.t, -2 * size * dot(n, d), 1e-14 / std::fabs(dot(n, d)), size * (1 + away)));
        ASSERT_FALSE(hit.front);
      }
    }
}

// No ray that leaves a convex body outwards comes back, one that enters leaves through another
// place; whatever the size, and far from the origin of the world.
TEST(Shapes, RaysThatLeaveDoNotComeBack) {
  Random random(3);
  for (const SolidShape shape : kShapes)
    for (const double size : {1e-5, 1.0, 1e5})
      for (const double away : {0.0, 1e3}) {
        SolidSurfaceSpec spec = shaped(shape, size);
        spec.position = away * size * Vec3{1, 0.2, -0.6};
        spec.rotation = {0.2, 0.9, -0.5};
        const auto scene = scene_of({spec});
        const bool flat = shape == SolidShape::disc || shape == SolidShape::plane;
        for (int i = 0; i < 3000; ++i) {
          const SurfacePoint start = scene->point_on(0, random(), random(), random());
          const Vec3 d = random.direction();
          const double along = dot(start.normal, d);
          if (std::fabs(along) < 1e-6) continue;
          ASSERT_EQ(scene->occluded({start.point, d}, 0, kInfinity, start.where),
                    !flat && along < 0)
              << static_cast<int>(shape) << " size " << size << " away " << away;
        }
      }
}

// A ball that lies on a plane, and one on an endless plane: from next to the place where they
// touch, the ball hides the light above it and nothing else does.
TEST(Shapes, TouchingSurfacesDoNotShadowThemselves) {
  for (const double size : {1e-4, 1.0, 1e4})
    for (const bool endless : {false, true}) {
      SolidSurfaceSpec ball = shaped(SolidShape::sphere, size),
                       ground = shaped(SolidShape::plane, size);
      ball.position = {0, 0, size};
      if (endless)
        ground.extent = {kInfinity, kInfinity};
      else
        ground.extent = {10 * size, 10 * size};
      const auto scene = scene_of({ball, ground});
      for (int i = 1; i < 60; ++i) {
        const double x = size * std::pow(0.7, i);  // ever nearer to the point of contact
        const Ray up{{x, 0, 0}, {0, 0, 1}}, out{{x, 0, 0}, normalize({1, 0, 0.1 * x / size})};
        const SurfacePart from{1, 0};
        if (x < size) {
          SurfaceHit hit;
          ASSERT_TRUE(scene->intersect(up, 0, kInfinity, from, hit));
          // The gap below a sphere: r - sqrt(r^2 - x^2).
          const double gap = x * x / (size + std::sqrt((size - x) * (size + x)));
          if (gap < 1e-15 * size) break;  // no longer a gap in double precision
          ASSERT_TRUE(within(hit.t, gap, 1e-15, size));
        }
        // Away from the ball, at a slope too small to meet it.
        ASSERT_FALSE(scene->occluded(out, 0, kInfinity, from)) << x / size;
      }
    }
}

TEST(Shapes, AreasAndPointsDrawnEvenly) {
  Random random(4);
  const double pi = 3.14159265358979323846;
  const double cone_side = pi * std::hypot(1.0, 1.5);
  const double expected[] = {4 * pi, 2 * pi * 1.5 + 2 * pi, cone_side + pi, pi,
                             6,      2 * (2 + 0.7 + 1.4)};
  for (std::size_t s = 0; s < std::size(kShapes); ++s) {
    const auto scene = scene_of({shaped(kShapes[s], 1)});
    EXPECT_TRUE(relative(scene->area(0), expected[s], 1e-14));
    // Flux of a constant field through the whole surface: 0 for a closed one, area otherwise.
    constexpr int kPoints = 200000;
    Vec3 sum;
    for (int i = 0; i < kPoints; ++i) {
      const SurfacePoint p = scene->point_on(0, random(), random(), random());
      ASSERT_TRUE(within(distance_from(kShapes[s], 1, p.point), 0, 1e-14, 1));
      sum = sum + (1.0 / kPoints) * p.normal;
    }
    const bool flat = kShapes[s] == SolidShape::disc || kShapes[s] == SolidShape::plane;
    EXPECT_TRUE(within_standard_errors(sum.z, flat ? 1 : 0, 1 / std::sqrt(kPoints), 4));
    EXPECT_TRUE(within_standard_errors(sum.x, 0, 1 / std::sqrt(kPoints), 4));
  }
}

// A ball's shadow on a plane: a ray towards the light is free just outside of the cone that
// touches the ball, and not just inside.
TEST(Shapes, ShadowBoundaries) {
  SolidSurfaceSpec ball = shaped(SolidShape::sphere, 0.1), ground = shaped(SolidShape::plane, 1);
  ball.position = {0, 0, 1};
  ground.extent = {kInfinity, kInfinity};
  const auto scene = scene_of({ball, ground});
  const Vec3 light{0, 0, 3};
  // tan of the cone's half angle asin(0.1 / 2), times the distance to the ground.
  const double radius = 3 * 0.05 / std::sqrt(1 - 0.05 * 0.05);
  for (const double azimuth : {0.0, 0.7, 2.9})
    for (const double e : {1e-9, 1e-4}) {
      const Vec3 unit{std::cos(azimuth), std::sin(azimuth), 0};
      for (const double sign : {-1.0, 1.0}) {
        const Vec3 p = radius * (1 + sign * e) * unit;
        const Vec3 to_light = light - p;
        EXPECT_EQ(scene->occluded({p, normalize(to_light)}, 0, length(to_light), {1, 0}), sign < 0);
      }
    }
}

TEST(Shapes, TubesAreOpenAndSeenFromInside) {
  SolidSurfaceSpec tube = shaped(SolidShape::cylinder, 1);
  tube.caps = false;
  const auto scene = scene_of({tube});
  EXPECT_FALSE(scene->occluded({{0.5, 0, 5}, {0, 0, -1}}, 0, kInfinity, {}));
  SurfaceHit hit;
  ASSERT_TRUE(scene->intersect({{0, 0, 3}, normalize({1, 0, -2})}, 0, kInfinity, {}, hit));
  EXPECT_FALSE(hit.front);
  EXPECT_TRUE(relative(hit.point.x, 1, 1e-14));
  EXPECT_TRUE(relative(hit.point.z, 1, 1e-14));
  // The outside is nearer from there.
  ASSERT_TRUE(scene->intersect({{4, 0, 0.5}, {-1, 0, 0}}, 0, kInfinity, {}, hit));
  EXPECT_TRUE(hit.front);
  EXPECT_EQ(scene->inside_of({0, 0, 0.5}), -1);
  EXPECT_EQ(scene_of({shaped(SolidShape::cylinder, 1)})->inside_of({0, 0, 0.5}), 0);
}

}  // namespace
}  // namespace plenoflame::test::shapes_test
