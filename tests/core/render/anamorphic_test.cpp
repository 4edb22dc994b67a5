// Whole pictures of main lenses that are not round: rays that are left out see nothing, and rays
// that are streamed or exported, chief rays and the round lens as a special case agree with them.
// That no light is lost is in no_light_lost_test, forward against backward in
// forward_agreement_test.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/render/left_out.h"
#include "core/render/stream_picture.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/render/ground_truth.h"
#include "plenoflame/render/ray_paths.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"

namespace plenoflame::test::anamorphic_test {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// The small scene's lens, of 300 mm, with a front that has these radii.
MainLensSpec lens_of(double radius_x, double radius_y) {
  MainLensSpec lens = singlet();
  lens.surfaces[0].radius = kInf;
  lens.surfaces[0].radius_x = radius_x;
  lens.surfaces[0].radius_y = radius_y;
  return lens;
}

Scene with_square_array(const MainLensSpec& lens) {
  return small_scene(lens, large_array(Lattice::square, LensModel::real));
}

Scene askew() {
  Scene scene = small_scene(lens_of(0.22, 0.6), large_array(Lattice::hexagonal, LensModel::real));
  scene.camera.lens.decentre = {1e-3, -0.6e-3};
  scene.camera.lens.tilt = {0.004, 0.006};
  scene.camera.array.focal_jitter = 0.05;
  return scene;
}

double flux_of(const RenderResult& result, double& variance) {
  const LightFieldChannel& channel = result.light_field.channels[0];
  double flux = 0;
  for (std::size_t i = 0; i < channel.flux.pixels.size(); ++i) {
    flux += static_cast<double>(channel.flux.pixels[i]);
    variance += std::pow(static_cast<double>(channel.standard_error.pixels[i]), 2);
  }
  return flux;
}

// By other tables, other kernels and other rays.
TEST(Anamorphic, EqualSectionsMakeThePictureOfTheRoundLens) {
  RenderSettings settings;
  settings.samples = 256;
  double variance = 0;
  const double round = flux_of(render(compile(with_square_array(singlet())), settings), variance);
  const double same =
      flux_of(render(compile(with_square_array(lens_of(0.3, 0.3))), settings), variance);
  EXPECT_LT(std::sqrt(variance), 2e-3 * round);
  EXPECT_TRUE(within_standard_errors(same, round, std::sqrt(variance), 4));
}

TEST(Anamorphic, WhatIsLeftOutSeesNothing) {
  for (Scene scene :
       {with_square_array(lens_of(0.24, 0.45)), askew(), small_scene(lens_of(kInf, 0.2), {})}) {
    scene.flames[0].scale = 0.4;
    EXPECT_LE(expect_left_out_sees_nothing(compile(scene)), 1);
  }
}

TEST(Anamorphic, TheStreamOfRaysMakesThePicture) {
  for (const Scene& scene :
       {with_square_array(lens_of(0.24, 0.45)), askew(), small_scene(lens_of(0.3, 0.5), {})})
    expect_stream_makes_picture(compile(scene), {10, 20, 30, 20},
                                {RayStreamContent::rays, RayStreamContent::radiance});
}

TEST(Anamorphic, NothingDependsOnThreads) {
  const CompiledScene scene = compile(askew());
  RenderSettings settings;
  settings.samples = 16;
  const RenderResult one = render(scene, settings, threads(1)),
                     three = render(compile(askew(), load_core_medium, threads(3)), settings,
                                    threads(3));
  EXPECT_EQ(one.light_field.channels[0].flux.pixels, three.light_field.channels[0].flux.pixels);
}

// The rays of a pixel sum up to its flux, and each takes the way of the exact path.
TEST(Anamorphic, ExportedRaysMakeThePixel) {
  const CompiledScene scene = compile(with_square_array(lens_of(0.24, 0.45)));
  RenderSettings settings;
  settings.samples = 64;
  settings.precision = Precision::double_precision;
  const auto picture = render(scene, settings).light_field.channels[0].flux;
  const auto brightest = static_cast<int>(
      std::max_element(picture.pixels.begin(), picture.pixels.end()) - picture.pixels.begin());
  const int column = brightest % picture.width, row = brightest / picture.width;
  RayPaths paths = empty_ray_paths(scene);
  add_pixel_rays(scene, settings, {{column, row}}, {}, paths);
  double flux = 0;
  int reached = 0;
  for (std::size_t r = 0; r < paths.rays.size(); ++r) {
    flux += paths.rays[r].weight * paths.radiance_of(r, 0);
    reached += paths.rays[r].status.status == RayStatus::reached;
  }
  settings.window = {column, row, 1, 1};
  double variance = 0;
  EXPECT_GT(reached, 10);
  EXPECT_GT(flux, 0);
  EXPECT_TRUE(relative(flux, flux_of(render(scene, settings), variance), 1e-5));
}

// Views, refocusing and truth go by chief rays: those that the camera itself traces.
TEST(Anamorphic, ChiefRaysAreExact) {
  for (const Scene& scene : {with_square_array(lens_of(0.24, 0.45)), askew()}) {
    const Camera camera(scene.camera);
    const MicroImages images(camera, false);
    int seen = 0;
    for (const LensIndex lens : camera.lattice().within({-4e-3, -4e-3}, {4e-3, 4e-3})) {
      const MicroImages::Place place = images.place(lens);
      ASSERT_FALSE(place.dark);
      const Vec3 middle = camera.lens_place(lens);
      const auto stop = camera.at_stop(place.centre, lens);
      ASSERT_TRUE(stop.has_value());
      // Through the middle of the stop, but for what the rays of the round lens miss it by.
      EXPECT_LT(length(*stop), 2e-3 * 0.05);
      const MicroImages::ToPlane to_plane = images.to_plane(place, 1);
      for (const Vec2 off : {Vec2{0, 0}, Vec2{0.4, 0.3}, Vec2{-0.5, 0.2}, Vec2{0.1, -0.6}}) {
        const Vec2 s = place.centre + place.radius * off;
        const Camera::Path path = camera.trace(s, lens, {middle.x, middle.y});
        if (path.status.status != RayStatus::reached) continue;
        ++seen;
        const Vec3 at = path.exit.at((1 - path.exit.origin.z) / path.exit.direction.z);
        // Polynomials of fifth degree stand for the ray's place in a field of 0.1 m.
        EXPECT_LT(length(to_plane(s) - Vec2{at.x, at.y}), 2e-6);
      }
    }
    EXPECT_GT(seen, 200);
  }
}

}  // namespace
}  // namespace plenoflame::test::anamorphic_test
