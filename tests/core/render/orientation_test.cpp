// Which way up and which way round a picture is, and how large.
#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"

namespace plenoflame::test::orientation_test {
namespace {

struct Centroid {
  double column = 0, row = 0, flux = 0;
};
Centroid centroid(const Image& image) {
  Centroid c;
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) {
      const double f = static_cast<double>(image.at(column, row));
      c.flux += f;
      c.column += f * (column + 0.5);
      c.row += f * (row + 0.5);
    }
  c.column /= c.flux;
  c.row /= c.flux;
  return c;
}

/// A hot ball of 1 mm at a world position.
void put_ball(Scene& scene, Vec3 position) {
  FlameSpec& flame = scene.flames[0];
  flame.position = position;
  flame.layers = {{"ball", {}, {1e-3, 1e-3, 1e-3}, 1800, 100}};
}

Image picture(const Scene& scene) {
  RenderSettings settings;
  settings.samples = 16;
  return render(compile(scene), settings, one_thread()).light_field.channels[0].flux;
}

TEST(Orientation, RightIsALargerColumnAndUpASmallerRow) {
  // From the origin along +x: right is -y, up is +z. Magnification of the singlet at 1 m: 0.43190.
  for (const bool array : {false, true}) {
    Scene scene = array ? paper_flame(400, 300) : bare_flame(400, 300, 1e-4);
    scene.camera.sensor.pixel_pitch = 1e-4;
    if (array) scene.camera.lens.model = LensModel::ideal;
    put_ball(scene, {1, -0.008, 0.012});
    const Centroid c = centroid(picture(scene));
    EXPECT_TRUE(within(c.column, 200 + 80 * 0.43190, 0.25, array ? 4 : 1));
    EXPECT_TRUE(within(c.row, 150 - 120 * 0.43190, 0.25, array ? 4 : 1));
  }
}

TEST(Orientation, CameraAnywhereInTheWorld) {
  // The camera at (2, 3, 4) looking along -y, world x up: right is +z... by the right hand: looking
  // direction x up = (-y) x (+x) = +z.
  Scene scene = bare_flame(400, 300, 1e-4);
  scene.camera.position = {2, 3, 4};
  scene.camera.look_direction = {0, -2, 0};
  scene.camera.up = {1, 0.3, 0};
  put_ball(scene, {2 + 0.012, 3 - 1.0, 4 + 0.008});
  const Centroid c = centroid(picture(scene));
  EXPECT_TRUE(within(c.column, 200 + 80 * 0.43190, 0.25, 1));
  EXPECT_TRUE(within(c.row, 150 - 120 * 0.43190, 0.25, 1));
}

}  // namespace
}  // namespace plenoflame::test::orientation_test
