// Sensors that blur: soft edges of micro-images by a closed form, both estimators, the stream of
// rays, and what is left out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/render/estimators_agree.h"
#include "core/render/stream_picture.h"
#include "plenoflame/render/point_images.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/scene_file.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::sensor_blur_test {
namespace {

Scene blurred(Scene scene, double blur) {
  scene.camera.sensor.blur = blur;
  return scene;
}

Scene with_array() {
  return small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
}

/// A camera of its own kind for each way by which places on the sensor are drawn.
Scene scene_of(const std::string& kind) {
  if (kind == "array") return blurred(with_array(), 0.7);
  if (kind == "wide") return blurred(with_array(), 2.5);
  if (kind == "bare") return blurred(small_scene(singlet(), {}), 1.5);
  if (kind == "between") {
    Scene scene = blurred(with_array(), 1);
    scene.camera.array.diameter = 0.8e-3;
    scene.camera.array.opaque_between = false;
    return scene;
  }
  if (kind == "oblong") {
    Scene scene = blurred(with_array(), 0.7);
    scene.camera.sensor.rows = 90;
    scene.camera.sensor.pixel_pitch_y = 0.13e-3;
    return scene;
  }
  Scene scene = blurred(with_array(), 0.7);
  scene.camera.array.tilt = {2e-3, -1e-3};
  scene.camera.lens.decentre = {0.3e-3, 0};
  return scene;
}

class SensorsThatBlur : public ::testing::TestWithParam<const char*> {};

TEST_P(SensorsThatBlur, BothEstimatorsMakeOnePicture) {
  expect_estimators_agree(compile(scene_of(GetParam())));
}

TEST_P(SensorsThatBlur, WhatIsLeftOutSeesNothing) {
  Scene scene = scene_of(GetParam());
  scene.flames[0].scale = 0.4;
  const CompiledScene compiled = compile(scene);
  RenderSettings settings;
  settings.samples = 64;
  settings.precision = Precision::double_precision;
  const RenderResult left_out = render(compiled, settings);
  settings.skip = false;
  const RenderResult all = render(compiled, settings);
  EXPECT_GT(left_out.statistics.flux, 0);
  EXPECT_LT(left_out.statistics.rays, all.statistics.rays);
  const auto& few = left_out.light_field.channels[0].flux.pixels;
  const auto& every = all.light_field.channels[0].flux.pixels;
  const auto largest = static_cast<double>(*std::max_element(every.begin(), every.end()));
  for (std::size_t i = 0; i < every.size(); ++i)
    EXPECT_TRUE(within(static_cast<double>(few[i]), static_cast<double>(every[i]), 1e-6, largest))
        << i;
}

TEST_P(SensorsThatBlur, TheStreamOfRaysMakesThePicture) {
  const CompiledScene scene = compile(scene_of(GetParam()));
  RenderSettings settings;
  settings.samples = 32;
  settings.window = {0, 0, 60, 60};
  settings.precision = Precision::double_precision;
  const RenderResult picture = render(scene, settings);
  const StreamPicture<double> stream(scene, settings, {}, RayStreamContent::radiance);
  double apart = 0;
  for (std::size_t i = 0; i < stream.flux(0).size(); ++i)
    apart += std::fabs(stream.flux(0)[i] -
                       static_cast<double>(picture.light_field.channels[0].flux.pixels[i]));
  EXPECT_GT(picture.statistics.flux, 0);
  EXPECT_LT(apart, 1e-5 * picture.statistics.flux);
}

INSTANTIATE_TEST_SUITE_P(Cameras, SensorsThatBlur,
                         ::testing::Values("array", "wide", "bare", "between", "oblong",
                                           "misaligned"));

TEST(SensorBlur, BothEstimatorsAgreeWithSurfaces) {
  Scene scene = scene_of("array");
  SolidSurfaceSpec wall;
  wall.position = {1.1, 0, 0};
  wall.radius = 0.02;
  wall.material.kind = MaterialKind::blackbody;
  wall.material.temperature = 1500;
  scene.surfaces = {wall};
  expect_estimators_agree(compile(scene));
}

/// A microlens that shows the stop sharply, under an even sky: a disc of even light.
class EvenDisc {
 public:
  explicit EvenDisc(double blur) : scene_(compile(scene(blur))) {
    scene_.lights.environment = {1};
    const Camera& camera = scene_.camera;
    const double array = camera.lens_place({0, 0}).z;
    const double pixel = camera.spec().sensor.pixel_pitch, pupil = camera.exit_pupil();
    radius_ =
        0.5 * camera.spec().lens.diameter * (array - camera.sensor()) / (pupil - array) / pixel;
    spacing_ = camera.spec().array.pitch * (pupil - camera.sensor()) / (pupil - array) / pixel;
  }
  double radius() const { return radius_; }    ///< [pixels]
  double spacing() const { return spacing_; }  ///< [pixels] to the next disc
  LightFieldChannel row() const {
    RenderSettings settings;
    settings.samples = 16384;
    settings.replicates = 8;
    settings.window = {0, 30, 61, 1};
    return render(scene_, settings).light_field.channels[0];
  }

