// The measurement equation in closed form: a source of uniform radiance that fills the pupil.
#include <array>
#include <cmath>

#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/uniform_medium.h"

namespace plenoflame::test::measurement_test {
namespace {

const double kPi = std::acos(-1.0);

/// View factor of a disc of radius r, from a parallel element at distance d whose normal meets the
/// disc's plane at distance s from its centre (Howell, A Catalog of Radiation Heat Transfer
/// Configuration Factors, B-13).
double view_factor(double s, double d, double r) {
  const double z = d * d + s * s + r * r;
  // 1 - x / sqrt(x^2 + e) without the cancellation.
  const double x = d * d + s * s - r * r;
  const double root = std::sqrt(z * z - 4 * s * s * r * r);
  return 0.5 * (root - x) / root;
}

/// The same averaged over a pixel, by Gauss-Legendre of 5 x 5 points.
double pixel_view_factor(Vec2 centre, double pitch, double d, double r) {
  constexpr std::array<double, 5> node{-0.9061798459386640, -0.5384693101056831, 0,
                                       0.5384693101056831, 0.9061798459386640};
  constexpr std::array<double, 5> weight{0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                         0.4786286704993665, 0.2369268850561891};
  double sum = 0;
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = 0; j < 5; ++j)
      sum +=
          0.25 * weight[i] * weight[j] *
          view_factor(
              std::hypot(centre.x + 0.5 * pitch * node[i], centre.y + 0.5 * pitch * node[j]), d, r);
  return sum;
}

CameraSpec thin_lens(double diameter) {
  CameraSpec camera;
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = 0.05;
  camera.lens.diameter = diameter;
  camera.sensor = {61, 41, 1e-3};
  camera.focus.object_distance = 1;
  camera.focus.conjugate = "sensor";
  return camera;
}

TEST(Measurement, ViewFactorItself) {
  // On the axis sin^2 of the half angle; far away r^2 cos^4 / d^2; an infinite disc is 1.
  EXPECT_TRUE(relative(view_factor(0, 2, 1), 0.2, 1e-14));
  EXPECT_TRUE(relative(view_factor(1, 1, 1e-4), 1e-8 / 4, 1e-6));
  EXPECT_TRUE(relative(view_factor(3, 1, 1e6), 1, 1e-10));
}

TEST(Measurement, ThinLensAndUniformSource) {
  for (const double diameter : {0.005, 0.025, 0.1}) {
    const CameraSpec spec = thin_lens(diameter);
    const CompiledScene scene = scene_of(spec, std::make_unique<UniformMedium>());
    const double d = 1 / (1 / 0.05 - 1 / 1.0);
    EXPECT_TRUE(relative(scene.camera.lens_distance(), d, 1e-14));
    RenderSettings settings;
    settings.samples = 1024;
    settings.replicates = 16;
    settings.precision = Precision::double_precision;
    const LightFieldChannel image = render(scene, settings, one_thread()).light_field.channels[0];
    double sum = 0, expected_sum = 0;
    for (const auto& [column, row] : {std::pair{30, 20}, {0, 0}, {60, 40}, {30, 0}, {5, 33}}) {
      const Vec2 centre = scene.camera.sensor_point(column + 0.5, row + 0.5);
      const double expected = kPi * 1e-6 * pixel_view_factor(centre, 1e-3, d, 0.5 * diameter) *
                              UniformMedium::kRadiance;
      // Within the scatter of the replicates, which is small: a smooth integrand but for the rim of
      // the pupil. The disc that is sampled exceeds it by 1e-5, and its area by twice that: so few
      // of 1024 rays fall there that their scatter does not show it.
      const double error = image.standard_error.at(column, row);
      EXPECT_LT(error, 3e-3 * expected);
      EXPECT_TRUE(within_standard_errors(image.flux.at(column, row), expected,
                                         std::hypot(error, 1e-5 * expected), 6));
    }
    for (int row = 0; row < 41; ++row)
      for (int column = 0; column < 61; ++column) {
        const Vec2 centre = scene.camera.sensor_point(column + 0.5, row + 0.5);
        expected_sum += kPi * 1e-6 * pixel_view_factor(centre, 1e-3, d, 0.5 * diameter);
        sum += static_cast<double>(image.flux.at(column, row));
      }
    // 2501 pixels, each within a part in 1e3.
    EXPECT_TRUE(relative(sum, expected_sum, 5e-5)) << diameter;
  }
}

TEST(Measurement, CosineToTheFourth) {
  // A small pupil: relative illumination is cos^4 of the field angle, up to (r / d)^2.
  CameraSpec spec = thin_lens(1e-4);
  spec.sensor.pixel_pitch = 1e-4;
  spec.sensor.columns = 801;
  spec.sensor.rows = 3;
  const CompiledScene scene = scene_of(spec, std::make_unique<UniformMedium>());
  RenderSettings settings;
  settings.samples = 1024;
  settings.precision = Precision::double_precision;
  const Image flux = render(scene, settings, one_thread()).light_field.channels[0].flux;
  const double d = scene.camera.lens_distance(), on_axis = kPi * 1e-8 * 0.25e-8 / (d * d);
  double sum = 0, expected_sum = 0;
  for (int column = 0; column < 801; ++column) {
    const double x = (column - 400) * 1e-4;
    const double expected = on_axis * std::pow(1 + x * x / (d * d), -2);
    // A few of 1024 rays fall into the margin around the pupil.
    EXPECT_TRUE(relative(flux.at(column, 1), expected, 5e-3)) << column;
    sum += static_cast<double>(flux.at(column, 1));
    expected_sum += expected;
  }
  EXPECT_TRUE(relative(sum, expected_sum, 2e-4));
}

TEST(Measurement, FluxDoesNotDependOnTheArrayWhereItOnlyGathers) {
  // Behind an ideal array whose micro-images do not overlap nor reach the lenses' edges, all that
  // falls on the lenses falls on the sensor: the flux of the pupil onto the lenses' area.
  CameraSpec spec = thin_lens(0.005);
  spec.array.present = true;
  spec.array.lattice = Lattice::square;
  spec.array.model = LensModel::ideal;
  spec.array.pitch = 2e-4;
  spec.array.diameter = 1e-4;
  spec.array.types = {{"a", kInfinity, kInfinity, 1.5, 1e-3}};
  spec.array.sensor_distance = 1e-3;
  spec.array.measured_from = ArrayReference::vertex;
  spec.focus.conjugate = "array";
  spec.sensor = {400, 400, 1e-5};
  const CompiledScene scene = scene_of(spec, std::make_unique<UniformMedium>());
  RenderSettings settings;
  settings.samples = 256;
  settings.precision = Precision::double_precision;
  // 7 x 7 lenses around the axis, each with its image of 0.095 mm, whole.
  settings.window = {130, 130, 140, 140};
  const RenderResult result = render(scene, settings, one_thread());
  // Etendue in the paraxial transform: a lens passes (pupil area)(lens area)/distance^2, but the
  // sensor measures cos^4 in its own space: both are small here.
  const double d = scene.camera.lens_distance();
  const double lens = kPi * 0.25e-8, pupil = kPi * 6.25e-6;
  EXPECT_TRUE(relative(result.statistics.flux, 49 * lens * pupil / (d * d), 0.01));
}

}  // namespace
}  // namespace plenoflame::test::measurement_test
