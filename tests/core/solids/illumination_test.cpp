// Light on surfaces against closed forms of radiative exchange (Modest, Radiative Heat Transfer,
// appendix D; Howell's catalogue).
#include <gtest/gtest.h>

#include <cmath>

#include "core/solids/mean_radiance.h"
#include "plenoflame/media/layered_medium.h"
#include "support/approx.h"

namespace plenoflame::test::illumination_test {
namespace {

constexpr double kPi = 3.14159265358979323846;

SolidSurfaceSpec disc_at(double z, double radius, bool down) {
  SolidSurfaceSpec disc = shaped(SolidShape::disc, radius);
  disc.position = {0, 0, z};
  if (down) disc.rotation = {kPi, 0, 0};
  return disc;
}

// Coaxial parallel discs: F = (x - sqrt(x^2 - 4 (r2/r1)^2)) / 2, x = 1 + (1 + R2^2) / R1^2,
// R = r / distance.
TEST(Illumination, FormFactorOfParallelDiscs) {
  for (const double r2 : {0.2, 1.0, 3.0}) {
    SolidSurfaceSpec receiver = disc_at(0, 0.5, false), source = disc_at(0.8, r2, true);
    receiver.material.reflectivity = 0.7;
    source.material.kind = MaterialKind::emitter;
    source.material.radiance = 40;
    source.material.sides = MaterialSides::front;
    const double R1 = 0.5 / 0.8, R2 = r2 / 0.8, x = 1 + (1 + R2 * R2) / (R1 * R1);
    const double factor = 0.5 * (x - std::sqrt(x * x - 4 * (R2 / R1) * (R2 / R1)));
    const Mean mean = mean_radiance(lit_scene({receiver, source}, {}), 0, 200000, 5);
    EXPECT_TRUE(within_standard_errors(mean.value, 0.7 * 40 * factor, mean.error, 4));
    EXPECT_LT(mean.error, 0.02 * mean.value);
    // Turned round, its back is dark.
    SolidSurfaceSpec turned = source;
    turned.rotation = {};
    EXPECT_EQ(mean_radiance(lit_scene({receiver, turned}, {}), 0, 1000, 5).value, 0);
  }
}

// Inside a closed white-ish sphere that emits, every reflection adds its share: the radiance is
// L (1 + r + r^2 + ...); here half of a box: an emitter below, walls of reflectivity r around it.
TEST(Illumination, SurroundingsOfTheSameRadianceEverywhere) {
  // A body in uniform surroundings, seen from outside: convex, so its radiance is r L.
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 3;
  SolidSurfaceSpec cone = shaped(SolidShape::cone, 1);
  cone.material.reflectivity = 0.6;
  const Mean convex = mean_radiance(lit_scene({cone}, {sky}), 0, 1000, 6);
  EXPECT_TRUE(relative(convex.value, 0.6 * 3, 1e-12));
  // A furnace: surroundings and a white (r = 1) room in which light may go on: L everywhere.
  SolidSurfaceSpec floor = disc_at(0, 1, false), wall = shaped(SolidShape::cylinder, 1);
  wall.caps = false;
  floor.material.reflectivity = wall.material.reflectivity = 1;
  const Mean open = mean_radiance(lit_scene({floor, wall}, {sky}, 60), 0, 4000, 7);
  EXPECT_TRUE(relative(open.value, 3, 1e-3));  // 60 reflections leave little inside
}

// One reflection against two: a floor in a tube, by the form factors of coaxial discs. Light that
// came over the wall once is what the second reflection adds; with a wall that reflects nothing
// there is none.
TEST(Illumination, ReflectionsUpToTheDepthGiven) {
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 1;
  SolidSurfaceSpec floor = disc_at(0, 1, false), wall = shaped(SolidShape::cylinder, 1);
  wall.caps = false;
  wall.height = 2;
  floor.material.reflectivity = 0.5;
  wall.material.reflectivity = 0.8;
  const auto disc_factor = [](double distance) {
    const double R2 = 1 / (distance * distance), x = 2 + 1 / R2;
    return 0.5 * (x - std::sqrt(x * x - 4));
  };
  const Mean once = mean_radiance(lit_scene({floor, wall}, {sky}, 1), 0, 200000, 8);
  EXPECT_TRUE(within_standard_errors(once.value, 0.5 * disc_factor(2), once.error, 4));
  // Second: floor <- ring of wall at height z <- opening. Ring to disc factors are derivatives of
  // disc to disc ones: A_floor dF_{floor-ring} = -A d F(z), F_{ring-opening} = (1/2) dF/dz * r.
  double second = 0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double z = 2 * (i + 0.5) / kSteps, h = 1e-5;
    const double to_floor = -(disc_factor(z + h) - disc_factor(z - h)) / (2 * h);
    const double up = 2 - z;
    const double to_sky = -0.5 * (disc_factor(up + h) - disc_factor(up - h)) / (2 * h);
    second += 0.5 * 0.8 * to_floor * to_sky * 2 / kSteps;
  }
  const Mean twice = mean_radiance(lit_scene({floor, wall}, {sky}, 2), 0, 200000, 9);
  EXPECT_TRUE(within_standard_errors(twice.value, 0.5 * disc_factor(2) + second, twice.error, 4));
  EXPECT_GT(second, 20 * twice.error);
}

TEST(Illumination, LightsByTheInverseSquareAndTheCosine) {
  SolidSurfaceSpec disc = disc_at(0, 1e-6, false);
  disc.material.reflectivity = 0.4;
  LightSpec point;
  point.position = {0.6, 0.3, 1.2};
  point.direction = -point.position;
  point.power = 50;
  point.cone = 0.5;
  const double d2 = dot(point.position, point.position), cosine = 1.2 / std::sqrt(d2);
  const double intensity = 50 / (2 * kPi * (1 - std::cos(0.25)));
  const Mean by_point = mean_radiance(lit_scene({disc}, {point}), 0, 10, 1);
  EXPECT_TRUE(relative(by_point.value, 0.4 / kPi * intensity * cosine / d2, 1e-5));
  point.cone = 0;  // all directions
  const Mean evenly = mean_radiance(lit_scene({disc}, {point}), 0, 10, 1);
  EXPECT_TRUE(relative(evenly.value, 0.4 / kPi * 50 / (4 * kPi) * cosine / d2, 1e-5));
  point.cone = 0.5;
  point.direction = {0, 0, 1};
  EXPECT_EQ(mean_radiance(lit_scene({disc}, {point}), 0, 10, 1).value, 0);

  LightSpec sun;
  sun.kind = LightKind::parallel;
  sun.direction = {0, 3, -4};
  sun.irradiance = 1000;
  sun.temperature = 5800;  // the channel takes all wavelengths: nothing changes
  const Mean by_sun = mean_radiance(lit_scene({disc}, {sun}), 0, 10, 1);
  EXPECT_TRUE(relative(by_sun.value, 0.4 / kPi * 1000 * 0.8, 1e-12));
}

// A transparent gas ball of uniform emission lights a small disc like its volume would: for optical
// thickness to 0, E = integral of j cos / r^2 dV, which for a ball off to the side is
// j (4/3) pi a^3 cos / d^2 only far away; an optically thick one shines like a black ball,
// E = pi S cos (a/d)^2 exactly.
TEST(Illumination, TheFlameLightsThroughItsOwnAbsorption) {
  for (const double absorption : {0.01, 5.0, 2e4}) {
    const double a = 0.1;
    const Vec3 centre{0.2, 0, 0.5};
    CompiledScene scene = lit_scene({disc_at(0, 1e-6, false)}, {});
    scene.scene.surfaces[0].material.reflectivity = 1;
    scene.medium =
        make_layered_medium({{centre, {a, a, a}, 1500, absorption}}, {}, {SourceFunction::total()});
    const double source = SourceFunction::total()(1500);
    // Radiance of a chord is S (1 - exp(-2 k a cos)); over the ball's disc as seen from d, with
    // sin = d sin(angle) / a: integrated over the cone by Simpson in the angle. The cosine with the
    // disc's normal averages, around the axis, to cos(angle) cos(centre).
    const double d = length(centre), limit = std::asin(a / d);
    const auto f = [&](double angle) {
      const double s = d * std::sin(angle) / a;
      const double chord = 2 * a * std::sqrt(std::max(0.0, 1 - s * s));
      return -std::expm1(-absorption * chord) * std::cos(angle) * std::sin(angle);
    };
    double integral = 0;
    constexpr int kSteps = 200000;
    for (int i = 0; i < kSteps; ++i) integral += f(limit * (i + 0.5) / kSteps) * limit / kSteps;
    const double irradiance = 2 * kPi * source * integral * centre.z / d;
    const Mean mean = mean_radiance(scene, 0, 100000, 11);
    EXPECT_TRUE(within_standard_errors(mean.value, irradiance / kPi, mean.error, 4)) << absorption;
    EXPECT_LT(mean.error, 0.01 * mean.value);
    if (absorption > 1e4) {
      EXPECT_TRUE(relative(mean.value, source * (a / d) * (a / d) * centre.z / d, 0.01));
    }
    scene.scene.render.flame_light = false;
    EXPECT_EQ(mean_radiance(scene, 0, 100, 11).value, 0);
  }
}

// A surface in the middle of the flame: an emitting ball around the disc gives pi L with
// L = S (1 - exp(-k a)) in every direction. A point light behind the gas is dimmed by it.
TEST(Illumination, ASurfaceInsideTheFlame) {
  CompiledScene scene = lit_scene({disc_at(0, 1e-7, false)}, {});
  scene.scene.surfaces[0].material.reflectivity = 0.5;
  scene.medium =
      make_layered_medium({{{0, 0, 0}, {0.1, 0.1, 0.1}, 1800, 7}}, {}, {SourceFunction::total()});
  const double radiance = SourceFunction::total()(1800) * -std::expm1(-0.7);
  const Mean inside = mean_radiance(scene, 0, 100000, 12);
  EXPECT_TRUE(within_standard_errors(inside.value, 0.5 * radiance, inside.error, 4));
  EXPECT_LT(inside.error, 0.01 * inside.value);

  LightSpec point;
  point.position = {0, 0, 2};
  point.power = 4 * kPi * 1000;
  scene.lights = compile_lights({point}, {SourceFunction::total()});
  scene.scene.render.flame_light = false;
  const Mean dimmed = mean_radiance(scene, 0, 10, 13);
  EXPECT_TRUE(relative(dimmed.value, 0.5 / kPi * 1000 / 4 * std::exp(-0.7), 1e-6));
}

}  // namespace
}  // namespace plenoflame::test::illumination_test
