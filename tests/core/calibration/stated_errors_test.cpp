// Many simulated calibrations of cameras that differ: the squares of (found - true) / stated have a
// mean near 1. White pictures are those of traced micro-images, corners those of a thin lens of its
// own, counts those of a formula.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>

#include "plenoflame/calibration/array_fit.h"
#include "plenoflame/calibration/geometry_calibration.h"
#include "plenoflame/calibration/radiometry_fit.h"
#include "plenoflame/calibration/white_lattice.h"
#include "plenoflame/lightfield/geometry.h"
#include "plenoflame/lightfield/sensor.h"
#include "support/approx.h"
#include "support/length.h"
#include "support/thin_camera.h"

namespace plenoflame::test::stated_errors_test {
namespace {

int draws() {
  return in_full() ? 50 : 8;
}

/// Squares of (found - true) / stated, by value.
class Pulls {
 public:
  explicit Pulls(std::string name) : name_(std::move(name)) {}
  void add(const std::string& value, double found, double truth, double stated) {
    Sum& sum = sums_[value];
    sum.squares += std::pow((found - truth) / stated, 2);
    sum.count += 1;
  }
  /// Squares of one value scatter by sqrt(2). In full the limits are those that the calibration
  /// promises; few draws have limits of four deviations beside them.
  void expect_one() const {
    Sum all;
    for (const auto& [value, sum] : sums_) {
      std::printf("%s, %s: %.2f\n", name_.c_str(), value.c_str(), sum.squares / sum.count);
      all.squares += sum.squares;
      all.count += sum.count;
    }
    const double mean = all.squares / all.count;
    std::printf("%s: %.2f\n", name_.c_str(), mean);
    const double more = in_full() ? 0 : 4 * std::sqrt(2 / all.count);
    EXPECT_GT(mean, 0.7 - more);
    EXPECT_LT(mean, 1.4 + more);
  }

 private:
  struct Sum {
    double squares = 0, count = 0;
  };
  std::string name_;
  std::map<std::string, Sum> sums_;
};

class Draw {
 public:
  explicit Draw(int number) : random_(static_cast<std::uint64_t>(1000 + number)) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double normal(double deviation) {
    return std::normal_distribution<double>(0, deviation)(random_);
  }

