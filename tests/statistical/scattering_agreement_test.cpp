// Both estimators in media that scatter. One walks from the camera and weighs what is absorbed, the
// other follows bundles from the light on until they are absorbed; they share the phase functions,
// which have tests of their own, and no sampling.
#include "core/solids/surface_samples.h"
#include "statistical/agreement.h"
#include "support/small_scene.h"

namespace plenoflame::test::scattering_agreement_test {
namespace {

ScatteringSpec henyey_greenstein(double albedo, double g) {
  return {albedo, PhaseFunction::henyey_greenstein, g};
}

// A flame alone: nothing lights it but itself.
TEST(ScatteringAgreement, AFlameThatScatters) {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.flames[0].scattering = henyey_greenstein(0.6, 0.5);
  expect_agreement(scene);
  scene.flames[0].scattering = {0.8, PhaseFunction::rayleigh, 0};
  expect_agreement(scene);
}

/// A cloud of cold smoke beside a flame, which lights it.
Scene flame_and_smoke() {
  Scene scene = small_scene(singlet(), large_array(Lattice::square, LensModel::real));
  FlameSpec smoke = small_flame();
  smoke.name = "smoke";
  smoke.layers = {{"smoke", {0, 0, 0}, {0.008, 0.006, 0.008}, 300, 20}};
  smoke.position = {1.004, -0.009, 0.002};
  smoke.scattering = henyey_greenstein(0.8, 0.6);
  scene.flames.push_back(smoke);
  return scene;
}

TEST(ScatteringAgreement, SmokeThatAFlameLights) {
  expect_agreement(flame_and_smoke(), load_core_medium, 2 * kBundles);
}

// A lamp behind smoke so thick that hardly any light comes through it with a single turn.
TEST(ScatteringAgreement, ThickSmoke) {
  Scene scene = flame_and_smoke();
  scene.flames.erase(scene.flames.begin());
  scene.flames[0].position = {1, 0, 0};
  scene.flames[0].scattering = henyey_greenstein(0.97, 0.6);
  scene.flames[0].layers[0].absorption = 9;  // an optical thickness of 5
  LightSpec behind;
  behind.position = {1.2, 0.05, 0};
  behind.direction = {-0.2, -0.05, 0};
  behind.cone = 0.2;
  behind.power = 20;
  scene.lights = {behind};
  expect_agreement(scene, load_core_medium, 2 * kBundles);
}

LightSpec lamp() {
  LightSpec light;
  light.position = {0.7, 0.2, 0.25};
  light.direction = {0.3, -0.2, -0.25};
  light.cone = 0.1;
  light.power = 20;
  return light;
}

// A wall behind smoke and flame, a hot ball and a cold one in them, a lamp, sun and sky.
Scene everything() {
  Scene scene = flame_and_smoke();
  scene.flames[0].scattering = {0.5, PhaseFunction::rayleigh, 0};
  SolidSurfaceSpec wall = shaped(SolidShape::plane, 1), hot = shaped(SolidShape::sphere, 1.5e-3),
                   cold = shaped(SolidShape::sphere, 2e-3);
  wall.position = {1.02, 0, 0};
  wall.extent = {0.06, 0.06};
  wall.rotation = {0, -1.5707963267948966, 0};
  wall.material.reflectivity = 0.7;
  hot.position = {0.995, -7e-3, 8e-3};
  hot.material.kind = MaterialKind::blackbody;
  hot.material.temperature = 1900;
  cold.position = {0.985, 4e-3, 2e-3};
  cold.material.reflectivity = 0.8;
  scene.surfaces = {wall, hot, cold};
  LightSpec sun, sky;
  sun.kind = LightKind::parallel;
  sun.direction = {0.3, -0.5, -0.8};
  sun.irradiance = 3000;
  sky.kind = LightKind::environment;
  sky.radiance = 300;
  scene.lights = {lamp(), sun, sky};
  scene.render.reflections = 2;
  return scene;
}

TEST(ScatteringAgreement, SurfacesLightsAndSmoke) {
  expect_agreement(everything(), load_core_medium, 4 * kBundles);
}

// The flame lights the smoke, but no surface, not even through the smoke.
TEST(ScatteringAgreement, FlamesThatDoNotLightSurfaces) {
  Scene scene = everything();
  scene.render.flame_light = false;
  scene.lights = {lamp()};
  scene.lights[0].power = 2;
  expect_agreement(scene, load_core_medium, 4 * kBundles);
}

// Surfaces that reflect nothing still hide and glow, and smoke still scatters.
TEST(ScatteringAgreement, WithoutReflections) {
  Scene scene = everything();
  scene.render.reflections = 0;
  scene.lights = {lamp()};
  expect_agreement(scene, load_core_medium, 2 * kBundles);
}

// Soot and smoke, each with a spectrum of its own.
TEST(ScatteringAgreement, ColouredSmoke) {
  Scene scene = everything();
  for (FlameSpec& flame : scene.flames) flame.spectrum.kind = SpectrumKind::power;
  scene.flames[0].spectrum.exponent = 1.3;
  scene.flames[1].spectrum.exponent = 3;
  scene.channels = {{"red", ChannelKind::band, 650e-9, 20e-9},
                    {"blue", ChannelKind::band, 450e-9, 120e-9}};
  scene.lights = {lamp()};
  scene.lights[0].power = 1e-3;
  expect_agreement(scene, load_core_medium, 4 * kBundles);
}

// Nodes of which none is like the others, so that no bundle or walk of one node finds the light of
// another; one of them passes through the flame as if it were not there.
TEST(ScatteringAgreement, SmokeOfFarApartExtinctions) {
  Scene scene = flame_and_smoke();
  scene.flames[1].position = {1.004, -0.018, 0.002};  // apart: what overlaps is slow
  const char* const tables[] = {"450 nm 3, 550 nm 1, 650 nm 0", "450 nm 4, 550 nm 1, 650 nm 0.1"};
  for (std::size_t i = 0; i < 2; ++i) {
    scene.flames[i].spectrum.kind = SpectrumKind::table;
    scene.flames[i].spectrum.table = tables[i];
    scene.flames[i].spectrum.reference = 550e-9;
  }
  scene.flames[0].scattering = {0.5, PhaseFunction::rayleigh, 0};
  scene.channels = {{"red", ChannelKind::band, 650e-9, 5e-9},
                    {"green", ChannelKind::band, 550e-9, 5e-9},
                    {"blue", ChannelKind::band, 450e-9, 5e-9}};
  scene.lights = {lamp()};
  scene.lights[0].power = 1e-4;
  expect_agreement(scene);
}

// A floor without end under smoke and a sky.
TEST(ScatteringAgreement, SmokeOverAFloorWithoutEnd) {
  Scene scene = flame_and_smoke();
  SolidSurfaceSpec floor = shaped(SolidShape::plane, 1);
  floor.position = {0, 0, -13e-3};
  floor.extent = {kInfinity, kInfinity};
  floor.material.reflectivity = 0.8;
  scene.camera.position = {0, 0, 0.15};
  scene.camera.look_direction = {1, 0, -0.155};
  scene.surfaces = {floor};
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 3000;
  scene.lights = {sky};
  scene.render.reflections = 2;
  expect_agreement(scene, load_core_medium, 5 * kBundles);
}

}  // namespace
}  // namespace plenoflame::test::scattering_agreement_test
