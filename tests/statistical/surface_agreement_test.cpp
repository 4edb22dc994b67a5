// Both estimators on surfaces and lights: one follows rays from the camera, the other bundles from
// the lights. They share the surfaces (which have tests of their own) and no sampling.
#include "core/solids/surface_samples.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/scene_file.h"
#include "statistical/agreement.h"
#include "support/small_scene.h"
#include "support/source_folder.h"

namespace plenoflame::test::surface_agreement_test {
namespace {

SolidSurfaceSpec placed(SolidShape shape, double size, Vec3 position, double reflectivity) {
  SolidSurfaceSpec spec = shaped(shape, size);
  spec.position = position;
  spec.material.reflectivity = reflectivity;
  return spec;
}

LightSpec lamp() {
  LightSpec light;
  light.position = {0.7, 0.2, 0.25};
  light.direction = {0.3, -0.2, -0.25};
  light.cone = 0.08;  // wider than what the camera sees
  light.power = 0.01;
  return light;
}

Scene camera_of(const ArraySpec& array) {
  Scene scene = small_scene(singlet(), array);
  scene.flames.clear();
  return scene;
}

// Direct light with shadows on all analytic shapes.
TEST(SurfaceAgreement, PointLightOnBodies) {
  Scene scene = camera_of(large_array(Lattice::hexagonal, LensModel::real));
  scene.surfaces = {placed(SolidShape::sphere, 4e-3, {0.99, 6e-3, 0}, 0.8),
                    placed(SolidShape::cone, 4e-3, {1, -5e-3, -6e-3}, 0.9),
                    placed(SolidShape::cylinder, 2e-3, {1, 1e-3, -6e-3}, 0.7),
                    placed(SolidShape::box, 4e-3, {1.02, -4e-3, 2e-3}, 0.6),
                    placed(SolidShape::plane, 1, {1, 0, -6e-3}, 0.5)};
  scene.surfaces.back().extent = {0.1, 0.1};
  scene.lights = {lamp()};
  expect_agreement(scene);
}

// Sun, surroundings (which the camera sees, too), a lamp-like emitter, three reflections.
TEST(SurfaceAgreement, ManyLightsAndReflections) {
  Scene scene = camera_of(large_array(Lattice::square, LensModel::real));
  scene.surfaces = {placed(SolidShape::sphere, 4e-3, {0.99, 4e-3, 0}, 0.9),
                    placed(SolidShape::disc, 8e-3, {1, -2e-3, 1e-2}, 0),
                    placed(SolidShape::plane, 1, {1, 0, -5e-3}, 0.8)};
  scene.surfaces[1].rotation = {3.0, 0, 0};  // looks down
  scene.surfaces[1].material.kind = MaterialKind::emitter;
  scene.surfaces[1].material.radiance = 200;
  scene.surfaces[2].extent = {0.04, 0.03};
  LightSpec sun;
  sun.kind = LightKind::parallel;
  sun.direction = {0.3, -0.5, -0.8};
  sun.irradiance = 300;
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 30;
  scene.lights = {sun, sky};
  scene.render.reflections = 3;
  expect_agreement(scene, load_core_medium, 5 * kBundles);
}

// A floor without end under sun and sky, with a ball on it; then a wall without end that shines.
TEST(SurfaceAgreement, PlanesWithoutEnd) {
  Scene scene = camera_of(large_array(Lattice::square, LensModel::real));
  scene.camera.position = {0, 0, 0.15};
  scene.camera.look_direction = {1, 0, -0.155};
  scene.surfaces = {placed(SolidShape::plane, 1, {0, 0, -5e-3}, 0.8),
                    placed(SolidShape::sphere, 4e-3, {1, 2e-3, -1e-3}, 0.6)};
  scene.surfaces[0].extent = {kInfinity, kInfinity};
  LightSpec sun;
  sun.kind = LightKind::parallel;
  sun.direction = {0.3, -0.5, -0.8};
  sun.irradiance = 300;
  scene.lights = {sun};
  expect_agreement(scene, load_core_medium, 2 * kBundles);
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 60;
  scene.lights = {sky};
  expect_agreement(scene, load_core_medium, 5 * kBundles);
  SolidSurfaceSpec wall = placed(SolidShape::plane, 1, {1.03, 0, 0}, 0);
  wall.extent = {kInfinity, kInfinity};
  wall.rotation = {0, -1.5707963267948966, 0};
  wall.material.kind = MaterialKind::emitter;
  wall.material.radiance = 40;
  Scene glow = scene;
  glow.lights.clear();
  glow.surfaces = {wall, scene.surfaces[1]};
  glow.render.reflections = 0;
  expect_agreement(glow, load_core_medium, kBundles);
  // The wall shines on the ball as well.
  glow.render.reflections = 1;
  expect_agreement(glow, load_core_medium, 2 * kBundles);
}

// Light that planes without end send to other surfaces, and to each other in a corner of the room:
// it may start anywhere on them.
TEST(SurfaceAgreement, LightFromFarOnPlanesWithoutEnd) {
  Scene scene = camera_of(large_array(Lattice::square, LensModel::real));
  scene.camera.position = {0, 0, 0.15};
  scene.camera.look_direction = {1, 0, -0.155};
  scene.surfaces = {placed(SolidShape::plane, 1, {0, 0, -5e-3}, 0.8),
                    placed(SolidShape::sphere, 4e-3, {1, 2e-3, -1e-3}, 0.6)};
  scene.surfaces[0].extent = {kInfinity, kInfinity};
  scene.render.reflections = 3;
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 60;
  scene.lights = {sky};
  expect_agreement(scene, load_core_medium, 5 * kBundles);
  SolidSurfaceSpec wall = placed(SolidShape::plane, 1, {1.01, 0, 0}, 0.7);
  wall.extent = {kInfinity, kInfinity};
  wall.rotation = {0, -1.5707963267948966, 0};
  scene.surfaces.push_back(wall);
  LightSpec sun;
  sun.kind = LightKind::parallel;
  sun.direction = {0.3, -0.5, -0.8};
  sun.irradiance = 300;
  scene.lights = {sun};
  scene.render.reflections = 2;
  expect_agreement(scene, load_core_medium, 5 * kBundles);
}

// Emitters large and small, near and far, with and without a flame.
TEST(SurfaceAgreement, HotSurfaces) {
  Scene scene = small_scene(singlet(), large_array(Lattice::square, LensModel::real));
  scene.surfaces = {placed(SolidShape::plane, 1, {1, 0, -13e-3}, 0.9),
                    placed(SolidShape::sphere, 0.5e-3, {0.99, 5e-3, -8e-3}, 0),
                    placed(SolidShape::cylinder, 2e-3, {1, -5e-3, -13e-3}, 0)};
  scene.surfaces[0].extent = {0.05, 0.05};
  for (const std::size_t i : {1u, 2u}) {
    scene.surfaces[i].material.kind = MaterialKind::blackbody;
    scene.surfaces[i].material.temperature = i == 1 ? 2200 : 900;
  }
  scene.render.reflections = 2;
  expect_agreement(scene, load_core_medium, 3 * kBundles);
}

// A flame that lights what stands around it, hides and is hidden: in front of it, in it, behind it.
Scene flame_and_objects() {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.surfaces = {placed(SolidShape::cylinder, 1.5e-3, {1, 1e-3, -14e-3}, 0.9),
                    placed(SolidShape::sphere, 2e-3, {0.985, 4e-3, 2e-3}, 0.7),
                    placed(SolidShape::plane, 1, {1.02, 0, 0}, 0.6)};
  scene.surfaces[0].height = 8e-3;  // into the flame
  scene.surfaces[0].caps = false;
  scene.surfaces[2].extent = {0.06, 0.06};
  scene.surfaces[2].rotation = {0, -1.5707963267948966, 0};
  scene.lights = {lamp()};
  scene.lights[0].power = 20;
  scene.render.reflections = 2;
  return scene;
}

TEST(SurfaceAgreement, FlameAndObjects) {
  expect_agreement(flame_and_objects(), load_core_medium, 3 * kBundles);
}

// Soot, which dims what is behind it and what it lights more in the blue.
TEST(SurfaceAgreement, SootAndObjects) {
  Scene scene = flame_and_objects();
  scene.flames[0].spectrum.kind = SpectrumKind::power;
  scene.flames[0].spectrum.exponent = 2;
  scene.channels = {{"red", ChannelKind::band, 650e-9, 20e-9},
                    {"blue", ChannelKind::band, 450e-9, 120e-9}};
  scene.lights[0].power = 1e-3;
  expect_agreement(scene, load_core_medium, 3 * kBundles);
}

// Through a closed object nothing is seen of the flame inside of it, from either side.
TEST(SurfaceAgreement, FlameBehindAWallIsHidden) {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.surfaces = {placed(SolidShape::box, 0.04, {1, 0, -0.014}, 0.5)};
  const CompiledScene compiled = compile(scene);
  RenderSettings settings;
  settings.samples = 8;
  EXPECT_EQ(render(compiled, settings).statistics.flux, 0);
  settings.estimator = Estimator::forward;
  settings.samples = 20000;
  EXPECT_EQ(render(compiled, settings).statistics.flux, 0);
}

/// An example, on a sensor as large as its own but of `pixels` coarse pixels across.
Scene coarse_example(const std::string& name, int pixels) {
  Scene scene = read_scene_file(PLENOFLAME_SOURCE_DIR "/examples/" + name + ".toml").scene;
  SensorSpec& sensor = scene.camera.sensor;
  const double width = sensor.columns * sensor.pixel_pitch;
  sensor.rows = std::max(1, pixels * sensor.rows / sensor.columns);
  sensor.columns = pixels;
  sensor.pixel_pitch = width / pixels;
  return scene;
}

// Every example with surfaces. Lamps light hardly more than what the camera sees: fewer bundles are
// lost.
TEST(SurfaceAgreement, PaperObjects) {
  for (const char* name :
       {"paper-objects-5m", "paper-objects-5m-60x60", "paper-objects-5m-no-array"}) {
    SCOPED_TRACE(name);
    Scene scene = coarse_example(name, 60);
    scene.lights[0].cone = 0.08;
    expect_agreement(scene, load_core_medium, 2 * kBundles);
  }
}

TEST(SurfaceAgreement, PaperObjectsR29) {
  Scene scene = coarse_example("paper-objects-r29", 60);
  scene.lights[0].cone = 0.06;
  expect_agreement(scene, load_core_medium, 5 * kBundles);
}

TEST(SurfaceAgreement, CalibrationPlate) {
  expect_agreement(coarse_example("calibration-plate", 60), load_core_medium, 2 * kBundles);
}

// The candle of the example is a file that is generated; two ellipsoids of its size stand here.
TEST(SurfaceAgreement, Burner) {
  Scene scene = coarse_example("burner", 60);
  const FlameSpec candle = scene.flames[0];
  scene.flames[0] = small_flame();
  scene.flames[0].position = candle.position;
  scene.flames[0].layers = {{"mantle", {0, 0, 15e-3}, {5e-3, 5e-3, 16e-3}, 1850, 5},
                            {"core", {0, 0, 12e-3}, {2e-3, 2e-3, 10e-3}, 1500, 20}};
  expect_agreement(scene, load_core_medium, 3 * kBundles);
}

}  // namespace
}  // namespace plenoflame::test::surface_agreement_test
