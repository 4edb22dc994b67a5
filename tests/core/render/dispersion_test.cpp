// Glasses whose index depends on wavelength: each wavelength has rays of its own.
#include <algorithm>
#include <cmath>

#include "plenoflame/optics/glass.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"

namespace plenoflame::dispersion_test {
namespace {

using test::relative;

Scene glass_scene() {
  Scene scene =
      test::small_scene(test::singlet(), test::large_array(Lattice::square, LensModel::real));
  scene.camera.lens.surfaces[0].glass = "N-SF11";
  scene.camera.array.types[0].glass = "N-BK7";
  scene.channels = {{"red", ChannelKind::band, 700e-9, 10e-9},
                    {"blue", ChannelKind::band, 450e-9, 10e-9}};
  return scene;
}

RenderSettings few() {
  RenderSettings settings;
  settings.samples = 8;
  return settings;
}

// The picture of each channel is that of a camera with constant indices in the same place.
TEST(Dispersion, EachWavelengthHasItsRays) {
  const Scene scene = glass_scene();
  const CompiledScene compiled = compile(scene);
  ASSERT_EQ(compiled.paths().size(), 2u);
  const LightField field = render(compiled, few(), test::one_thread()).light_field;
  for (std::size_t c = 0; c < 2; ++c) {
    Scene alone = scene;
    alone.channels = {scene.channels[c]};
    const double wavelength = scene.channels[c].wavelength;
    alone.camera.lens.surfaces[0].glass.clear();
    alone.camera.lens.surfaces[0].index = Glass("N-SF11").index(wavelength);
    alone.camera.array.types[0].glass.clear();
    alone.camera.array.types[0].index = Glass("N-BK7").index(wavelength);
    alone.camera.focus.mode = FocusMode::distance;
    alone.camera.focus.lens_distance = compiled.camera.lens_distance();
    alone.camera.array.measured_from = ArrayReference::vertex;
    alone.camera.array.sensor_distance = compiled.camera.array_back() - compiled.camera.sensor();
    const CompiledScene constant = compile(alone);
    EXPECT_EQ(constant.paths().size(), 1u);
    const LightField expected = render(constant, few(), test::one_thread()).light_field;
    double sum = 0, difference = 0;
    for (std::size_t i = 0; i < expected.channels[0].flux.pixels.size(); ++i) {
      const double e = static_cast<double>(expected.channels[0].flux.pixels[i]);
      sum += e;
      difference += std::fabs(static_cast<double>(field.channels[c].flux.pixels[i]) - e);
    }
    EXPECT_GT(sum, 0);
    EXPECT_LT(difference, 1e-4 * sum) << c;
  }
}

// Pupils are those of the indices that rays are traced with, whichever wavelength the camera was
// solved at: that of the first channel that has one, not of the first part.
TEST(Dispersion, EachWavelengthHasItsPupils) {
  for (const bool wide : {false, true}) {
    Scene scene = glass_scene();
    if (wide) {
      scene.channels = {{"wide", ChannelKind::band, 550e-9, 250e-9}};
      scene.channels[0].wavelengths = 3;
    } else {
      scene.channels.push_back({"green", ChannelKind::band, 550e-9, 10e-9});
    }
    const CompiledScene compiled = compile(scene);
    ASSERT_GE(compiled.paths().size(), 3u);
    double smallest = 1e300, largest = 0;
    for (const CompiledScene& part : compiled.paths()) {
      const PupilSampling own(part.camera);
      const PupilTable& table = part.pupils.tables().front();
      const PupilTable& expected = own.tables().front();
      ASSERT_EQ(table.nodes.size(), expected.nodes.size());
      for (std::size_t i = 0; i < table.nodes.size(); ++i) {
        EXPECT_EQ(table.nodes[i].centre, expected.nodes[i].centre);
        EXPECT_EQ(table.nodes[i].outer_radius, expected.nodes[i].outer_radius);
        EXPECT_EQ(table.nodes[i].opened, expected.nodes[i].opened);
      }
      smallest = std::min(smallest, expected.nodes.front().outer_radius);
      largest = std::max(largest, expected.nodes.front().outer_radius);
    }
    EXPECT_GT(largest, 1.002 * smallest) << "the pupils hardly differ";
  }
}

TEST(Dispersion, ConstantIndicesShareOnePath) {
  Scene scene = glass_scene();
  EXPECT_TRUE(is_dispersive(scene));
  scene.camera.lens.surfaces[0].glass = "constant 1.7";
  scene.camera.array.types[0].glass.clear();
  EXPECT_FALSE(is_dispersive(scene));
  EXPECT_EQ(compile(scene).paths().size(), 1u);
  // Nor does one colour disperse.
  scene = glass_scene();
  scene.channels.pop_back();
  EXPECT_FALSE(is_dispersive(scene));
  scene.channels[0].wavelengths = 3;
  EXPECT_TRUE(is_dispersive(scene));
  EXPECT_EQ(compile(scene).paths().size(), 3u);
}

// A white light: as much of it in three wavelengths as in one.
TEST(Dispersion, WavelengthsOfAChannelShareItsLight) {
  Scene scene = glass_scene();
  scene.channels = {{"wide", ChannelKind::band, 550e-9, 200e-9}};
  scene.camera.lens.surfaces[0].glass = "abbe 1.5 2000";  // hardly disperses
  scene.camera.array.types[0].glass.clear();
  const double one = render(compile(scene), few(), test::one_thread()).statistics.flux;
  scene.channels[0].wavelengths = 3;
  const CompiledScene three = compile(scene);
  ASSERT_EQ(three.paths().size(), 3u);
  EXPECT_TRUE(relative(render(three, few(), test::one_thread()).statistics.flux, one, 2e-3));
}

}  // namespace
}  // namespace plenoflame::dispersion_test
