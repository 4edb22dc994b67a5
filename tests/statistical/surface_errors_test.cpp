// Errors of scenes with surfaces: how fast they fall with the number of samples, and whether what
// is stated about them is true.
#include "core/solids/surface_samples.h"
#include "plenoflame/scene/scene_file.h"
#include "statistical/measured_errors.h"
#include "support/small_scene.h"

namespace plenoflame::test::surface_errors_test {
namespace {

/// Bodies on a floor, lit in every way that needs no random numbers.
Scene lamp_scene() {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.flames.clear();
  SolidSurfaceSpec ball = shaped(SolidShape::sphere, 5e-3), floor = shaped(SolidShape::disc, 1);
  ball.position = {1, 0, 0};
  floor.position = {1, 0, -5e-3};
  scene.surfaces = {ball, floor};
  LightSpec light;
  light.position = {0.8, 0.2, 0.3};
  light.power = 1;
  scene.lights = {light};
  return scene;
}

/// The same lit by the sky, a hot ball and a flame, over two reflections.
Scene warm_scene() {
  Scene scene = lamp_scene();
  scene.flames = {small_flame()};
  scene.flames[0].position = {1.03, 0.002, -4e-3};
  SolidSurfaceSpec hot = shaped(SolidShape::sphere, 1e-3);
  hot.position = {0.99, 8e-3, 2e-3};
  hot.material.kind = MaterialKind::blackbody;
  hot.material.temperature = 1500;
  scene.surfaces.push_back(hot);
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 1000;
  scene.lights = {sky};
  scene.render.reflections = 2;
  return scene;
}

TEST(SurfaceErrors, SlopeOnAWallIsThatOfFlames) {
  // Nothing has an edge but the camera's own apertures, as with a flame that fills the window.
  Scene scene = lamp_scene();
  scene.surfaces[1].position = {1.05, 0, 0};
  scene.surfaces[1].rotation = {0, -1.5707963267948966, 0};
  scene.surfaces.erase(scene.surfaces.begin());
  Scene flame = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  flame.flames[0].layers = {{"all", {0, 0, 0.012}, {0.1, 0.1, 0.1}, 1800, 1}};
  const PixelWindow window{22, 22, 12, 12};
  EXPECT_LT(convergence_slope(compile(scene), window, 4096),
            convergence_slope(compile(flame), window, 4096) + 0.05);
}

TEST(SurfaceErrors, SlopeUnderALamp) {
  // Edges of bodies and shadows are jumps, where a flame's edge fades: N^-(1/2 + 1/(2 d)) for d = 4
  // dimensions is -0.625 for a single jump; -0.59 is measured. Independent numbers: -0.5.
  EXPECT_LT(convergence_slope(compile(lamp_scene()), {20, 20, 16, 16}, 4096), -0.55);
}

TEST(SurfaceErrors, SlopeOfIndirectLight) {
  // Eight random dimensions and more: no slower than independent numbers, -0.5 up to its noise.
  EXPECT_LT(convergence_slope(compile(warm_scene()), {27, 27, 5, 5}, 16384), -0.45);
}

TEST(SurfaceErrors, StatedBoundsHold) {
  for (const Scene& scene : {lamp_scene(), warm_scene()}) {
    RenderSettings settings;
    settings.samples = 32;
    settings.replicates = 4;
    settings.window = {21, 21, 13, 13};
    const CompiledScene compiled = compile(scene);
    const Coverage c = coverage(compiled, settings, Truth(compiled, settings, 2048));
    EXPECT_GE(c.below_bound, kLeastShare);
    // The errors of so few pixels are hardly known, and the bound says so; no more than it must.
    EXPECT_LT(c.median_of_bound, c.expected_median_of_bound + 3 * c.its_error);
    EXPECT_GT(c.median_of_estimate, 0.9);
    EXPECT_LT(c.median_of_estimate, 1.1);
  }
}

TEST(SurfaceErrors, StatedBoundsOfTheForwardEstimatorHold) {
  // A camera without array and a lamp that lights little but what it sees: many bundles a pixel.
  Scene scene = lamp_scene();
  scene.camera.array = {};
  scene.camera.focus.conjugate = "sensor";
  scene.camera.sensor = {16, 16, 0.7e-3};
  scene.lights[0].direction = {0.2, -0.2, -0.3};
  scene.lights[0].cone = 0.1;
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  settings.replicates = 4;
  settings.samples = 60000;
  const CompiledScene compiled = compile(scene);
  const Coverage c = coverage(compiled, settings, Truth(compiled, settings, 4096));
  EXPECT_GE(c.below_bound, kLeastShare);
  EXPECT_LT(c.median_of_bound, c.expected_median_of_bound + 3 * c.its_error);
}

}  // namespace
}  // namespace plenoflame::test::surface_errors_test
