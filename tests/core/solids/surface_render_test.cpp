// Surfaces through a whole camera.
#include <gtest/gtest.h>

#include <cmath>

#include "core/solids/surface_samples.h"
#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"

namespace plenoflame::test::surface_render_test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// An ideal thin lens of 100 mm and a bare sensor, focused at `distance`.
Scene ideal_camera(double distance, int pixels, double pitch) {
  Scene scene;
  scene.camera.lens.model = LensModel::ideal;
  scene.camera.lens.focal_length = 0.1;
  scene.camera.lens.diameter = 0.02;
  scene.camera.sensor = {pixels, pixels, pitch};
  scene.camera.focus.object_distance = distance;
  scene.camera.focus.conjugate = "sensor";
  return scene;
}

/// A wall that faces the camera.
SolidSurfaceSpec wall(double distance) {
  SolidSurfaceSpec spec = shaped(SolidShape::plane, 1);
  spec.extent = {kInfinity, kInfinity};
  spec.position = {distance, 0, 0};
  spec.rotation = {0, -0.5 * kPi, 0};  // z towards -x
  return spec;
}

RenderResult rendered(const Scene& scene, int samples = 64,
                      Precision precision = Precision::double_precision) {
  RenderSettings settings;
  settings.samples = samples;
  settings.replicates = 4;
  settings.precision = precision;
  return render(compile(scene, load_core_medium, one_thread()), settings, one_thread());
}

/// Integral of cos over the solid angle of a lens of radius a, seen from a sensor point at distance
/// v and height s: pi times the configuration factor of an element parallel to a disc.
double pupil_factor(double v, double s, double a) {
  const double z = v * v + s * s + a * a;
  return 0.5 * kPi * (1 - (v * v + s * s - a * a) / std::sqrt(z * z - 4 * s * s * a * a));
}

// Flux per pixel of a Lambertian wall under a point source: reflectivity / pi * intensity * cos /
// r^2 at the conjugate point, times the pupil's factor, times the pixel's area.
TEST(SurfaceRender, LambertianWallUnderAPointSource) {
  const double distance = 2, image = 1 / (1 / 0.1 - 1 / distance);
  Scene scene = ideal_camera(distance, 15, 1e-3);
  scene.surfaces = {wall(distance)};
  scene.surfaces[0].material.reflectivity = 0.8;
  LightSpec light;
  light.position = {0.5, 0.4, 0.3};
  light.power = 100;
  scene.lights = {light};
  for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
    const RenderResult result = rendered(scene, 256, precision);
    const Image& flux = result.light_field.channels[0].flux;
    double sum = 0, expected_sum = 0;
    for (int row = 0; row < 15; ++row)
      for (int column = 0; column < 15; ++column) {
        double expected = 0;
        constexpr int kSub = 8;
        for (int j = 0; j < kSub; ++j)
          for (int i = 0; i < kSub; ++i) {
            // Columns count to the scene's right, which is -y; rows down.
            const double x = (column + (i + 0.5) / kSub - 7.5) * 1e-3;
            const double y = (row + (j + 0.5) / kSub - 7.5) * 1e-3;
            const Vec3 p{distance, -x * distance / image, -y * distance / image};
            const Vec3 to_light = light.position - p;
            const double r2 = dot(to_light, to_light);
            const double radiance = 0.8 / kPi * 100 / (4 * kPi) * -to_light.x / std::sqrt(r2) / r2;
            expected += radiance * pupil_factor(image, std::hypot(x, y), 0.01) / (kSub * kSub);
          }
        // A pupil is drawn 0.1 % wider than it is: few rays fall on its rim.
        EXPECT_TRUE(relative(static_cast<double>(flux.at(column, row)), expected * 1e-6, 1e-2))
            << column << "," << row;
        sum += static_cast<double>(flux.at(column, row));
        expected_sum += expected * 1e-6;
      }
    EXPECT_TRUE(relative(sum, expected_sum, 5e-4));
  }
}

// The image of a point of an object: rays from one sensor point through any point of an ideal
// lens meet a wall at the conjugate distance in one point, that of the paraxial magnification.
TEST(SurfaceRender, ObjectsAreWhereTheirParaxialImageIs) {
  for (const double distance : {0.3, 2.0, 50.0}) {
    const Scene scene = ideal_camera(distance, 15, 1e-3);
    const Camera camera(scene.camera);
    const auto surfaces = scene_of({wall(distance)});
    const double magnification = distance / (1 / (1 / 0.1 - 1 / distance));
    for (const Vec2 sensor : {Vec2{1e-3, 2e-3}, Vec2{-7e-3, 3e-3}, Vec2{5e-3, 5e-3}})
      for (const Vec2 aim : {Vec2{0, 0}, Vec2{9e-3, 0}, Vec2{-3e-3, -8e-3}}) {
        const Ray exit = camera.trace(sensor, std::nullopt, aim).exit;
        const Ray ray{camera.to_world().point(exit.origin),
                      camera.to_world().direction(exit.direction)};
        SurfaceHit hit;
        ASSERT_TRUE(surfaces->intersect(ray, 0, kInfinity, {}, hit));
        // Camera x, y are the world's -y, -z.
        EXPECT_TRUE(relative(-hit.point.y, -magnification * sensor.x, 1e-9));
        EXPECT_TRUE(relative(-hit.point.z, -magnification * sensor.y, 1e-9));
      }
  }
}

