// Corners that a thin-lens model of its own projects, with noise: each value comes back within
// three of the standard deviations that go with it.
#include "plenoflame/calibration/geometry_calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <cmath>
#include <random>

#include "plenoflame/base/error.h"
#include "support/approx.h"
#include "support/length.h"
#include "support/thin_camera.h"

namespace plenoflame::test::geometry_calibration_test {
namespace {

using namespace thin_camera;

/// Every so many of the corners: a fit's time is in proportion to their number.
std::vector<CornerObservation> every(std::size_t step,
                                     const std::vector<CornerObservation>& corners) {
  std::vector<CornerObservation> some;
  for (std::size_t i = 0; i < corners.size(); i += step) some.push_back(corners[i]);
  return some;
}
std::vector<CornerObservation> every_third(const std::vector<CornerObservation>& corners) {
  return every(3, corners);
}
/// Fewer, where stated errors are tested: they hold for any number.
std::vector<CornerObservation> some_of(const std::vector<CornerObservation>& corners) {
  return every(in_full() ? 3 : 9, corners);
}

TEST(GeometryCalibration, WithoutNoiseTheCameraItself) {
  const Seen seen = observe(truth(), 6, 0);
  const std::vector<CornerObservation> corners = every_third(seen.corners);
  ASSERT_GT(corners.size(), 1000u);
  const GeometryCalibration found = calibrate_geometry(nominal(), corners, seen.centres);
  EXPECT_LT(found.corner_rms, 1e-6);
  EXPECT_EQ(found.left_out, 0u);
  for (const CalibratedValue& value : found.values)
    EXPECT_TRUE(within(value.value, value_of(truth(), value.key), 1e-6,
                       std::max(std::fabs(value.value), 1e-3)))
        << value.key;
}

// Corners of a camera with another lens: what explains them is no camera near the one to start
// with.
TEST(GeometryCalibration, RefusesWhatRanAway) {
  const Seen seen = observe(truth(), 6, 0.05);
  CameraSpec start = truth();
  start.array.sensor_distance = 0.15e-3;
  GeometrySettings settings;
  settings.free = {"camera.array.sensor_distance"};
  std::string message;
  try {
    calibrate_geometry(start, some_of(seen.corners), seen.centres, settings);
  } catch (const InputError& error) {
    message = error.what();
  }
  // It went to the true camera, which is not near the one that was given.
  const std::string words = "ran away: camera.array.sensor_distance went from 150 um to ";
  const std::size_t at = message.find(words);
  ASSERT_NE(at, std::string::npos) << message;
  EXPECT_TRUE(relative(std::stod(message.substr(at + words.size())), 400, 0.01)) << message;
}

// A board of another unit looks the same from as many times the distance.
TEST(GeometryCalibration, RefusesABoardOfAnotherUnit) {
  const Seen seen = observe(truth(), 3, 0.05);
  for (const double unit : {1e3, 1e-3}) {
    std::vector<CornerObservation> corners = some_of(seen.corners);
    for (CornerObservation& corner : corners) corner.board = unit * corner.board;
    std::string message;
    try {
      calibrate_geometry(truth(), corners, seen.centres);
    } catch (const InputError& error) {
      message = error.what();
    }
    const std::string words = "pose 0: by its size the board would be ";
    ASSERT_EQ(message.find(words), 0u) << message;
    EXPECT_TRUE(relative(std::stod(message.substr(words.size())), unit * seen.distances[0], 0.3))
        << message;
    EXPECT_NE(message.find("x and y of the corners are in metres"), std::string::npos) << message;
  }
}

CameraSpec distorting() {
  CameraSpec camera = truth();
  camera.lens.distortion = {0.7, -25, 0, 0.004, -0.006, 0.33};
  return camera;
}

TEST(GeometryCalibration, DistortionComesBack) {
  if (!in_full()) return;
  const Seen seen = observe(distorting(), 6, 0);
  GeometrySettings settings;
  settings.free = {"usual", "camera.lens.distortion"};
  const GeometryCalibration found =
      calibrate_geometry(nominal(), seen.corners, seen.centres, settings);
  EXPECT_LT(found.corner_rms, 1e-5);
  EXPECT_EQ(found.values.size(), 17u);
  const DistortionSpec &d = found.camera.lens.distortion, expected = distorting().lens.distortion;
  EXPECT_TRUE(relative(d.k1, expected.k1, 1e-3));
  EXPECT_TRUE(relative(d.k2, expected.k2, 1e-2));
  EXPECT_TRUE(relative(d.p1, expected.p1, 1e-3));
  EXPECT_TRUE(relative(d.p2, expected.p2, 1e-3));
  EXPECT_TRUE(relative(d.distance, expected.distance, 1e-3));
}

/// That each value lies within three of its deviations of the truth, and all of them together as
/// far as they ought to.
void expect_stated_errors(const GeometryCalibration& found, const CameraSpec& truth) {
  const std::size_t count = found.values.size();
  ASSERT_EQ(found.covariance.size(), count);
  const auto n = static_cast<Eigen::Index>(count);
  Eigen::MatrixXd covariance(n, n);
  Eigen::VectorXd off(n);
  for (std::size_t i = 0; i < found.values.size(); ++i) {
    const CalibratedValue& value = found.values[i];
    const double expected = value_of(truth, value.key);
    off[static_cast<int>(i)] = value.value - expected;
    for (std::size_t j = 0; j < found.values.size(); ++j)
      covariance(static_cast<int>(i), static_cast<int>(j)) = found.covariance[i][j];
    EXPECT_TRUE(within_standard_errors(value.value, expected, value.error, 3)) << value.key;
    EXPECT_TRUE(relative(found.covariance[i][i], value.error * value.error, 1e-9));
  }
  // Errors that are far too large would pass the above: chi^2 of so many values lies within these
  // limits with 99.8 % probability (Wilson and Hilferty's normal). Units are those of the
  // deviations, of which the matrix is well scaled.
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::VectorXd off_scaled = scale.cwiseProduct(off);
  const double chi2 = off_scaled.dot(scaled.ldlt().solve(off_scaled));
  const double spread = 2 / (9 * static_cast<double>(n));
  const auto limit = [&](double sigma) {
    return static_cast<double>(n) * std::pow(1 - spread + sigma * std::sqrt(spread), 3);
  };
  EXPECT_GT(chi2, limit(-3.09));
  EXPECT_LT(chi2, limit(3.09));
}

// The figure asked of the calibration: 15 poses, each value within three of its deviations.
TEST(GeometryCalibration, FifteenPosesTellAllValues) {
  const double noise = 0.05;
  const Seen seen = observe(truth(), 15, noise);
  GeometrySettings settings;
  settings.pupil = 0;
  const GeometryCalibration found =
      calibrate_geometry(nominal(), some_of(seen.corners), seen.centres, settings);
  EXPECT_TRUE(relative(found.corner_rms, std::sqrt(2.0) * noise, 0.03));
  EXPECT_TRUE(relative(found.centre_rms, std::sqrt(2.0) * noise, 0.05));
  ASSERT_EQ(found.values.size(), 11u);
  expect_stated_errors(found, truth());
}

// The same with distortion, of whose plane the start knows nothing.
TEST(GeometryCalibration, FifteenPosesTellDistortion) {
  const double noise = 0.05;
  const Seen seen = observe(distorting(), 15, noise);
  GeometrySettings settings;
  settings.free = {"usual", "camera.lens.distortion"};
  settings.pupil = 0;
  const GeometryCalibration found =
      calibrate_geometry(nominal(), some_of(seen.corners), seen.centres, settings);
  EXPECT_TRUE(relative(found.corner_rms, std::sqrt(2.0) * noise, 0.03));
  ASSERT_EQ(found.values.size(), 17u);
  expect_stated_errors(found, distorting());
}

// A lens without distortion does not tell which plane it would have: the plane stays where the
// camera is in focus, and distortion is none within its errors.
TEST(GeometryCalibration, WithoutDistortionItsPlaneStays) {
  const Seen seen = observe(truth(), 7, 0.05);
  GeometrySettings settings;
  settings.free = {"usual", "camera.lens.distortion"};
  settings.pupil = 0;
  const GeometryCalibration found =
      calibrate_geometry(nominal(), some_of(seen.corners), seen.centres, settings);
  ASSERT_EQ(found.values.size(), 16u);
  expect_stated_errors(found, truth());
  const CameraSpec start = nominal();
  EXPECT_TRUE(relative(found.camera.lens.distortion.distance,
                       1 / (1 / start.lens.focal_length - 1 / start.focus.lens_distance), 1e-12));
}

/// Squares of (found - true) / stated, a mean over all values. @param keep their keys
double mean_pull2(const GeometryCalibration& found, const CameraSpec& truth,
                  const std::vector<std::string>& keys) {
  double sum = 0, count = 0;
  for (const CalibratedValue& value : found.values)
    for (const std::string& key : keys)
      if (value.key == key) {
        sum += std::pow((value.value - value_of(truth, key)) / value.error, 2);
        count += 1;
      }
  return sum / count;
}

const std::vector<std::string> kLengths{"camera.lens.focal_length", "camera.focus.lens_distance",
                                        "camera.array.sensor_distance"};

// The pupil of a real lens lies beside the lens. Stated errors hold over pupils as they are.
TEST(GeometryCalibration, ErrorsHoldThePlaceOfThePupil) {
  double all = 0, without = 0;
  constexpr int kDraws = 6;
  for (int k = 0; k < kDraws; ++k) {
    // Quantiles of the normal distribution: the middles of six parts.
    const double quantiles[kDraws] = {-1.383, -0.674, -0.210, 0.210, 0.674, 1.383};
    GeometrySettings settings;
    const Seen seen = observe(truth(), 7, 0.05, 1, {settings.pupil * quantiles[k], {}});
    const std::vector<CornerObservation> corners = some_of(seen.corners);
    all += mean_pull2(calibrate_geometry(nominal(), corners, seen.centres, settings), truth(),
                      kLengths) /
           kDraws;
    if (k > 0) continue;  // of the farthest pupil
    settings.pupil = 0;
    without = mean_pull2(calibrate_geometry(nominal(), corners, seen.centres, settings), truth(),
                         kLengths);
  }
  EXPECT_GT(all, 0.5);
  EXPECT_LT(all, 1.4);
  EXPECT_GT(without, 10);
}

// Corners in soft micro-images are found too far from their middle, by another part in each type.
TEST(GeometryCalibration, ErrorsHoldCornersThatLieOutwards) {
  CameraSpec three = truth(), start = nominal();
  for (CameraSpec* camera : {&three, &start}) {
    camera->array.types = {{"a", kInfinity, kInfinity, 1.5, 0.55e-3},
                           {"b", kInfinity, kInfinity, 1.5, 0.50e-3},
                           {"c", kInfinity, kInfinity, 1.5, 0.60e-3}};
  }
  GeometrySettings settings;
  settings.pupil = 0;
  const Seen seen = observe(three, 7, 0.05, 1, {0, {0.06, 0.02, 0.03}});
  const GeometryCalibration found =
      calibrate_geometry(start, every_third(seen.corners), seen.centres, settings);
  for (const CalibratedValue& value : found.values)
    EXPECT_TRUE(within_standard_errors(value.value, value_of(three, value.key), value.error, 3))
        << value.key;
  // The fit takes the mean for a longer sensor distance; differences between types remain.
  ASSERT_EQ(found.outwards.size(), 3u);
  EXPECT_TRUE(relative(found.outwards[0] - found.outwards[1], 0.04, 0.1));
  EXPECT_TRUE(relative(found.outwards[2] - found.outwards[1], 0.01, 0.1));
  EXPECT_GT(found.outwards_scatter, 0.01);
  EXPECT_LT(found.outwards_scatter, 0.03);
}

// A printed board is not flat. The fit finds its points, where noise does not explain them.
TEST(GeometryCalibration, FindsABoardThatIsNotFlat) {
  GeometrySettings settings;
  settings.pupil = 0;
  const Deviations bent{0, {}, 0.3e-3};
  const Seen seen = observe(truth(), 7, 0.05, 1, bent);
  const GeometryCalibration found =
      calibrate_geometry(nominal(), some_of(seen.corners), seen.centres, settings);
  EXPECT_TRUE(relative(found.corner_rms, std::sqrt(2.0) * 0.05, 0.1));
  expect_stated_errors(found, truth());
  // The shape, but for a plane of its own: heights against the wave, both without their planes.
  ASSERT_EQ(found.board.size(), 35u);
  Eigen::MatrixXd plane(35, 3);
  Eigen::VectorXd heights(35), wave(35);
  for (int k = 0; k < 35; ++k) {
    const BoardPoint& point = found.board[static_cast<std::size_t>(k)];
    plane.row(k) << 1, point.nominal.x, point.nominal.y;
    heights(k) = point.offset.z;
    wave(k) = wave_at(bent, point.nominal);
  }
  const auto without_plane = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
    return v - plane * plane.colPivHouseholderQr().solve(v);
  };
  const double rest = (without_plane(heights) - without_plane(wave)).norm();
  EXPECT_LT(rest, 0.1 * without_plane(wave).norm());
  const Seen flat = observe(truth(), 7, 0.05);
  EXPECT_TRUE(
      calibrate_geometry(nominal(), some_of(flat.corners), flat.centres, settings).board.empty());
}

// Noise moves the values to both sides alike: it does not stretch micro-images.
TEST(GeometryCalibration, MuchNoiseDoesNotStretch) {
  GeometrySettings settings;
  settings.pupil = 0;
  const Seen seen = observe(truth(), 7, 1.0);
  const GeometryCalibration found =
      calibrate_geometry(nominal(), some_of(seen.corners), seen.centres, settings);
  for (const CalibratedValue& value : found.values)
    EXPECT_TRUE(within_standard_errors(value.value, value_of(truth(), value.key), value.error, 3))
        << value.key;
}

/// Radii of white micro-images: the stop's image, and a blur of its own for each type.
std::vector<RadiusObservation> radii_of(const CameraSpec& s, const std::vector<double>& blur) {
  std::vector<RadiusObservation> radii;
  for (const double n : {4.0, 5.6, 8.0})
    for (std::size_t t = 0; t < blur.size(); ++t) {
      const double cone = s.lens.focal_length / n / s.focus.lens_distance;
      const double stop = 0.5 * s.array.sensor_distance * cone / s.sensor.pixel_pitch;
      radii.push_back({n, t, std::hypot(stop, blur[t]), 0.01});
    }
  return radii;
}

// Corners of all types lie outwards alike: they tell a longer sensor distance. Radii tell the true
// one, and the focal length of the microlenses, which blurs them.
TEST(GeometryCalibration, RadiiTellTheSensorDistance) {
  GeometrySettings settings;
  settings.pupil = 0;
  const Seen seen = observe(truth(), 7, 0.05, 1, {0, {0.2, 0.2, 0.2}, 0});
  const std::vector<CornerObservation> corners = every_third(seen.corners);
  const double distance = truth().array.sensor_distance;
  const auto distance_of = [](const GeometryCalibration& found) {
    for (const CalibratedValue& value : found.values)
      if (value.key == "camera.array.sensor_distance") return value;
    return CalibratedValue();
  };
  const GeometryCalibration without =
      calibrate_geometry(nominal(), corners, seen.centres, settings);
  EXPECT_GT(distance_of(without).value, 1.08 * distance);
  const double blur = 0.5 * truth().array.diameter / truth().sensor.pixel_pitch *
                      std::fabs(1 - distance / 0.55e-3 + distance / truth().focus.lens_distance);
  settings.radii = radii_of(truth(), {blur});
  CameraSpec start = nominal();
  start.array.types[0].focal_length = 0.52e-3;
  const GeometryCalibration found = calibrate_geometry(start, corners, seen.centres, settings);
  const CalibratedValue value = distance_of(found);
  EXPECT_TRUE(within_standard_errors(value.value, distance, value.error, 2));
  EXPECT_LT(value.error, 0.06 * distance);
  EXPECT_TRUE(relative(found.camera.array.types[0].focal_length, 0.55e-3, 0.06));
  ASSERT_TRUE(found.radii.has_value());
  EXPECT_GT(found.radii->conflict, 2);
}

TEST(GeometryCalibration, RadiiTellASlope) {
  const std::vector<double> blur{4, 5};
  const RadiiSlope slope = radii_slope(radii_of(truth(), blur), 0.03);
  const double expected = 0.5 * 0.4e-3 * 0.0502 / 0.0567 / 5.5e-6;
  EXPECT_TRUE(relative(slope.slope, expected, 1e-9));
  EXPECT_TRUE(relative(slope_of_radii(truth()), expected, 1e-9));
  ASSERT_EQ(slope.blur.size(), 2u);
  EXPECT_TRUE(relative(slope.blur[0], 4, 1e-9));
  EXPECT_TRUE(relative(slope.blur[1], 5, 1e-9));
  EXPECT_GT(slope.relative_error, 0.03);
  EXPECT_LT(slope.relative_error, 0.031);
  EXPECT_THROW(radii_slope({{4, 0, 7, 0.01}, {4, 1, 8, 0.01}}, 0.03), InputError);
  EXPECT_THROW(radii_slope({{4, 0, 7, 0.01}, {8, 0, 8, 0.01}}, 0.03), InputError);
}

TEST(GeometryCalibration, WrongCornersAreLeftOut) {
  const Seen seen = observe(truth(), 6, 0.05);
  std::vector<CornerObservation> corners = some_of(seen.corners);
  for (std::size_t i = 0; i < corners.size(); i += 400) corners[i].pixel.x += 3;
  const std::size_t wrong = (corners.size() + 399) / 400;
  const GeometryCalibration found = calibrate_geometry(nominal(), corners, seen.centres);
  EXPECT_EQ(found.left_out, wrong);
  for (const CalibratedValue& value : found.values)
    EXPECT_TRUE(within_standard_errors(value.value, value_of(truth(), value.key), value.error, 4))
        << value.key;
}

// Boards that all face the camera, one of them: focal length, distances and the board's own go
// together.
TEST(GeometryCalibration, SaysWhatIsNotDetermined) {
  const Seen seen = observe(truth(), 1, 0.02, 0);
  for (const bool with_centres : {true, false}) try {
      calibrate_geometry(nominal(), seen.corners,
                         with_centres ? seen.centres : std::vector<CentreObservation>());
      FAIL() << "nothing was refused";
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("do not determine"), std::string::npos) << text;
      EXPECT_NE(text.find("_distance"), std::string::npos) << text;
      // Nobody is asked for what was given.
      EXPECT_EQ(text.find("centres of micro-images") == std::string::npos, with_centres) << text;
    }
}

TEST(GeometryCalibration, RefusesWhatCannotBe) {
  const Seen seen = observe(truth(), 3, 0.05);
  GeometrySettings settings;
  settings.free = {"camera.nonsense"};
  EXPECT_THROW(calibrate_geometry(nominal(), seen.corners, {}, settings), InputError);
  const std::vector<CornerObservation> few(seen.corners.begin(), seen.corners.begin() + 7);
  EXPECT_THROW(calibrate_geometry(nominal(), few, {}), InputError);
  EXPECT_THROW(calibrate_geometry(nominal(), {}, {}), InputError);
  CameraSpec real = truth();
  real.lens.surfaces = {{}};
  EXPECT_THROW(calibrate_geometry(real, seen.corners, {}), InputError);
}

}  // namespace
}  // namespace plenoflame::test::geometry_calibration_test
