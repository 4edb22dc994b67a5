// Corners that a thin-lens model of its own projects, with noise: each value comes back within
// three of the standard deviations that go with it.
#include "plenoflame/calibration/geometry_calibration.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <cmath>
#include <random>

#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::test::geometry_calibration_test {
namespace {

CameraSpec truth() {
  CameraSpec camera;
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = 0.0502;
  camera.lens.diameter = 0.0125;
  camera.lens.decentre = {0.2e-3, -0.1e-3};
  camera.array.present = true;
  camera.array.model = LensModel::ideal;
  camera.array.pitch = camera.array.diameter = 126e-6;
  camera.array.rotation = 0.004;
  camera.array.offset = {20e-6, -30e-6};
  camera.array.sensor_distance = 0.40e-3;
  camera.array.types = {{"all", kInfinity, kInfinity, 1.5, 0.55e-3}};
  camera.sensor.columns = 1600;
  camera.sensor.rows = 1200;
  camera.sensor.pixel_pitch = 5.5e-6;
  camera.focus.mode = FocusMode::distance;
  camera.focus.lens_distance = 0.0567;
  return camera;
}

/// Sensor point of a point at p (camera axes) behind a microlens at c: the thin lens images p,
/// and a straight line goes from that through c.
Vec2 thin_projection(const CameraSpec& s, Vec3 p, Vec2 c) {
  const Vec2 d = s.lens.decentre;
  const Vec2 t{(p.x - d.x) / p.z, (p.y - d.y) / p.z};
  const double behind = 1 / (1 / s.lens.focal_length - 1 / p.z);
  const Vec2 image = d - behind * t;
  const double a = s.focus.lens_distance - behind;  // from the array to the image, towards the lens
  return c + (s.array.sensor_distance / a) * (c - image);
}

/// OpenCV's map from true to imaged directions.
Vec2 bent(const DistortionSpec& d, Vec2 t) {
  const double r2 = dot(t, t), radial = 1 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
  return radial * t + Vec2{2 * d.p1 * t.x * t.y + d.p2 * (r2 + 2 * t.x * t.x),
                           d.p1 * (r2 + 2 * t.y * t.y) + 2 * d.p2 * t.x * t.y};
}

/// The same of a lens that distorts. Through each place a of the lens a point is seen in the true
/// direction of a point of the plane at d.distance, and imaged as another point of that plane: a is
/// searched for from which the ray goes on through the middle of the microlens.
Vec2 bent_projection(const CameraSpec& s, Vec3 p, Vec2 c) {
  const DistortionSpec& d = s.lens.distortion;
  const double focus = d.distance, behind = 1 / (1 / s.lens.focal_length - 1 / focus);
  const double to_array = s.focus.lens_distance;
  const auto miss = [&](Vec2 a) {
    const Vec2 seen = a + (focus / p.z) * (Vec2{p.x, p.y} - a);
    const Vec2 t = (1 / focus) * (seen - s.lens.decentre);
    const Vec2 image = s.lens.decentre - behind * bent(d, t);
    return a + (to_array / behind) * (image - a) - c;
  };
  Vec2 a = s.lens.decentre;
  for (int step = 0; step < 20; ++step) {
    const double h = 1e-6;
    const Vec2 m = miss(a), u = (1 / h) * (miss(a + Vec2{h, 0}) - m),
               v = (1 / h) * (miss(a + Vec2{0, h}) - m);
    const double determinant = u.x * v.y - v.x * u.y;
    a = a - (1 / determinant) * Vec2{v.y * m.x - v.x * m.y, u.x * m.y - u.y * m.x};
  }
  return c + (s.array.sensor_distance / to_array) * (c - a);
}

struct Seen {
  std::vector<CornerObservation> corners;
  std::vector<CentreObservation> centres;
};

Seen observe(const CameraSpec& s, int poses, double noise, double tilts = 1) {
  const MicrolensLattice lattice(s.array);
  const Vec2 size = s.sensor.size();
  const auto pixel = [&](Vec2 at) {
    return Vec2{0.5 * s.sensor.columns - at.x / s.sensor.pixel_pitch,
                0.5 * s.sensor.rows - at.y / s.sensor.pixel_pitch};
  };
  std::mt19937_64 random(11);
  std::normal_distribution<double> error(0, noise);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double ratio = s.array.sensor_distance / s.focus.lens_distance;
  const auto centre_of = [&](Vec2 c) { return c + ratio * (c - s.lens.decentre); };
  const auto lenses = lattice.within(-0.5 * size, 0.5 * size);
  Seen seen;
  for (std::size_t i = 0; i < lenses.size(); i += 7) {
    const Vec2 at = pixel(centre_of(lattice.centre(lenses[i])));
    seen.centres.push_back({lenses[i], at + Vec2{error(random), error(random)}});
  }
  for (int pose = 0; pose < poses; ++pose) {
    const Vec3 angles{0.5 * uniform(random), 0.5 * uniform(random), 0.4 * uniform(random)};
    const Mat3 turn = rotation_xyz(tilts * angles);
    const Vec3 place{2e-3 * uniform(random), 2e-3 * uniform(random), 0.33 + 0.03 * uniform(random)};
    for (int i = -3; i <= 3; ++i)
      for (int j = -2; j <= 2; ++j) {
        const Vec2 board{7e-3 * i, 7e-3 * j};
        const Vec3 p = turn * Vec3{board.x, board.y, 0} + place;
        for (std::size_t k = 0; k < lenses.size(); ++k) {
          const Vec2 c = lattice.centre(lenses[k]);
          const Vec2 at =
              s.lens.distortion.none() ? thin_projection(s, p, c) : bent_projection(s, p, c);
          if (length(at - centre_of(c)) > 9 * s.sensor.pixel_pitch ||
              std::fabs(at.x) > 0.5 * size.x || std::fabs(at.y) > 0.5 * size.y)
            continue;
          seen.corners.push_back(
              {pose, board, pixel(at) + Vec2{error(random), error(random)}, lenses[k]});
        }
      }
  }
  return seen;
}

/// Nominal values, as a data sheet gives them.
CameraSpec nominal() {
  CameraSpec camera = truth();
  camera.lens.focal_length = 0.05;
  camera.focus.lens_distance = 0.0565;
  camera.array.sensor_distance = 0.39e-3;
  camera.lens.decentre = {};
  camera.array.offset = {15e-6, -24e-6};
  camera.array.rotation = 0.0041;
  return camera;
}

double value_of(const CameraSpec& camera, const std::string& key) {
  if (key == "camera.lens.focal_length") return camera.lens.focal_length;
  if (key == "camera.focus.lens_distance") return camera.focus.lens_distance;
  if (key == "camera.array.sensor_distance") return camera.array.sensor_distance;
  if (key == "camera.lens.decentre[0]") return camera.lens.decentre.x;
  if (key == "camera.lens.decentre[1]") return camera.lens.decentre.y;
  if (key == "camera.array.offset[0]") return camera.array.offset.x;
  if (key == "camera.array.offset[1]") return camera.array.offset.y;
  if (key == "camera.array.pitch") return camera.array.pitch;
  if (key == "camera.array.rotation") return camera.array.rotation;
  if (key == "camera.array.tilt[0]") return camera.array.tilt.x;
  if (key == "camera.array.tilt[1]") return camera.array.tilt.y;
  const DistortionSpec& d = camera.lens.distortion;
  if (key == "camera.lens.distortion.k1") return d.k1;
  if (key == "camera.lens.distortion.k2") return d.k2;
  if (key == "camera.lens.distortion.k3") return d.k3;
  if (key == "camera.lens.distortion.p1") return d.p1;
  if (key == "camera.lens.distortion.p2") return d.p2;
  if (key == "camera.lens.distortion.distance") return d.distance;
  ADD_FAILURE() << key;
  return 0;
}

TEST(GeometryCalibration, WithoutNoiseTheCameraItself) {
  const Seen seen = observe(truth(), 6, 0);
  ASSERT_GT(seen.corners.size(), 1000u);
  const GeometryCalibration found = calibrate_geometry(nominal(), seen.corners, seen.centres);
  EXPECT_LT(found.corner_rms, 1e-6);
  EXPECT_EQ(found.left_out, 0u);
  for (const CalibratedValue& value : found.values)
    EXPECT_TRUE(within(value.value, value_of(truth(), value.key), 1e-6,
                       std::max(std::fabs(value.value), 1e-3)))
        << value.key;
}

TEST(GeometryCalibration, ValuesWithinTheirErrors) {
  const double noise = 0.05;
  const Seen seen = observe(truth(), 7, noise);
  const GeometryCalibration found = calibrate_geometry(nominal(), seen.corners, seen.centres);
  EXPECT_TRUE(relative(found.corner_rms, std::sqrt(2.0) * noise, 0.05));
  EXPECT_TRUE(relative(found.centre_rms, std::sqrt(2.0) * noise, 0.05));
  EXPECT_EQ(found.values.size(), 11u);
  double chi2 = 0;
  for (const CalibratedValue& value : found.values) {
    EXPECT_TRUE(within_standard_errors(value.value, value_of(truth(), value.key), value.error, 3))
        << value.key;
    chi2 += std::pow((value.value - value_of(truth(), value.key)) / value.error, 2);
  }
  // Errors that are far too large would pass the above.
  EXPECT_GT(chi2, 1);
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
    calibrate_geometry(start, seen.corners, seen.centres, settings);
  } catch (const InputError& error) {
    message = error.what();
  }
  EXPECT_NE(message.find("ran away: camera.array.sensor_distance went from 150 um to 4"),
            std::string::npos)
      << message;
}