/// Flux of the middle pixel, and its standard error.
struct Pixel {
  double flux, error;
};
Pixel middle(const Scene& scene) {
  const RenderResult result = rendered(scene, 1 << 13);
  const LightFieldChannel& channel = result.light_field.channels[0];
  return {static_cast<double>(channel.flux.at(1, 1)),
          static_cast<double>(channel.standard_error.at(1, 1))};
}

// A hot wall behind, inside and in front of a flame: along the axis the flame's layers are known,
// so that the radiance that arrives is known for every place of the wall.
TEST(SurfaceRender, AFlameSegmentEndsAtTheFirstSurface) {
  const double image = 1 / (1 / 0.1 - 1 / 1.0);
  Scene scene = ideal_camera(1.0, 3, 1e-6);  // pixels so small that all rays meet near the axis
  scene.camera.lens.diameter = 1e-4;
  const double thin = pupil_factor(image, 0, 0.5e-4);
  FlameSpec flame;
  flame.position = {1, 0, 0};
  flame.layers = {{"all", {0, 0, 0}, {0.05, 0.05, 0.05}, 1600, 12}};
  const double hot = 5.670374419e-8 * std::pow(1600.0, 4) / kPi;
  const double glow = 5.670374419e-8 * std::pow(1200.0, 4) / kPi;
  const auto with_wall = [&](double x, bool with_flame) {
    Scene s = scene;
    if (with_flame) s.flames = {flame};
    s.surfaces = {wall(x)};
    s.surfaces[0].material.kind = MaterialKind::blackbody;
    s.surfaces[0].material.temperature = 1200;
    return middle(s).flux / (1e-12 * thin);
  };
  const double clear = with_wall(1.0, false) / glow;  // the same rays every time
  const auto expected = [&](double depth) {           // of flame in front of the wall
    const double t = std::exp(-12 * depth);
    return hot * (1 - t) + glow * t;
  };
  EXPECT_TRUE(relative(with_wall(1.0, false), glow, 2e-3));
  EXPECT_TRUE(relative(with_wall(1.5, true) / clear, expected(0.1), 1e-5));    // behind
  EXPECT_TRUE(relative(with_wall(1.02, true) / clear, expected(0.07), 1e-5));  // inside
  EXPECT_TRUE(relative(with_wall(0.97, true) / clear, expected(0.02), 1e-5));
  EXPECT_TRUE(relative(with_wall(0.8, true) / clear, glow, 1e-6));  // in front
}

TEST(SurfaceRender, SurroundingsFillTheBackground) {
  Scene scene = ideal_camera(1.0, 3, 1e-6);
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 17;
  scene.lights = {sky};
  const double image = 1 / (1 / 0.1 - 1 / 1.0);
  EXPECT_TRUE(relative(middle(scene).flux, 17e-12 * pupil_factor(image, 0, 0.01), 2e-3));
}

// Results are those of the scene: not of threads, nor of the window, nor of whether work is
// skipped.
TEST(SurfaceRender, DependsOnNothingButTheScene) {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  SolidSurfaceSpec ball = shaped(SolidShape::sphere, 0.01), box = shaped(SolidShape::box, 0.03);
  ball.position = {1.0, 0.01, 0};
  box.position = {1.05, 0, -0.02};
  scene.surfaces = {ball, box};
  LightSpec light;
  light.position = {0.7, 0.3, 0.4};
  light.power = 1;
  LightSpec sky;
  sky.kind = LightKind::parallel;
  sky.irradiance = 2;
  scene.lights = {light, sky};
  scene.render.reflections = 3;
  const CompiledScene compiled = compile(scene, load_core_medium, one_thread());
  RenderSettings settings;
  settings.samples = 8;
  const RenderResult one = render(compiled, settings, one_thread());
  const RenderResult three = render(compiled, settings, threads(3));
  EXPECT_GT(one.statistics.flux, 0);
  EXPECT_EQ(one.light_field.channels[0].flux.pixels, three.light_field.channels[0].flux.pixels);
  settings.skip = false;
  const RenderResult all = render(compiled, settings, one_thread());
  const Image& whole = one.light_field.channels[0].flux;
  double skipped = 0;
  for (std::size_t i = 0; i < whole.pixels.size(); ++i)
    skipped += std::fabs(
        static_cast<double>(whole.pixels[i] - all.light_field.channels[0].flux.pixels[i]));
  EXPECT_LT(skipped, 1e-5 * one.statistics.flux);
  settings.skip = true;
  settings.window = {20, 10, 25, 30};
  const RenderResult part = render(compiled, settings, one_thread());
  for (int row = 0; row < 30; ++row)
    for (int column = 0; column < 25; ++column)
      ASSERT_EQ(part.light_field.channels[0].flux.at(column, row), whole.at(column + 20, row + 10));
}

}  // namespace
}  // namespace plenoflame::test::surface_render_test