 private:
  static Scene scene(double blur) {
    Scene scene = parse_scene(R"(
[camera.lens]
model = "ideal"
focal_length = "50 mm"
diameter = "1.1 mm"
[camera.array]
lattice = "square"
model = "ideal"
pitch = "0.3 mm"
diameter = "0.2 mm"
sensor_distance = "10 mm"
[[camera.array.types]]
name = "all"
focal_length = "8.3333333333333333 mm"
[camera.focus]
mode = "distance"
lens_distance = "50 mm"
[camera.sensor]
columns = 61
rows = 61
pixel_pitch = "10 um"
[[channels]]
name = "red"
kind = "line"
wavelength = "650 nm"
width = "10 nm"
)",
                              "test.toml")
                      .scene;
    scene.camera.sensor.blur = blur;
    return scene;
  }
  CompiledScene scene_;
  double radius_ = 0, spacing_ = 0;
};

double normal_below(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}
double normal_integral(double z) {
  return z * normal_below(z) + std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
}

/// The share that a pixel at (column, 0) from the middle of an even disc of light gets, as a
/// Gaussian spreads it: error functions along one axis, a sum along the other.
double share_of_disc(double radius, double column, double blur) {
  constexpr int kSteps = 20000;
  const auto along = [&](double x) {
    return blur * (normal_integral((x + 0.5) / blur) - normal_integral((x - 0.5) / blur));
  };
  double sum = 0;
  for (int k = 0; k < kSteps; ++k) {
    const double y = radius * (2 * (k + 0.5) / kSteps - 1);
    const double half = std::sqrt(radius * radius - y * y);
    sum += (normal_below((y + 0.5) / blur) - normal_below((y - 0.5) / blur)) *
           (along(half - column) - along(-half - column));
  }
  return sum * 2 * radius / kSteps;
}

TEST(SensorBlur, EdgesOfMicroImagesAreErrorFunctions) {
  const LightFieldChannel sharp = EvenDisc(0).row();
  const double full = static_cast<double>(sharp.flux.at(30, 0));
  ASSERT_GT(full, 0);
  for (const double blur : {0.05, 0.4, 1.5, 3.0}) {
    const EvenDisc disc(blur);
    const LightFieldChannel row = disc.row();
    for (int column = 0; column < 61; ++column) {
      const double found = static_cast<double>(row.flux.at(column, 0)) / full;
      const double error = static_cast<double>(row.standard_error.at(column, 0)) / full;
      double expected = 0;
      for (const double neighbour : {-disc.spacing(), 0.0, disc.spacing()})
        expected += share_of_disc(disc.radius(), column - 30.0 - neighbour, blur);
      // The Gaussian ends at four deviations, where it has lost 1.3e-4; light falls by
      // cos^4, 2.4e-4 at the edge.
      EXPECT_TRUE(within(found, expected, 1e-3 + 4 * error, 1)) << blur << " " << column;
      EXPECT_LT(error, 0.01);
    }
  }
}

TEST(SensorBlur, ProjectionsOfPointsAreWider) {
  const auto spread = [](double blur) {
    return point_images(compile(blurred(with_array(), blur)).camera, {1, 0, 0}, 2000, nullptr);
  };
  const auto sharp = spread(0), soft = spread(1.5);
  ASSERT_FALSE(sharp.empty());
  ASSERT_EQ(sharp.size(), soft.size());
  for (std::size_t i = 0; i < sharp.size(); ++i)
    EXPECT_TRUE(within(soft[i].spread * soft[i].spread - sharp[i].spread * sharp[i].spread,
                       2 * 1.5 * 1.5, 1e-9, 1 + sharp[i].spread * sharp[i].spread));
}

}  // namespace
}  // namespace plenoflame::test::sensor_blur_test
