// Views of a scene that is the same everywhere.
#include <gtest/gtest.h>

#include "core/lightfield/rendered.h"
#include "plenoflame/lightfield/views.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/uniform_medium.h"

namespace plenoflame::uniform_views_test {
namespace {

using test::relative;

// A scene of radiance 1 everywhere has views that are 1 to 1 % everywhere, at the default settings.
// The corner views look at pixels on the rim of the micro-images; with pixels as large as those of
// the camera of 60 x 60 microlenses these need many rays to be known to 0.2 %.
TEST(Views, UniformSceneGivesUniformViews) {
  struct Case {
    const char* name;
    PixelWindow window;
    int samples;
    double height = 1;  ///< of pixels, in widths
  };
  for (const Case& c : {Case{"raytrix-r29-reduced", {400, 300, 150, 150}, 1024},
                        Case{"paper-plenoptic2", {1700, 1300, 100, 100}, 1024},
                        Case{"raytrix-r29-reduced", {400, 300, 150, 150}, 1024, 1.5},
                        Case{"paper-previous-60x60", {300, 250, 70, 70}, 8192}}) {
    CameraSpec camera = test::preset_camera(c.name);
    if (c.height != 1) camera.sensor.pixel_pitch_y = c.height * camera.sensor.pixel_pitch;
    const CompiledScene scene = test::scene_of(camera, std::make_unique<test::UniformMedium>());
    const LightField field = test::rendered(scene, c.window, c.samples);
    const MicroImages micro(scene.camera, true, test::threads(2));
    const Views views = extract_views(field, micro, {}, test::threads(2));
    ASSERT_EQ(views.views.size(), 49U);
    for (const View& view : views.views) {
      const Image& image = view.image;
      ASSERT_GE(image.width, 4);
      // The window cuts the micro-images at its rim.
      for (int row = 2; row < image.height - 2; ++row)
        for (int column = 2; column < image.width - 2; ++column)
          EXPECT_TRUE(relative(static_cast<double>(image.at(column, row)), 1, 0.01))
              << c.name << " view " << view.column << ',' << view.row << " pixel " << column << ','
              << row;
    }
  }
}

}  // namespace
}  // namespace plenoflame::uniform_views_test
