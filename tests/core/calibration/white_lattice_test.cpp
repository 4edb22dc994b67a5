// White pictures of cameras whose micro-images are known by tracing single rays: places, types, and
// the array's numbers come back from noisy counts.
#include "plenoflame/calibration/white_lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plenoflame/base/error.h"
#include "plenoflame/calibration/array_fit.h"
#include "plenoflame/lightfield/geometry.h"
#include "plenoflame/lightfield/sensor.h"
#include "plenoflame/sampling/noise.h"
#include "support/approx.h"

namespace plenoflame::test::white_lattice_test {
namespace {

/// A focused camera of three types behind a singlet that vignettes, or an unfocused one.
CameraSpec camera_of(Lattice lattice, double tilt, double rotation) {
  CameraSpec camera;
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = 50e-3;
  camera.lens.diameter = 11e-3;
  camera.array.present = true;
  camera.array.lattice = lattice;
  camera.array.model = LensModel::ideal;
  camera.array.pitch = 127.4e-6;
  camera.array.diameter = 127.4e-6;
  camera.array.sensor_distance = 0.45e-3;
  camera.array.offset = {31e-6, -17e-6};
  camera.array.rotation = rotation;
  camera.array.tilt = {tilt, -0.7 * tilt};
  camera.array.types = {{.name = "far", .focal_length = 0.62e-3},
                        {.name = "middle", .focal_length = 0.52e-3},
                        {.name = "near", .focal_length = 0.44e-3}};
  if (lattice == Lattice::square) camera.array.types.resize(1);
  camera.sensor.columns = 720;
  camera.sensor.rows = 540;
  camera.sensor.pixel_pitch = 5.5e-6;
  camera.focus.mode = FocusMode::paraxial;
  camera.focus.object_distance = 0.5;
  return camera;
}

/// Counts of a sensor of 10000 electrons, as light.
Image noisy(const Image& white) {
  SensorSpec sensor;
  sensor.full_well = 10000;
  sensor.read_noise = 8;
  sensor.bits = 12;
  const PixelWindow window{0, 0, white.width, white.height};
  const SensorFrame frame = expose({{&white, 600e-9}}, window, white.width, sensor, {});
  Image counts(white.width, white.height);
  for (std::size_t i = 0; i < counts.pixels.size(); ++i)
    counts.pixels[i] = static_cast<float>(frame.numbers[i] - frame.black_level);
  return counts;
}

struct Measured {
  WhiteLattice lattice;
  ArrayFit fit;
  double rms = 0, worst = 0;  ///< [pixel] of the model from the truth, over all in the picture
  std::size_t count = 0, wrong_types = 0;
};

/// @param nominal what is known of the camera beforehand
Measured measured(const CameraSpec& camera, const CameraSpec& nominal, bool tilt) {
  const MicroImages truth(Camera(camera), true);
  const PixelWindow window{0, 0, camera.sensor.columns, camera.sensor.rows};
  Measured result;
  result.lattice = measure_white(noisy(white_image(truth, window)));
  result.fit = fit_array(nominal, result.lattice, window.width, window.height, tilt);
  double squares = 0;
  for (const MicroImageFit& image : result.lattice.images) {
    // The nearest true micro-image: no index of ours is believed.
    const Vec2 point = truth.camera().sensor_point(image.model.x, image.model.y);
    const LensIndex near = truth.camera().lattice().nearest(point);
    double best = 1e300;
    MicroImages::Place place;
    for (int dq = -1; dq <= 1; ++dq)
      for (int dr = -1; dr <= 1; ++dr) {
        const MicroImages::Place other = truth.place({near.q + dq, near.r + dr});
        if (other.dark || length(other.centre - point) >= best) continue;
        best = length(other.centre - point);
        place = other;
      }
    const double off = best / camera.sensor.pixel_pitch;
    squares += off * off;
    result.worst = std::max(result.worst, off);
    ++result.count;
    const LensIndex lens = lens_of(result.fit, image.i, image.j);
    const auto types = static_cast<int>(camera.array.types.size());
    const int type = ((lens.q - lens.r) % types + types) % types;
    result.wrong_types += type != place.type;
  }
  result.rms = std::sqrt(squares / static_cast<double>(result.count));
  return result;
}

TEST(WhiteLattice, ThreeTypesTiltedAndTurned) {
  const CameraSpec camera = camera_of(Lattice::hexagonal, 1e-3, 0.02);
  CameraSpec nominal = camera_of(Lattice::hexagonal, 0, 0);
  nominal.array.pitch = 127e-6;
  nominal.array.diameter = 120e-6;
  nominal.array.offset = {};
  const Measured result = measured(camera, nominal, true);
  std::printf(
      "hexagonal: %zu micro-images, %zu good, model from truth %.4f px RMS, %.4f worst; %.4f from "
      "model\n",
      result.count, result.lattice.good, result.rms, result.worst, result.lattice.rms);
  EXPECT_TRUE(result.lattice.guess.hexagonal);
  EXPECT_GT(result.count, 700U);
  EXPECT_LT(result.rms, 0.02);
  ASSERT_EQ(result.lattice.types.size(), 3U);
  EXPECT_EQ(result.wrong_types, 0U);
  // Types are told from each other by the width of their micro-images' edges.
  EXPECT_GT(result.fit.type_match, 0.99);
  // The array comes back, from a start that is off by a third of a lens.
  const ArraySpec &array = result.fit.array, &truth = camera.array;
  EXPECT_LT(std::fabs(array.pitch - truth.pitch), 4 * result.fit.pitch_error);
  EXPECT_LT(std::fabs(array.rotation - truth.rotation), 4 * result.fit.rotation_error);
  EXPECT_LT(std::fabs(array.tilt.x - truth.tilt.x), 4 * result.fit.tilt_error.x);
  EXPECT_LT(std::fabs(array.tilt.y - truth.tilt.y), 4 * result.fit.tilt_error.y);
  EXPECT_LT(result.fit.tilt_error.x, 0.2 * truth.tilt.x);
  EXPECT_LT(result.fit.rms, 0.02);
}

TEST(WhiteLattice, Square) {
  CameraSpec camera = camera_of(Lattice::square, 0, -0.01);
  camera.array.types[0].focal_length = 0.45e-3;
  const Measured result = measured(camera, camera, false);
  std::printf(
      "square: %zu micro-images, %zu good, model from truth %.4f px RMS, %.4f worst; %.4f from "
      "model\n",
      result.count, result.lattice.good, result.rms, result.worst, result.lattice.rms);
  EXPECT_FALSE(result.lattice.guess.hexagonal);
  EXPECT_LT(result.rms, 0.02);
  EXPECT_EQ(result.lattice.types.size(), 1U);
}

/// A camera of so many microlenses that not all of them take part in a fit.
CameraSpec large_camera(double tilt) {
  CameraSpec camera = camera_of(Lattice::square, tilt, -0.01);
  camera.array.types[0].focal_length = 0.45e-3;
  camera.sensor.columns = 2200;
  camera.sensor.rows = 1800;
  return camera;
}

/// [pixel] The middles of the micro-images whose rays are traced singly.
std::vector<Vec2> exact_centres(const CameraSpec& camera) {
  const MicroImages truth(Camera(camera), true);
  std::vector<Vec2> centres;
  for (int q = -60; q <= 60; ++q)
    for (int r = -60; r <= 60; ++r) {
      const MicroImages::Place place = truth.place({q, r});
      const Vec2 centre = truth.camera().image_point(place.centre);
      if (!place.dark && centre.x > 1 && centre.y > 1 && centre.x < camera.sensor.columns - 1 &&
          centre.y < camera.sensor.rows - 1)
        centres.push_back(centre);
    }
  return centres;
}

ArrayFit fit_of(const CameraSpec& nominal, const std::vector<Vec2>& centres, bool tilt) {
  const int columns = nominal.sensor.columns, rows = nominal.sensor.rows;
  return fit_array(nominal, lattice_of_centres(centres, columns, rows), columns, rows, tilt);
}

// The stated errors are the scatter of draws of noise. (The pitch is left out: what centres are
// true to counts more for it.) Fails when the noise of all is stated for a fit to the centres of
// some.
TEST(WhiteLattice, StatedErrorsAreTheScatterOfDraws) {
  constexpr int kDraws = 10;
  constexpr double kNoise = 0.1;  // [pixel] per axis
  const CameraSpec camera = large_camera(1e-3);
  const std::vector<Vec2> exact = exact_centres(camera);
  ASSERT_GT(exact.size(), 6000U);
  double squares = 0;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    NoiseStream stream(draw, 0);
    std::vector<Vec2> centres = exact;
    for (Vec2& centre : centres)
      centre = centre + kNoise * Vec2{stream.gaussian(), stream.gaussian()};
    const ArrayFit fit = fit_of(camera, centres, true);
    const ArraySpec &found = fit.array, &truth = camera.array;
    for (const double pull : {(found.rotation - truth.rotation) / fit.rotation_error,
                              (found.offset.x - truth.offset.x) / fit.offset_error.x,
                              (found.offset.y - truth.offset.y) / fit.offset_error.y,
                              (found.tilt.x - truth.tilt.x) / fit.tilt_error.x,
                              (found.tilt.y - truth.tilt.y) / fit.tilt_error.y})
      squares += pull * pull / (5 * kDraws);
  }
  // The mean of 50 squares scatters by sqrt(2 / 50): four of that.
  EXPECT_TRUE(relative(squares, 1.0, 4 * std::sqrt(2.0 / (5 * kDraws))));
}

// Centres without noise, of an array whose tilt the fit may not have: the stated errors are of the
// order of those that this makes. Fails when only noise is stated.
TEST(WhiteLattice, ErrorsTellThatTheCameraCannotBeAsTheLatticeIs) {
  const CameraSpec camera = large_camera(2e-3);
  CameraSpec nominal = camera;
  nominal.array.tilt = {};
  const ArrayFit fit = fit_of(nominal, exact_centres(camera), false);
  EXPECT_LT(std::fabs(fit.array.rotation - camera.array.rotation), 4 * fit.rotation_error);
  EXPECT_LT(std::fabs(fit.array.offset.x - camera.array.offset.x), 4 * fit.offset_error.x);
  EXPECT_LT(std::fabs(fit.array.offset.y - camera.array.offset.y), 4 * fit.offset_error.y);
  EXPECT_LT(std::fabs(fit.array.pitch - camera.array.pitch), 4 * fit.pitch_error);
}

TEST(WhiteLattice, NoLatticeIsSaid) {
  Image noise(300, 200);
  NoiseStream stream(1, 2);
  for (float& value : noise.pixels) value = static_cast<float>(100 + 10 * stream.gaussian());
  EXPECT_THROW(measure_white(noise), InputError);
  EXPECT_THROW(measure_white(Image(300, 200, 5)), InputError);
  Image stripes(300, 200);
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 300; ++x) stripes.at(x, y) = x / 5 % 2 == 0 ? 100.0F : 20.0F;
  EXPECT_THROW(measure_white(stripes), InputError);
}

}  // namespace
}  // namespace plenoflame::test::white_lattice_test
