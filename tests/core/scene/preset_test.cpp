#include "plenoflame/scene/presets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/validate.h"
#include "scene_samples.h"
#include "support/approx.h"
#include "support/source_folder.h"

namespace plenoflame::preset_test {
namespace {

CameraSpec camera(const std::string& name) {
  return parse_scene("[camera]\npreset = \"" + name + "\"", name).scene.camera;
}

/// Focal length of a thick lens in air, closed form; radii positive when convex [m].
double thick_lens(double n, double front, double back, double t) {
  const double curvature = 1 / front + 1 / back;
  const double both = std::isinf(front) || std::isinf(back) ? 0 : t / (n * front * back);
  return 1 / ((n - 1) * (curvature - (n - 1) * both));
}

TEST(Presets, AllAreSoundAndDescribed) {
  EXPECT_EQ(
      preset_names(PresetKind::camera),
      (std::vector<std::string>{"paper-plenoptic1", "paper-plenoptic2", "paper-previous-60x60",
                                "r12", "raytrix-r29", "raytrix-r29-reduced"}));
  EXPECT_EQ(preset_names(PresetKind::flame), std::vector<std::string>{"paper-layered"});
  for (const std::string& name : preset_names(PresetKind::camera)) {
    const SceneDocument document = parse_scene("[camera]\npreset = \"" + name +
                                                   "\"\n[[flames]]\npreset = \"paper-layered\"\n"
                                                   "position = [\"2 m\", \"0 m\", \"0 m\"]",
                                               name);
    EXPECT_TRUE(validate(document).empty()) << name << ": " << validate(document)[0].message;
    EXPECT_TRUE(preset_description(PresetKind::camera, name).ends_with(".")) << name;
    EXPECT_NE(preset_text(PresetKind::camera, name).find("CHOSEN"), std::string_view::npos) << name;
    EXPECT_EQ(preset_text(PresetKind::camera, name),
              test::source_text("core/presets/cameras/" + name + ".toml"));
  }
  EXPECT_NE(preset_text(PresetKind::flame, "paper-layered").find("NOT those of Table 4"),
            std::string_view::npos);
}

TEST(Presets, PaperPlenoptic2IsThePapersCamera) {
  const CameraSpec spec = camera("paper-plenoptic2");
  const auto& s = spec.lens.surfaces;
  ASSERT_EQ(s.size(), 3u);
  // The paper's focal length of 304.0987 mm; exactly 304.09863... for n = 1.5.
  EXPECT_TRUE(test::relative(thick_lens(s[0].index, s[0].radius, -s[1].radius, s[0].thickness),
                             304.0987e-3, 1e-6));
  EXPECT_EQ(s[2].diameter, 0.1);
  EXPECT_TRUE(s[2].stop);
  EXPECT_EQ(spec.sensor, (SensorSpec{3000, 3000, 1e-5}));
  EXPECT_EQ(spec.array.lattice, Lattice::hexagonal);
  EXPECT_EQ(spec.array.pitch, 1e-4);
  EXPECT_EQ(spec.array.sensor_distance, 0.2534e-3);
  ASSERT_EQ(spec.array.types.size(), 3u);
  const double focal_lengths[] = {0.23365e-3, 0.19888e-3, 0.17079e-3};
  for (int i = 0; i < 3; ++i) {
    const MicrolensSpec& type = spec.array.types[static_cast<std::size_t>(i)];
    EXPECT_TRUE(test::relative(
        thick_lens(type.index, type.radius_front, type.radius_back, spec.array.thickness),
        focal_lengths[i], 3e-5));
  }
}

TEST(Presets, TheOthersHaveTheirNumbers) {
  const CameraSpec one = camera("paper-plenoptic1");
  EXPECT_EQ(one.array.lattice, Lattice::square);
  ASSERT_EQ(one.array.types.size(), 1u);
  EXPECT_EQ(one.lens, camera("paper-plenoptic2").lens);
  // Plenoptic 1.0: the sensor in the focal plane.
  EXPECT_TRUE(test::relative(one.array.sensor_distance,
                             thick_lens(1.5, 0.225e-3, 0.225e-3, 0.05e-3), 1e-8));

  const CameraSpec previous = camera("paper-previous-60x60");
  EXPECT_EQ(previous.array.lattice, Lattice::square);
  EXPECT_TRUE(test::relative(previous.sensor.columns * previous.sensor.pixel_pitch,
                             60 * previous.array.pitch, 1e-15));
  EXPECT_TRUE(test::relative(previous.array.sensor_distance,
                             thick_lens(1.5, 2.25e-3, 2.25e-3, 0.5e-3), 1e-8));

  const CameraSpec r29 = camera("raytrix-r29");
  EXPECT_EQ(r29.sensor, (SensorSpec{6576, 4384, 5.5e-6}));
  ASSERT_EQ(r29.array.types.size(), 3u);
  for (std::size_t k = 0; k + 1 < 3; ++k) {
    // Depth ranges follow each other: 1/f[k+1] - 1/f[k] = 2 p / (D B), Perwass and Wietzke 2012.
    const auto f = [&](std::size_t i) {
      return thick_lens(1.5, kInfinity, r29.array.types[i].radius_back, 0);
    };
    EXPECT_TRUE(test::relative(1 / f(k + 1) - 1 / f(k),
                               2 * 5.5e-6 / (r29.array.diameter * r29.array.sensor_distance),
                               1e-9));
    EXPECT_GT(f(k), r29.array.sensor_distance);  // Galilean
  }

  const CameraSpec reduced = camera("raytrix-r29-reduced");
  EXPECT_EQ(reduced.sensor, (SensorSpec{3780, 2550, 5.5e-6}));
  EXPECT_TRUE(test::relative(reduced.array.pitch / reduced.sensor.pixel_pitch, 30, 1e-14));

  const CameraSpec r12 = camera("r12");
  EXPECT_EQ(r12.sensor, (SensorSpec{4080, 3068, 5.5e-6}));
  EXPECT_TRUE(test::relative(4080 * 5.5e-6 / r12.array.pitch, 176, 1e-3));
  EXPECT_TRUE(test::relative(3068 * 5.5e-6 / (r12.array.pitch * std::sqrt(0.75)), 152, 1e-2));
}

TEST(Presets, PaperLayeredIsNestedOnTheAxis) {
  const auto layers =
      parse_scene("[[flames]]\npreset = \"paper-layered\"", "").scene.flames.at(0).layers;
  ASSERT_EQ(layers.size(), 3u);
  const double ends[][2] = {{2e-3, 26e-3}, {0, 44e-3}, {-1e-3, 59e-3}};
  const double temperatures[] = {1200, 1650, 1900}, absorptions[] = {1, 30, 1.5};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(test::within(layers[i].centre.z - layers[i].semi_axes.z, ends[i][0], 1e-15, 0.06));
    EXPECT_TRUE(test::within(layers[i].centre.z + layers[i].semi_axes.z, ends[i][1], 1e-15, 0.06));
    EXPECT_EQ(layers[i].temperature, temperatures[i]);
    EXPECT_EQ(layers[i].absorption, absorptions[i]);
  }
}

TEST(Examples, AreSoundScenesWithTheWarningsTheyAnnounce) {
  const struct {
    const char* name;
    std::size_t warnings;
  } examples[] = {{"paper-flame-1m", 0},
                  {"paper-flame-0.3m", 1},
                  {"paper-previous-60x60", 0},
                  {"candle", 0},
                  {"lenslets-30", 0}};
  for (const auto& example : examples) {
    const SceneDocument document =
        read_scene_file(std::string(PLENOFLAME_SOURCE_DIR "/examples/") + example.name + ".toml");
    EXPECT_EQ(validate(document).size(), example.warnings) << example.name;
  }
}

}  // namespace
}  // namespace plenoflame::preset_test
