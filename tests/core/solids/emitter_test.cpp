// Light of emitting surfaces: closed forms, with errors small enough to show that points of the
// emitter are drawn, not hoped for.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/solids/mean_radiance.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

namespace plenoflame::test::emitter_test {
namespace {

constexpr double kPi = 3.14159265358979323846;

SolidSurfaceSpec emitter(SolidShape shape, double size, Vec3 position, double radiance) {
  SolidSurfaceSpec spec = shaped(shape, size);
  spec.position = position;
  spec.material.kind = MaterialKind::emitter;
  spec.material.radiance = radiance;
  return spec;
}

SolidSurfaceSpec receiver(double radius, double reflectivity) {
  SolidSurfaceSpec spec = shaped(SolidShape::disc, radius);
  spec.material.reflectivity = reflectivity;
  return spec;
}

// E = pi L (a / d)^2 cos, exact for a sphere above the horizon: whatever its size.
TEST(Emitters, SphereAboveAPlane) {
  for (const double a : {1e-4, 0.05, 0.5}) {
    const Vec3 centre{0.4, -0.2, 0.8};
    const double d = length(centre);
    const double expected = 0.7 * 25 * (a / d) * (a / d) * centre.z / d;
    const Mean mean = mean_radiance(
        lit_scene({receiver(1e-7, 0.7), emitter(SolidShape::sphere, a, centre, 25)}, {}), 0, 20000,
        3);
    EXPECT_TRUE(within_standard_errors(mean.value, expected, mean.error, 4)) << a;
    // A ray in a random direction would meet the smallest one once in 10^8 times.
    EXPECT_LT(mean.error, 0.02 * expected) << a;
  }
}

// An emitter that touches: drawing its points alone would have no finite variance.
TEST(Emitters, DiscThatAllButTouches) {
  SolidSurfaceSpec source = emitter(SolidShape::disc, 1, {0, 0, 1e-4}, 8);
  source.rotation = {kPi, 0, 0};
  const Mean mean = mean_radiance(lit_scene({receiver(0.5, 0.5), source}, {}), 0, 20000, 4);
  // Seen from within half its radius it fills the hemisphere but for (1e-4 / 0.5)^2.
  EXPECT_TRUE(within_standard_errors(mean.value, 0.5 * 8, mean.error, 4));
  EXPECT_LT(mean.error, 2e-3 * mean.value);
}

// In a glowing tube: one less the factor to the open end.
TEST(Emitters, InsideATube) {
  SolidSurfaceSpec tube = emitter(SolidShape::cylinder, 1, {0, 0, 0}, 6);
  tube.caps = false;
  tube.height = 2;
  const double open = 1.0 / (1 + 2.0 * 2.0);  // of a point on the axis to a disc of radius 1 at 2
  const Mean mean = mean_radiance(lit_scene({receiver(1e-7, 0.5), tube}, {}), 0, 20000, 5);
  EXPECT_TRUE(within_standard_errors(mean.value, 0.5 * 6 * (1 - open), mean.error, 4));
  EXPECT_LT(mean.error, 0.01 * mean.value);
}

// Several of different strength, one of them behind another, one turned away; and a mesh.
TEST(Emitters, ManyAndHidden) {
  const TemporaryFolder folder;
  // A square of side 0.2 in z = 1, its front down, in two triangles.
  std::ofstream(folder.file("square.obj"))
      << "v -0.1 -0.1 1\nv 0.1 -0.1 1\nv 0.1 0.1 1\nv -0.1 0.1 1\nf 1 3 2\nf 1 4 3\n";
  SolidSurfaceSpec square = emitter(SolidShape::mesh, 1, {0, 0, 0}, 50);
  square.file = "square.obj";
  square.material.sides = MaterialSides::front;
  const SolidSurfaceSpec ball = emitter(SolidShape::sphere, 0.05, {0.5, 0, 0.5}, 200),
                         hidden = emitter(SolidShape::sphere, 0.05, {1, 0, 1}, 1000);
  SolidSurfaceSpec back = square;
  back.position = {0, 0.5, 0};
  back.rotation = {kPi, 0, 0};  // its front up, below the receiver
  const CompiledScene scene =
      lit_scene({receiver(1e-7, 1), square, ball, hidden, back}, {}, 1, folder.path());
  // Parallel square over a point: (2/pi) * sum over its quarters, Hottel and Sarofim (1967).
  const double x = 0.1, r = std::sqrt(1 + x * x);
  const double quarter = (2 * x / r * std::atan(x / r)) / (2 * kPi);
  const double d2 = 0.5;
  const double expected = 50 * 4 * quarter + 200 * 0.05 * 0.05 / d2 * std::sqrt(0.5);
  const Mean mean = mean_radiance(scene, 0, 200000, 6);
  EXPECT_TRUE(within_standard_errors(mean.value, expected, mean.error, 4));
  EXPECT_LT(mean.error, 0.05 * expected);
}

}  // namespace
}  // namespace plenoflame::test::emitter_test
