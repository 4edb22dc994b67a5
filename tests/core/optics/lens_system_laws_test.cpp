// Laws that hold for every ray through every lens, whatever the numbers.
#include <cmath>
#include <random>

#include "plenoflame/optics/first_order.h"
#include "plenoflame/optics/lens_system.h"
#include "prescriptions.h"
#include "support/approx.h"

namespace plenoflame::test::lens_system_laws_test {
namespace {

/// Lenses of random shape, with the first vertex anywhere; clear diameters inside the spheres.
std::vector<SurfaceSpec> random_lens(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<SurfaceSpec> surfaces;
  const int count = 1 + static_cast<int>(4 * u(random));
  for (int i = 0; i < count; ++i) {
    double radius = size * std::pow(10.0, 0.2 + 3 * u(random)) * (u(random) < 0.5 ? -1 : 1);
    if (u(random) < 0.15) radius = kInfinity;
    const double index = i + 1 == count ? 1.0 : 1 + (u(random) < 0.2 ? 1e-9 : 0.9) * u(random);
    surfaces.push_back({radius, size * (0.2 + u(random)), index, 2 * size, false});
  }
  return surfaces;
}

Ray random_ray(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> u(-1, 1);
  return {{0.6 * size * u(random), 0.6 * size * u(random), 3 * size * (1.2 + u(random))},
          normalize({0.25 * u(random), 0.25 * u(random), -1})};
}

TEST(LensSystemLaws, SnellAndCoplanarityAtEverySurface) {
  std::mt19937_64 random(1);
  int checked = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double size = std::pow(10.0, -5 + (trial % 6));
    const std::vector<SurfaceSpec> surfaces = random_lens(random, size);
    Ray ray = random_ray(random, size);
    const LensSystem lens(surfaces);
    std::vector<Vec3> path;
    const Ray start = ray;
    if (lens.trace_to_sensor(ray, &path).status != RayStatus::reached) continue;
    ASSERT_EQ(path.size(), surfaces.size());
    path.insert(path.begin(), start.origin);
    path.push_back(ray.at(size));
    double before = 1;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const Vec3 d0 = normalize(path[i + 1] - path[i]), d1 = normalize(path[i + 2] - path[i + 1]);
      const double c = 1 / surfaces[i].radius;
      const Vec3 p = path[i + 1] - Vec3{0, 0, lens.vertices()[i]};
      // Normal towards the scene; the point lies on the sphere.
      const Vec3 normal{c * p.x, c * p.y, 1 + c * p.z};
      EXPECT_TRUE(relative(length(normal), 1, 1e-13));
      const double after = surfaces[i].index;
      const Vec3 snell = before * cross(d0, normal) - after * cross(d1, normal);
      EXPECT_TRUE(within(length(snell), 0, 2e-13, 1)) << trial << " surface " << i;
      // Incident and refracted ray and the normal in one plane.
      EXPECT_TRUE(within(dot(cross(d0, d1), normal), 0, 2e-13, 1));
      EXPECT_LT(d1.z, 0);
      before = after;
      ++checked;
    }
    EXPECT_TRUE(relative(length(ray.direction), 1, 1e-14));
  }
  EXPECT_GT(checked, 3000);
}

TEST(LensSystemLaws, LightGoesBackTheWayItCame) {
  std::mt19937_64 random(2);
  int checked = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double size = std::pow(10.0, -5 + (trial % 6));
    const LensSystem lens(random_lens(random, size), 0.3 * size);
    const Ray start = random_ray(random, size);
    Ray ray = start;
    if (lens.trace_to_sensor(ray).status != RayStatus::reached) continue;
    ray = {ray.at(2 * size), -ray.direction};
    ASSERT_EQ(lens.trace_to_scene(ray), TraceStatus{});
    const Vec3 off = ray.origin - start.origin;
    EXPECT_TRUE(within(length(off - dot(off, start.direction) * start.direction), 0, 3e-13, size))
        << trial;
    EXPECT_TRUE(within(length(ray.direction + start.direction), 0, 3e-13, 1)) << trial;
    ++checked;
  }
  EXPECT_GT(checked, 1000);
}

TEST(LensSystemLaws, TurningAndScaling) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const std::vector<SurfaceSpec> surfaces = random_lens(random, 0.01);
    const Ray start = random_ray(random, 0.01);
    Ray ray = start;
    const TraceStatus status = LensSystem(surfaces).trace_to_sensor(ray);
    const double angle = 0.7 * trial, c = std::cos(angle), s = std::sin(angle);
    const auto turned = [&](Vec3 v) { return Vec3{c * v.x - s * v.y, s * v.x + c * v.y, v.z}; };
    Ray turned_ray{turned(start.origin), turned(start.direction)};
    EXPECT_EQ(LensSystem(surfaces).trace_to_sensor(turned_ray), status);
    // A power of two scales exactly.
    std::vector<SurfaceSpec> large = surfaces;
    for (SurfaceSpec& surface : large) {
      surface.radius *= 1024;
      surface.thickness *= 1024;
      surface.diameter *= 1024;
    }
    Ray large_ray{1024 * start.origin, start.direction};
    EXPECT_EQ(LensSystem(large).trace_to_sensor(large_ray), status);
    if (status.status != RayStatus::reached) continue;
    EXPECT_TRUE(within(length(turned_ray.origin - turned(ray.origin)), 0, 1e-13, 0.01));
    EXPECT_TRUE(within(length(turned_ray.direction - turned(ray.direction)), 0, 1e-13, 1));
    EXPECT_EQ(large_ray.origin, 1024 * ray.origin);
    EXPECT_EQ(large_ray.direction, ray.direction);
  }
}

TEST(LensSystemLaws, ParaxialLimit) {
  // A ray at 1/2^k of a given height and slope deviates from the ABCD matrix by a third-order term.
  const std::vector<SurfaceSpec> surfaces = double_gauss();
  const FirstOrder first = first_order(surfaces);
  const LensSystem lens(surfaces);
  double previous = 0;
  for (int k = 0; k < 5; ++k) {
    const double part = std::ldexp(1.0, -k), height = 6e-3 * part, slope = 0.05 * part;
    Ray ray{{height - slope, 0, 1}, normalize({slope, 0, -1})};
    ASSERT_EQ(lens.trace_to_sensor(ray), TraceStatus{});
    const double out = -ray.direction.x / ray.direction.z;
    const double at_vertex = ray.origin.x + out * (ray.origin.z - lens.vertices().back());
    // From the first vertex: slope' = -h / f + d s with d = -FFL / f; h' by the principal planes.
    const double paraxial_slope =
        -(height + first.front_principal * slope) / first.focal_length + slope;
    const double paraxial_height =
        height + first.front_principal * slope - first.rear_principal * paraxial_slope;
    const double error =
        std::fabs(out - paraxial_slope) + std::fabs(at_vertex - paraxial_height) / 0.1;
    if (k > 1) {
      EXPECT_GT(previous / error, 7.0) << k;
      EXPECT_LT(previous / error, 9.0) << k;
    }
    previous = error;
  }
  EXPECT_LT(previous, 1e-6);
}

}  // namespace
}  // namespace plenoflame::test::lens_system_laws_test
