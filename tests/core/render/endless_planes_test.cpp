#include "render/visibility/endless_planes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "plenoflame/base/constants.h"
#include "plenoflame/sampling/sobol.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::endless_planes_test {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kRadius = 4e-3;
const Vec3 kCentre{1, 0, 0};

/// A floor below the objects and, perhaps, a wall behind them.
CompiledScene planes(bool wall) {
  Scene scene = small_scene(singlet(), large_array(Lattice::square, LensModel::real));
  SolidSurfaceSpec plane;
  plane.shape = SolidShape::plane;
  plane.extent = {kInf, kInf};
  plane.position = {1, 0, -0.02};
  scene.surfaces = {plane};
  if (wall) {
    plane.position = {1.05, 0, 0};
    plane.rotation = {0, -0.5 * constants::pi, 0};
    scene.surfaces.push_back(plane);
  }
  return compile(scene);
}

/// Mean of what leaves a point of the floor: of the weights, and of those towards the objects.
struct Means {
  double all = 0, objects = 0, all_error = 0, objects_error = 0;
};

Means means(const EndlessPlanes& planes, Vec3 point) {
  constexpr std::uint32_t kDraws = 1 << 16;
  double sums[2] = {}, squares[2] = {};
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const auto u = [&](int d) { return (owen_scramble(sobol(i, d), mix64(d)) + 0.5) * 0x1p-32; };
    const EndlessPlanes::Leaving leaving =
        planes.leave(0, {point, {0, 0, 1}}, u(0), u(1), u(2), u(3));
    const Vec3 way = kCentre - point;
    const Vec3 beside = cross(leaving.direction, way);
    const bool hits = dot(leaving.direction, way) > 0 && length(beside) < kRadius;
    const double values[2] = {leaving.weight, hits ? leaving.weight : 0};
    for (int k = 0; k < 2; ++k) {
      sums[k] += values[k];
      squares[k] += values[k] * values[k];
    }
  }
  const auto error = [&](int k) {
    const double mean = sums[k] / kDraws;
    return std::sqrt((squares[k] / kDraws - mean * mean) / kDraws);
  };
  return {sums[0] / kDraws, sums[1] / kDraws, error(0), error(1)};
}

// All of the light leaves, and the objects' part of it is the form factor of a sphere above a small
// piece of a plane, cos sin^2 of its half angle: far more of them are drawn than that, each worth
// less. The points lie up to 1e8 radii away.
TEST(EndlessPlanes, LightThatLeavesAddsUp) {
  for (const bool wall : {false, true}) {
    const CompiledScene scene = planes(wall);
    const EndlessPlanes planes(scene, kCentre, kRadius, 0.01);
    ASSERT_EQ(planes.count(), wall ? 2u : 1u);
    for (const double away : {0.0, 1.0, 1e2, 1e4, 1e5, 1e6, 1e7, 1e8}) {
      const Vec3 point{1 - away * kRadius, 0, -0.02};
      const Means found = means(planes, point);
      EXPECT_TRUE(within_standard_errors(found.all, 1, found.all_error, 5)) << away << " " << wall;
      const Vec3 way = kCentre - point;
      const double square = dot(way, way);
      const double factor = way.z / std::sqrt(square) * kRadius * kRadius / square;
      EXPECT_TRUE(within_standard_errors(found.objects, factor, found.objects_error, 5))
          << away << " " << wall;
      EXPECT_LT(found.objects_error, 0.02 * factor) << away << " " << wall;
    }
  }
}

}  // namespace
}  // namespace plenoflame::test::endless_planes_test