 private:
  std::mt19937_64 random_;
};

TEST(StatedErrors, White) {
  Pulls pulls("white");
  for (int number = 0; number < draws(); ++number) {
    Draw draw(number);
    CameraSpec nominal;
    nominal.lens.model = LensModel::ideal;
    nominal.lens.focal_length = 50e-3;
    nominal.lens.diameter = draw.uniform(8e-3, 11e-3);
    nominal.array.present = true;
    nominal.array.lattice = Lattice::hexagonal;
    nominal.array.model = LensModel::ideal;
    nominal.array.pitch = nominal.array.diameter = 127e-6;
    nominal.array.sensor_distance = 0.45e-3;
    nominal.array.types = {{.name = "far", .focal_length = 0.62e-3},
                           {.name = "middle", .focal_length = 0.52e-3},
                           {.name = "near", .focal_length = 0.44e-3}};
    nominal.sensor.columns = 720;
    nominal.sensor.rows = 540;
    nominal.sensor.pixel_pitch = 5.5e-6;
    nominal.focus.mode = FocusMode::paraxial;
    nominal.focus.object_distance = 0.5;
    CameraSpec truth = nominal;
    truth.array.pitch = truth.array.diameter = draw.uniform(126.5e-6, 127.5e-6);
    truth.array.rotation = draw.uniform(-0.02, 0.02);
    truth.array.offset = {draw.uniform(-40e-6, 40e-6), draw.uniform(-40e-6, 40e-6)};
    truth.array.tilt = {draw.uniform(-1e-3, 1e-3), draw.uniform(-1e-3, 1e-3)};
    const PixelWindow window{0, 0, truth.sensor.columns, truth.sensor.rows};
    Image white = white_image(MicroImages(Camera(truth), true), window);
    float brightest = 0;
    for (const float value : white.pixels) brightest = std::max(brightest, value);
    for (float& value : white.pixels) {
      const double electrons = 8000 * static_cast<double>(value / brightest);
      value = static_cast<float>(electrons + draw.normal(std::sqrt(electrons + 64)));
    }
    const ArrayFit fit =
        fit_array(nominal, measure_white(white), window.width, window.height, true);
    // The lens that counts as (0, 0) may be another one: the offset is compared by whole steps.
    const MicrolensLattice lattice(truth.array);
    const Vec2 at = lattice.centre(lattice.nearest(fit.array.offset)) - fit.array.offset;
    pulls.add("pitch", fit.array.pitch, truth.array.pitch, fit.pitch_error);
    pulls.add("rotation", fit.array.rotation, truth.array.rotation, fit.rotation_error);
    pulls.add("offset", at.x, 0, fit.offset_error.x);
    pulls.add("offset", at.y, 0, fit.offset_error.y);
    pulls.add("tilt", fit.array.tilt.x, truth.array.tilt.x, fit.tilt_error.x);
    pulls.add("tilt", fit.array.tilt.y, truth.array.tilt.y, fit.tilt_error.y);
  }
  pulls.expect_one();
}

TEST(StatedErrors, Geometry) {
  Pulls pulls("geometry");
  for (int number = 0; number < draws(); ++number) {
    Draw draw(number);
    CameraSpec truth = thin_camera::truth();
    truth.lens.focal_length *= draw.uniform(0.99, 1.01);
    truth.focus.lens_distance *= truth.lens.focal_length / 0.0502;
    truth.array.sensor_distance *= draw.uniform(0.95, 1.05);
    truth.lens.decentre = {draw.normal(0.2e-3), draw.normal(0.2e-3)};
    truth.array.rotation = draw.uniform(0.003, 0.005);
    thin_camera::Deviations deviations;
    GeometrySettings settings;
    deviations.pupil = draw.normal(settings.pupil);
    const thin_camera::Seen seen = thin_camera::observe(
        truth, 8, draw.uniform(0.03, 0.1), 1, deviations, static_cast<std::uint64_t>(number));
    std::vector<CornerObservation> corners;
    for (std::size_t i = 0; i < seen.corners.size(); i += in_full() ? 3 : 9)
      corners.push_back(seen.corners[i]);
    const GeometryCalibration found =
        calibrate_geometry(thin_camera::nominal(), corners, seen.centres, settings);
    for (const CalibratedValue& value : found.values)
      pulls.add(value.key, value.value, thin_camera::value_of(truth, value.key), value.error);
  }
  pulls.expect_one();
}

// A small sensor sees no perspective that tells the scale of a camera. Blur of the corners tells
// the ratio of the sensor's distance to the focal lengths of microlenses, which are known to 3 %
// together: information adds.
TEST(StatedErrors, GeometryWithBlur) {
  Pulls pulls("geometry with blur");
  for (int number = 0; number < draws(); ++number) {
    Draw draw(500 + number);
    GeometrySettings settings;
    CameraSpec truth = thin_camera::truth(), start = thin_camera::nominal();
    truth.lens.focal_length *= draw.uniform(0.99, 1.01);
    truth.focus.lens_distance *= truth.lens.focal_length / 0.0502;
    truth.array.sensor_distance *= draw.uniform(0.95, 1.05);
    for (CameraSpec* camera : {&truth, &start}) {
      camera->sensor.columns = 400;
      camera->sensor.rows = 300;
      camera->array.types.resize(3, camera->array.types[0]);
    }
    // Types differ from their names by 5 %, their geometric mean by what is stated.
    double mean = 1;
    for (std::size_t t = 0; t < 3; ++t) {
      start.array.types[t].focal_length = 0.5e-3 + 0.05e-3 * static_cast<double>(t);
      const double own = 1 + draw.normal(0.05);
      truth.array.types[t].focal_length = start.array.types[t].focal_length * own;
      mean *= std::cbrt(own);
    }
    const double common = 1 + draw.normal(settings.microlens);
    for (auto& type : truth.array.types) type.focal_length *= common / mean;
    thin_camera::Deviations deviations;
    deviations.pupil = draw.normal(settings.pupil);
    deviations.blur = draw.uniform(0.05, 0.2);
    deviations.blur_scale = draw.normal(0.02);
    deviations.blur_offset = draw.normal(0.03);
    const thin_camera::Seen seen = thin_camera::observe(
        truth, 5, draw.uniform(0.03, 0.1), 1, deviations, static_cast<std::uint64_t>(number));
    std::vector<CornerObservation> corners;
    for (std::size_t i = 0; i < seen.corners.size(); i += 2) corners.push_back(seen.corners[i]);
    const GeometryCalibration found = calibrate_geometry(start, corners, seen.centres, settings);
    ASSERT_TRUE(found.blur);
    double distance_error = 0;
    for (const CalibratedValue& value : found.values) {
      if (value.key.find("focal_length") == std::string::npos &&
          value.key.find("_distance") == std::string::npos)
        continue;
      pulls.add(value.key, value.value, thin_camera::value_of(truth, value.key), value.error);
      if (value.key == "camera.array.sensor_distance") distance_error = value.error / value.value;
    }
    pulls.add("microlenses", found.blur->change, 0, found.blur->change_error);
    double boards = 0;
    for (std::size_t p = 0; p < found.poses.size(); ++p)
      boards += std::pow((found.poses[p].to_camera.translation.z - seen.distances[p]) /
                             found.poses[p].distance_error,
                         2);
    // The boards' distances share the scale.
    pulls.add("boards", std::sqrt(boards / static_cast<double>(found.poses.size())), 0, 1);
    if (number >= 3) continue;
    for (CornerObservation& corner : corners) corner.blur_error = 0;
    const GeometryCalibration without = calibrate_geometry(start, corners, seen.centres, settings);
    EXPECT_FALSE(without.blur);
    for (const CalibratedValue& value : without.values) {
      if (value.key != "camera.array.sensor_distance") continue;
      const double of_places = value.error / value.value;
      EXPECT_GT(of_places, settings.microlens);
      EXPECT_TRUE(
          relative(distance_error, 1 / std::hypot(1 / of_places, 1 / settings.microlens), 0.25));
    }
  }
  pulls.expect_one();
}

/// Frames of one exposure, from counts of each pixel.
CountFrames frames_of(const Image& counts) {
  CountFrames frames;
  frames.width = counts.width;
  frames.height = counts.height;
  frames.bits = 12;
  frames.frames = 1;
  frames.mean = {counts};
  frames.state.assign(frames.pixel_count(), 0);
  return frames;
}

TEST(StatedErrors, Radiometry) {
  constexpr int kSide = 60;
  Pulls pulls("radiometry");
  for (int number = 0; number < draws(); ++number) {
    Draw draw(number);
    const double joules = draw.uniform(5e-19, 2e-18), curvature = draw.uniform(-3e-5, 3e-5),
                 gain = draw.uniform(1, 4), common = 0.01;
    const double common_error = draw.normal(common);
    EvaluatedPixels pixels;
    pixels.etendue = Image(kSide, kSide);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        pixels.etendue.at(x, y) = static_cast<float>(1e-12 * (1 + 0.1 * std::sin(x) * std::cos(y)));
    pixels.window = pixels.part = {0, 0, kSide, kSide};
    // Counts c with c (1 + k c) = light.
    const auto picture = [&](double radiance, double time) {
      Image counts(kSide, kSide);
      for (std::size_t i = 0; i < counts.pixels.size(); ++i) {
        const double linear =
            static_cast<double>(pixels.etendue.pixels[i]) * radiance * time / joules;
        const double c = (std::sqrt(1 + 4 * curvature * linear) - 1) / (2 * curvature);
        counts.pixels[i] = static_cast<float>(c + draw.normal(std::sqrt(c / gain + 9)));
      }
      return frames_of(counts);
    };
    std::vector<CountFrames> frames;
    frames.reserve(20);
    std::vector<SourcePicture> sources, whites;
    const auto add = [&](std::vector<SourcePicture>& to, double counts, double error) {
      SourcePicture source;
      source.exposure_time = 1e-4 * counts / 1000;
      source.radiance = 1000 * joules / 1e-12 / 1e-4;
      source.radiance_error = error;
      const double real = source.radiance * (1 + draw.normal(error)) * (1 + common_error);
      frames.push_back(picture(real, source.exposure_time));
      source.frames = &frames.back();
      to.push_back(source);
    };
    for (const double counts : {900.0, 1400.0, 2000.0})
      add(sources, counts, draw.uniform(0.005, 0.02));
    for (const double counts : {300.0, 700.0, 1200.0, 2000.0, 3000.0}) add(whites, counts, 0);
    const RadiometryFit fit = fit_radiometry(sources, whites, pixels, common);
    pulls.add("energy of a count", fit.scale.joules_per_count / joules, 1,
              fit.scale.relative_error);
    pulls.add("curvature", fit.scale.curvature, curvature, fit.scale.curvature_error);
  }
  pulls.expect_one();
}

}  // namespace
}  // namespace plenoflame::test::stated_errors_test