CameraSpec distorting() {
  CameraSpec camera = truth();
  camera.lens.distortion = {0.7, -25, 0, 0.004, -0.006, 0.33};
  return camera;
}

TEST(GeometryCalibration, DistortionComesBack) {
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
  const GeometryCalibration found = calibrate_geometry(nominal(), seen.corners, seen.centres);
  EXPECT_TRUE(relative(found.corner_rms, std::sqrt(2.0) * noise, 0.03));
  ASSERT_EQ(found.values.size(), 11u);
  expect_stated_errors(found, truth());
}

/// Every third corner, which is enough and takes a third of the time.
std::vector<CornerObservation> every_third(const std::vector<CornerObservation>& corners) {
  std::vector<CornerObservation> some;
  for (std::size_t i = 0; i < corners.size(); i += 3) some.push_back(corners[i]);
  return some;
}

// The same with distortion, of whose plane the start knows nothing.
TEST(GeometryCalibration, FifteenPosesTellDistortion) {
  const double noise = 0.05;
  const Seen seen = observe(distorting(), 15, noise);
  GeometrySettings settings;
  settings.free = {"usual", "camera.lens.distortion"};
  const GeometryCalibration found =
      calibrate_geometry(nominal(), every_third(seen.corners), seen.centres, settings);
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
  const GeometryCalibration found =
      calibrate_geometry(nominal(), every_third(seen.corners), seen.centres, settings);
  ASSERT_EQ(found.values.size(), 16u);
  expect_stated_errors(found, truth());
  const CameraSpec start = nominal();
  EXPECT_TRUE(relative(found.camera.lens.distortion.distance,
                       1 / (1 / start.lens.focal_length - 1 / start.focus.lens_distance), 1e-12));
}

TEST(GeometryCalibration, WrongCornersAreLeftOut) {
  Seen seen = observe(truth(), 6, 0.05);
  for (std::size_t i = 0; i < seen.corners.size(); i += 400) seen.corners[i].pixel.x += 3;
  const std::size_t wrong = (seen.corners.size() + 399) / 400;
  const GeometryCalibration found = calibrate_geometry(nominal(), seen.corners, seen.centres);
  EXPECT_EQ(found.left_out, wrong);
  for (const CalibratedValue& value : found.values)
    EXPECT_TRUE(within_standard_errors(value.value, value_of(truth(), value.key), value.error, 4))
        << value.key;
}

// Boards that all face the camera, one of them: focal length, distances and the board's own go
// together.
TEST(GeometryCalibration, SaysWhatIsNotDetermined) {
  const Seen seen = observe(truth(), 1, 0.02, 0);
  try {
    calibrate_geometry(nominal(), seen.corners, seen.centres);
    FAIL() << "nothing was refused";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("do not determine"), std::string::npos) << text;
    EXPECT_NE(text.find("_distance"), std::string::npos) << text;
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
