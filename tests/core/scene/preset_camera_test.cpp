#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plenoflame/camera/camera.h"
#include "plenoflame/scene/presets.h"
#include "plenoflame/scene/scene_file.h"
#include "scene_samples.h"
#include "support/approx.h"

namespace plenoflame::preset_camera_test {
namespace {

Camera camera_of(const std::string& text) {
  return Camera(parse_scene(text, "").scene.camera);
}
Camera camera_of_preset(const std::string& name) {
  return camera_of("[camera]\npreset = \"" + name + "\"");
}

/// Diameter of a micro-image on the axis over the pitch: the exit pupil seen through the centre of
/// a microlens, by similar triangles.
double micro_image_share(const Camera& camera) {
  const Microlens& lens = camera.microlenses().front();
  const double to_pupil = camera.exit_pupil() - lens.front_principal;
  return lens.sensor_distance * camera.lens_first_order().exit_pupil_diameter / to_pupil /
         camera.spec().array.pitch;
}

TEST(PresetCameras, CanAllBeBuiltAndFocused) {
  for (const std::string& name : preset_names(PresetKind::camera)) {
    const CameraSpec spec = parse_scene("[camera]\npreset = \"" + name + "\"", "").scene.camera;
    std::vector<std::string> warnings;
    const Camera camera(spec, &warnings);
    EXPECT_TRUE(warnings.empty()) << name << ": " << warnings.front();
    EXPECT_LE(micro_image_share(camera), 1.0) << name << ": micro-images overlap";
  }
}

TEST(PresetCameras, MicroImagesAreAsLargeAsTheirTextsSay) {
  // Stopped down so that they just touch.
  EXPECT_GT(micro_image_share(camera_of_preset("raytrix-r29")), 0.98);
  EXPECT_GT(micro_image_share(camera_of_preset("raytrix-r29-reduced")), 0.95);
  EXPECT_GT(micro_image_share(camera_of_preset("r12")), 0.95);
  // The paper's stop of 100 mm is slower than its microlenses, more so in the earlier camera.
  EXPECT_LT(micro_image_share(camera_of_preset("paper-plenoptic2")), 0.65);
  EXPECT_LT(micro_image_share(camera_of_preset("paper-previous-60x60")), 0.6);
  // 427.2409 mm from the rear vertex, the image of 1 m (paraxial, computed independently), lies on
  // the array's front principal plane in the plenoptic 1.0 camera; the plane is 17.3077 um inside
  // the lens.
  EXPECT_TRUE(test::relative(camera_of_preset("paper-plenoptic1").lens_distance(),
                             427.2409e-3 - 17.3077e-6, 1e-6));
}

// The claims of examples/candle.toml about its three types: sharp planes from a0 = 1 / (1/f - 1/B),
// blur D B |1/a - 1/a0| for an object on the first type's plane (Perwass and Wietzke 2012).
TEST(PresetCameras, CandleTellsTheTypesApart) {
  const Camera camera = camera_of(test::source_text("examples/candle.toml"));
  EXPECT_GT(micro_image_share(camera), 0.98);
  EXPECT_LE(micro_image_share(camera), 1.0);
  const double a = camera.microlenses()[0].sharp_distance;
  EXPECT_TRUE(test::relative(a, 3.0e-3, 0.01));
  const double pixels[] = {0, 1.9, 4.0};
  for (std::size_t type = 1; type < 3; ++type) {
    const Microlens& lens = camera.microlenses()[type];
    const double blur = 1e-4 * lens.sensor_distance * (1 / lens.sharp_distance - 1 / a);
    EXPECT_TRUE(test::relative(blur / 1e-5, pixels[type], 0.05)) << type << ": " << blur;
  }
  EXPECT_EQ(camera.microlenses().size(), 3u);
}

TEST(PresetCameras, ExamplesCanBeBuilt) {
  for (const char* name :
       {"paper-flame-1m", "paper-flame-0.3m", "paper-previous-60x60", "candle", "lenslets-30"}) {
    std::vector<std::string> warnings;
    const Camera camera(
        parse_scene(test::source_text(std::string("examples/") + name + ".toml"), name)
            .scene.camera,
        &warnings);
    EXPECT_TRUE(warnings.empty()) << name << ": " << warnings.front();
    EXPECT_LE(micro_image_share(camera), 1.0) << name;
  }
  // The singlet's best focus lies in front of its paraxial one.
  const double best = camera_of(test::source_text("examples/paper-flame-1m.toml")).lens_distance();
  EXPECT_LT(best, camera_of_preset("paper-plenoptic2").lens_distance() - 5e-3);
}

}  // namespace
}  // namespace plenoflame::preset_camera_test
