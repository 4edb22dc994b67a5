#include "plenoflame/lightfield/geometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/uniform_medium.h"

namespace plenoflame::geometry_test {
namespace {

using test::relative;
using test::within;

constexpr double kFocal = 0.1, kGap = 1e-3, kPitch = 200e-6, kPixel = 10e-6;
const double kDistance = 1 / (1 / kFocal - 1 / 1.0);  ///< lens to array: 1 m is imaged there

/// Thin ideal lenses: similar triangles give everything.
CameraSpec thin_camera(Lattice lattice) {
  CameraSpec camera;
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = kFocal;
  camera.lens.diameter = 0.02;
  camera.array.present = true;
  camera.array.lattice = lattice;
  camera.array.model = LensModel::ideal;
  camera.array.pitch = camera.array.diameter = kPitch;
  camera.array.rotation = 0.02;
  camera.array.offset = {30e-6, -50e-6};
  MicrolensSpec lens;
  lens.name = "type1";
  lens.focal_length = kGap;
  camera.array.types = {lens};
  camera.array.sensor_distance = kGap;
  camera.sensor = {400, 300, kPixel};
  camera.focus.object_distance = 1;
  return camera;
}

TEST(MicroImageGrid, IsThatOfTheArraySeenUpright) {
  for (const Lattice lattice : {Lattice::square, Lattice::hexagonal}) {
    const CameraSpec spec = thin_camera(lattice);
    const Camera camera(spec);
    const MicroImages micro(camera, false, test::one_thread());
    const MicroImageGrid grid = fit_grid(micro, {0, 0, 400, 300});
    const double scale = 1 + kGap / kDistance;
    EXPECT_EQ(grid.hexagonal, lattice == Lattice::hexagonal);
    EXPECT_TRUE(relative(grid.pitch, kPitch / kPixel * scale, 1e-4));
    EXPECT_TRUE(within(grid.rotation, 0.02, 1e-4, 1));
    // Upright: camera x, y with both signs turned.
    EXPECT_TRUE(within(grid.origin.x, 200 - 3 * scale, 0.02, 1));
    EXPECT_TRUE(within(grid.origin.y, 150 + 5 * scale, 0.02, 1));
    EXPECT_LT(grid.worst, 0.05);
    EXPECT_TRUE(relative(grid.mean_radius, 0.01 * kGap / kDistance / kPixel, 5e-3));
    // Every lens of the array is the grid point with both indices turned.
    const Vec2 lens = camera.lattice().centre({4, -3});
    const Vec2 point = grid.point(-4, 3);
    EXPECT_TRUE(within(point.x, 200 - scale * lens.x / kPixel, 0.02, 1));
    EXPECT_TRUE(within(point.y, 150 - scale * lens.y / kPixel, 0.02, 1));
  }
}

TEST(ViewGeometry, PinholesOfAThinCamera) {
  const Camera camera(thin_camera(Lattice::hexagonal));
  const MicroImages micro(camera, false, test::one_thread());
  const double step = 180e-6;
  const ViewGeometry geometry = fit_view_geometry(micro, step);
  EXPECT_TRUE(within(geometry.plane, 0, 1e-4, 1));  // the lens is the stop
  EXPECT_TRUE(relative(geometry.focus, 1, 1e-3));
  EXPECT_TRUE(relative(geometry.focal, kDistance / step, 1e-3));
  EXPECT_TRUE(relative(geometry.centre_step, kDistance / kGap * kPixel, 1e-3));
  // Two viewpoints b apart see a point at z against one at 1 m at angles b (1/z - 1) apart.
  const double b = 3 * kDistance / kGap * kPixel;
  EXPECT_TRUE(relative(geometry.disparity(0.5, 3), kDistance / step * b * (1 / 0.5 - 1), 5e-3));
}

TEST(IsUnfocused, AsksForTheFocalPlane) {
  CameraSpec spec = thin_camera(Lattice::square);
  EXPECT_TRUE(is_unfocused(Camera(spec)));
  spec.array.sensor_distance = 0.8e-3;
  EXPECT_FALSE(is_unfocused(Camera(spec)));
}

// The picture that the renderer records of a scene of radiance 1, also where micro-images overlap,
// and in a window as in the whole picture.
TEST(WhiteImage, IsTheUniformScene) {
  CameraSpec spec = thin_camera(Lattice::hexagonal);
  spec.array.sensor_distance = 1.2e-3;
  const CompiledScene scene = test::scene_of(spec, std::make_unique<test::UniformMedium>());
  const PixelWindow window{150, 120, 60, 50};
  RenderSettings settings;
  settings.samples = 4096;
  settings.window = window;
  const LightField field = render(scene, settings, test::threads(2)).light_field;
  const MicroImages micro(scene.camera, true, test::threads(2));
  const Image white = white_image(micro, window, test::threads(2));
  double largest = 0, error = 0, energy = 0;
  for (const float value : white.pixels) largest = std::max(largest, static_cast<double>(value));
  for (int row = 0; row < window.height; ++row)
    for (int column = 0; column < window.width; ++column) {
      const auto expected = static_cast<double>(field.channels[0].flux.at(column, row));
      const auto actual = static_cast<double>(white.at(column, row));
      EXPECT_TRUE(within(actual, expected, 0.03, largest)) << column << ' ' << row;
      error += (actual - expected) * (actual - expected);
      energy += expected * expected;
    }
  EXPECT_LT(std::sqrt(error / energy), 0.01);
  EXPECT_EQ(white.pixels, white_image(micro, window, test::one_thread()).pixels);
}

TEST(MicroImageGrid, NeedsMicroImages) {
  const Camera camera(thin_camera(Lattice::square));
  const MicroImages micro(camera, false, test::one_thread());
  EXPECT_THROW(fit_grid(micro, {0, 0, 20, 20}), InputError);
}

}  // namespace
}  // namespace plenoflame::geometry_test
