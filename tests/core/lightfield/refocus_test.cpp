#include "plenoflame/lightfield/refocus.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/lightfield/rendered.h"
#include "plenoflame/base/error.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"
#include "support/isas.h"
#include "support/small_scene.h"
#include "support/uniform_medium.h"

namespace plenoflame::refocus_test {
namespace {

using test::relative;

/// A small bright cube at z = `depth` in front of the camera, beside the axis.
CompiledScene cube_scene(const CameraSpec& camera, double depth, Vec2 at, double half) {
  // The presets' cameras stand at the origin and look along +x: camera x is world -y, camera y is
  // -z.
  const Vec3 middle{depth, -at.x, -at.y};
  const Vec3 size{half, half, half};
  return test::scene_of(camera,
                        std::make_unique<test::UniformMedium>(Box{middle - size, middle + size}));
}

struct Spot {
  Vec2 centre;        ///< [m]
  double spread = 0;  ///< [m] RMS radius
  double peak = 0;
};

Spot spot_of(const RefocusedImage& picture) {
  Spot spot;
  double total = 0, square = 0;
  for (int row = 0; row < picture.image.height; ++row)
    for (int column = 0; column < picture.image.width; ++column) {
      const double value = static_cast<double>(picture.image.at(column, row));
      const Vec2 at = picture.corner + picture.pixel * Vec2{column + 0.5, row + 0.5};
      total += value;
      spot.centre = spot.centre + value * at;
      square += value * dot(at, at);
      spot.peak = std::max(spot.peak, value);
    }
  spot.centre = (1 / total) * spot.centre;
  spot.spread = std::sqrt(std::max(0.0, square / total - dot(spot.centre, spot.centre)));
  return spot;
}

// A point source is sharpest at its depth, and in its place there.
TEST(Refocus, FindsTheDepthAndPlaceOfACube) {
  struct Case {
    const char* name;
    double depth;
    Vec2 at;
    double half;
  };
  for (const Case& c : {Case{"paper-previous-60x60", 0.9, {0.004, -0.007}, 1e-3},
                        Case{"raytrix-r29-reduced", 1.4, {-0.003, 0.002}, 0.4e-3}}) {
    const CameraSpec spec = test::preset_camera(c.name);
    const CompiledScene scene = cube_scene(spec, c.depth, c.at, c.half);
    const SensorSpec& sensor = spec.sensor;
    const int side = std::min({sensor.columns, sensor.rows, 700});
    const LightField field = test::rendered(
        scene, {(sensor.columns - side) / 2, (sensor.rows - side) / 2, side, side}, 32);
    const MicroImages micro(scene.camera, true, test::threads(2));
    double best = 0, least = kInfinity;
    Spot sharpest;
    double pixel = 0;
    for (const double factor : {0.8, 0.9, 1.0, 1.1, 1.25}) {
      RefocusSettings settings;
      settings.depth = factor * c.depth;
      const RefocusedImage picture = refocus(field, micro, settings, test::threads(2));
      const Spot spot = spot_of(picture);
      const double angle = spot.spread / settings.depth;  // planes farther away are magnified
      if (angle < least) {
        least = angle;
        best = factor;
        sharpest = spot;
        pixel = picture.pixel;
      }
    }
    EXPECT_EQ(best, 1.0) << c.name;
    EXPECT_LT(length(sharpest.centre - c.at), 0.5 * pixel)
        << c.name << ' ' << sharpest.centre.x << ' ' << sharpest.centre.y;
  }
}

// Also where the light of several microlenses meets: at the rims of touching micro-images. Pictures
// of one pixel per microlens are means of many raw pixels; at 64 pixels across the window's seven
// microlenses a raw pixel stands alone, at the full aperture those where three micro-images fade
// out.
TEST(Refocus, UniformSceneStaysUniform) {
  const CompiledScene scene = test::scene_of(test::preset_camera("raytrix-r29-reduced"),
                                             std::make_unique<test::UniformMedium>());
  const LightField field = test::rendered(scene, {1700, 1100, 200, 200}, 1024);
  const MicroImages micro(scene.camera, true, test::threads(2));
  struct Case {
    int width;
    double aperture, tolerance;
  };
  for (const double depth : {1.0, 1.5, 3.0})
    for (const Case& c :
         {Case{0, 0.7, 0.003}, Case{0, 1, 0.003}, Case{64, 0.7, 0.01}, Case{64, 1, 0.03}}) {
      RefocusSettings settings;
      settings.depth = depth;
      settings.width = c.width;
      settings.aperture = c.aperture;
      const RefocusedImage picture = refocus(field, micro, settings, test::threads(2));
      for (const float value : picture.image.pixels)
        EXPECT_TRUE(relative(static_cast<double>(value), 1, c.tolerance))
            << depth << " m, " << c.width << " pixels, aperture " << c.aperture;
    }
}

TEST(Refocus, SameForAnyNumberOfThreads) {
  const CompiledScene scene =
      cube_scene(test::preset_camera("paper-previous-60x60"), 1, {0, 0}, 5e-3);
  const LightField field = test::rendered(scene, {200, 200, 200, 200}, 32);
  const MicroImages one(scene.camera, true, test::one_thread()),
      many(scene.camera, true, test::threads(3));
  RefocusSettings settings;
  settings.depth = 1;
  EXPECT_EQ(refocus(field, one, settings, test::one_thread()).image.pixels,
            refocus(field, many, settings, test::threads(5)).image.pixels);
}

// Vector code of every instruction set, against that of plain single precision.
TEST(Refocus, SameForAnyInstructionSet) {
  const CameraSpec spec = test::preset_camera("paper-previous-60x60");
  const CompiledScene scene = cube_scene(spec, 1.0, {0.002, 0.001}, 2e-3);
  const LightField field = test::rendered(scene, {200, 200, 200, 200}, 32);
  const MicroImages micro(scene.camera, true, test::threads(2));
  RefocusSettings settings;
  settings.depth = 0.95;
  settings.width = 50;
  settings.isa = Isa::baseline;
  const RefocusedImage plain = refocus(field, micro, settings, test::threads(2));
  const double largest =
      static_cast<double>(*std::max_element(plain.image.pixels.begin(), plain.image.pixels.end()));
  ASSERT_GT(largest, 0);
  for (const Isa isa : test::supported_isas()) {
    settings.isa = isa;
    const RefocusedImage picture = refocus(field, micro, settings, test::threads(2));
    ASSERT_EQ(picture.image.pixels.size(), plain.image.pixels.size());
    for (std::size_t k = 0; k < plain.image.pixels.size(); ++k)
      EXPECT_TRUE(test::within(static_cast<double>(picture.image.pixels[k]),
                               static_cast<double>(plain.image.pixels[k]), 1e-4, largest))
          << name(isa) << ' ' << k;
  }
}

// The map finds both of two opaque cubes at different depths, and the picture that is sharp
// everywhere is as sharp at each as the one that is focused on it.
TEST(FocusStack, FindsTheDepthsOfTwoCubes) {
  const CameraSpec spec = test::preset_camera("paper-previous-60x60");
  const auto cube = [](double depth, double x) {
    const Vec3 middle{depth, -x, 0}, size{3e-3, 3e-3, 3e-3};
    return Box{middle - size, middle + size};
  };
  const double near = 0.85, far = 1.1;
  // Light adds: the two cubes are rendered one by one.
  LightField field;
  for (const Box& box : {cube(near, -0.03), cube(far, 0.03)}) {
    const CompiledScene scene = test::scene_of(spec, std::make_unique<test::UniformMedium>(box));
    const LightField one = test::rendered(scene, {0, 150, 600, 300}, 64);
    if (field.channels.empty()) {
      field = one;
      continue;
    }
    for (std::size_t k = 0; k < one.channels[0].flux.pixels.size(); ++k)
      field.channels[0].flux.pixels[k] += one.channels[0].flux.pixels[k];
  }
  const MicroImages micro(Camera(spec), true, test::threads(2));
  std::vector<double> depths;
  for (double depth = 0.75; depth < 1.26; depth += 0.05) depths.push_back(depth);
  const FocusStack stack = focus_stack(field, micro, depths, {}, test::threads(2));
  ASSERT_EQ(stack.planes.size(), depths.size());
  for (const auto& [depth, x] : {std::pair{near, -0.03}, std::pair{far, 0.03}}) {
    // The place of the cube's middle in the picture of its depth.
    std::size_t plane = 0;
    while (depths[plane] < depth - 1e-6) ++plane;
    const RefocusedImage& sharp = stack.planes[plane];
    const int column = static_cast<int>((x - sharp.corner.x) / sharp.pixel);
    const int row = static_cast<int>((0 - sharp.corner.y) / sharp.pixel);
    ASSERT_GT(sharp.image.at(column, row), 0.5F);
    EXPECT_TRUE(relative(static_cast<double>(stack.depth.at(column, row)), depth, 0.05)) << depth;
    EXPECT_GT(stack.confidence.at(column, row), 0.5F);
    EXPECT_TRUE(relative(static_cast<double>(stack.all_in_focus.at(column, row)),
                         static_cast<double>(sharp.image.at(column, row)), 0.1));
  }
}

// The picture that is sharp everywhere is dark beside a flame, though planes far from it show light
// there, and depth cannot be told from what is dark.
TEST(FocusStack, IsDarkBesideAFlame) {
  Scene scene = test::paper_flame(300, 300);
  scene.camera.array = test::large_array(Lattice::hexagonal, LensModel::real);
  scene.camera.sensor.pixel_pitch = 100e-6;
  scene.camera.focus = {FocusMode::best, 0, 1.0, "type2"};
  const CompiledScene compiled = compile(scene);
  const LightField field = test::rendered(compiled, {0, 0, 300, 300}, 16);
  const MicroImages micro(compiled.camera, true, test::threads(2));
  std::vector<double> depths;  // even in disparity, as the window has them
  for (int i = 0; i < 16; ++i) depths.push_back(1 / (1 / 0.55 + i / 15.0 * (1 / 2.2 - 1 / 0.55)));
  const FocusStack stack = focus_stack(field, micro, depths, {}, test::threads(2));
  // A pixel stands for one direction: the tangents of its angles are those of every plane. The
  // margin is the box that depths are told from, and a pixel for the planes' own sharpness.
  const RefocusedImage& plane = stack.planes.front();
  const Box box = compiled.medium->bounds();
  const double pixel = plane.pixel / plane.depth, margin = 4 * pixel;
  double beside = 0, total = 0;
  for (int row = 0; row < stack.all_in_focus.height; ++row)
    for (int column = 0; column < stack.all_in_focus.width; ++column) {
      const double y = -(plane.corner.x / plane.depth + (column + 0.5) * pixel),
                   z = -(plane.corner.y / plane.depth + (row + 0.5) * pixel);
      const double light = static_cast<double>(stack.all_in_focus.at(column, row));
      total += light;
      if (y < box.lower.y / box.lower.x - margin || y > box.upper.y / box.lower.x + margin ||
          z < box.lower.z / box.lower.x - margin || z > box.upper.z / box.lower.x + margin)
        beside += light;
    }
  ASSERT_GT(total, 0);
  EXPECT_LT(beside, 1e-3 * total) << beside << " of " << total;
}

TEST(FocusStack, RefusesDepthsThatDoNotAscend) {
  const Camera camera(test::preset_camera("paper-previous-60x60"));
  const MicroImages micro(camera, false, test::one_thread());
  EXPECT_THROW(focus_stack({}, micro, {1, 1.1}, {}), InputError);
  EXPECT_THROW(focus_stack({}, micro, {1, 1.1, 1.1}, {}), InputError);
}

// Perwass and Wietzke's blur s = D |B (1/f - 1/a) - 1| by hand for thin lenses: the type that is
// sharp at a depth counts fully, one with three pixels of blur 1 / 3^4.
TEST(TypeWeights, FollowTheBlur) {
  CameraSpec spec;
  spec.lens.model = LensModel::ideal;
  spec.lens.focal_length = 0.1;
  spec.lens.diameter = 0.02;
  spec.array.present = true;
  spec.array.model = LensModel::ideal;
  spec.array.pitch = spec.array.diameter = 200e-6;
  spec.array.sensor_distance = 1e-3;
  spec.sensor = {400, 300, 10e-6};
  spec.focus.mode = FocusMode::distance;
  spec.focus.lens_distance = 0.11;
  // Sharp where the lens images 1 m: 1.111 mm behind the array, a = -1.111 mm; the second has three
  // pixels of blur there, 200 um B (1/f - 1/f_sharp) = 30 um.
  const double a = 0.11 - 1 / (1 / 0.1 - 1 / 1.0), gap = 1e-3;
  const double power = 1 / gap + 1 / a;
  spec.array.types = {{"sharp", kInfinity, kInfinity, 1.5, 1 / power},
                      {"blurred", kInfinity, kInfinity, 1.5, 1 / (power + 30e-6 / 200e-6 / gap)}};
  const std::vector<double> weights = type_weights(Camera(spec), 1.0, 1e-6);
  ASSERT_EQ(weights.size(), 2U);
  EXPECT_EQ(weights[0], 1);
  EXPECT_TRUE(relative(weights[1], 1 / 81.0, 1e-6));
  // A picture with pixels of 20 um on the sensor: 1/9 of an object's size in the main lens' image,
  // B / |a| of that behind a microlens. Blur of three halves of such a pixel: (2/3)^4.
  const double pixel = 20e-6 / (gap / std::fabs(a)) * 9;
  EXPECT_TRUE(relative(type_weights(Camera(spec), 1.0, pixel)[1], std::pow(2.0 / 3, 4), 1e-6));
}

TEST(Refocus, RefusesImpossiblePlanes) {
  const Camera camera(test::preset_camera("paper-previous-60x60"));
  const double focal = -camera.lens_first_order().front_focal_distance;
  EXPECT_THROW(check_refocus_depth(camera, -1), InputError);
  EXPECT_THROW(check_refocus_depth(camera, 0), InputError);
  EXPECT_THROW(check_refocus_depth(camera, 0.99 * focal), InputError);
  EXPECT_THROW(check_refocus_depth(camera, kInfinity), InputError);
  EXPECT_THROW(check_refocus_depth(camera, std::nan("")), InputError);
  EXPECT_NO_THROW(check_refocus_depth(camera, 1.01 * focal));
}

}  // namespace
}  // namespace plenoflame::refocus_test
