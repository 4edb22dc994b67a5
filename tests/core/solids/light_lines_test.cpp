// Lines of light end where they meet something: what is behind that neither shines nor dims.
#include <gtest/gtest.h>

#include <cmath>

#include "core/solids/surface_samples.h"
#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"

namespace plenoflame::test::light_lines_test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// A camera that sees some decimetres of a white wall, 1 m away. What lights the wall is above the
/// field of view.
Scene wall_scene() {
  Scene scene;
  scene.camera.lens.model = LensModel::ideal;
  scene.camera.lens.focal_length = 0.1;
  scene.camera.lens.diameter = 0.02;
  scene.camera.sensor = {15, 15, 1e-3};
  scene.camera.focus.object_distance = 1;
  scene.camera.focus.conjugate = "sensor";
  SolidSurfaceSpec wall = shaped(SolidShape::plane, 1);
  wall.extent = {kInfinity, kInfinity};
  wall.position = {1, 0, 0};
  wall.rotation = {0, -0.5 * kPi, 0};  // z towards -x
  wall.material.reflectivity = 0.8;
  scene.surfaces = {wall};
  scene.render.reflections = 1;
  return scene;
}

/// A plate above, facing down, that hides what is higher up from all of the wall that is seen.
SolidSurfaceSpec plate() {
  SolidSurfaceSpec spec = shaped(SolidShape::plane, 1);
  spec.extent = {0.6, 0.4};
  spec.position = {0.55, 0, 0.3};
  spec.rotation = {kPi, 0, 0};
  spec.material.reflectivity = 0;
  return spec;
}

FlameSpec ball(Vec3 place, double temperature, double absorption) {
  FlameSpec flame;
  flame.kind = FlameKind::layered;
  flame.position = place;
  EllipsoidSpec layer;
  layer.semi_axes = {0.05, 0.05, 0.05};
  layer.temperature = temperature;
  layer.absorption = absorption;
  flame.layers = {layer};
  return flame;
}

double flux_of(const Scene& scene) {
  RenderSettings settings;
  settings.samples = 512;
  settings.replicates = 4;
  return render(compile(scene, load_core_medium, one_thread()), settings, one_thread())
      .statistics.flux;
}

TEST(LightLines, FlamesBehindAPlateDoNotShine) {
  Scene scene = wall_scene();
  scene.flames = {ball({0.5, 0, 0.45}, 1800, 20)};
  const double open = flux_of(scene);
  EXPECT_GT(open, 0);
  scene.surfaces.push_back(plate());
  EXPECT_EQ(flux_of(scene), 0);
}

// The plate's light is found by its points or by reflected rays.
TEST(LightLines, FlamesBehindAnEmitterDoNotDimIt) {
  Scene scene = wall_scene();
  scene.surfaces.push_back(plate());
  scene.surfaces[1].material.kind = MaterialKind::emitter;
  scene.surfaces[1].material.radiance = 40;
  const double alone = flux_of(scene);
  EXPECT_GT(alone, 0);
  scene.flames = {ball({0.55, 0, 0.4}, 20, 1000)};
  scene.flames[0].layers[0].semi_axes = {0.4, 0.35, 0.08};  // behind nearly all of it
  EXPECT_TRUE(relative(flux_of(scene), alone, 1e-2));
  // The same flame between plate and wall does.
  scene.flames = {ball({0.75, 0, 0.15}, 20, 1000)};
  EXPECT_LT(flux_of(scene), 0.95 * alone);
}

TEST(LightLines, FlamesBehindALampDoNotDimIt) {
  Scene scene = wall_scene();
  LightSpec lamp;
  lamp.position = {0.5, 0, 0.2};
  lamp.power = 100;
  scene.lights = {lamp};
  const double alone = flux_of(scene);
  EXPECT_GT(alone, 0);
  scene.flames = {ball({0.25, 0, 0.3}, 20, 1000)};
  EXPECT_TRUE(relative(flux_of(scene), alone, 2e-3));
  scene.flames = {ball({0.75, 0, 0.1}, 20, 1000)};
  EXPECT_LT(flux_of(scene), 0.9 * alone);
}

}  // namespace
}  // namespace plenoflame::test::light_lines_test
