#include "plenoflame/camera/lens_distortion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/pupil_sampling.h"
#include "plenoflame/lightfield/ground_truth.h"
#include "plenoflame/lightfield/micro_images.h"
#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::test::lens_distortion_test {
namespace {

constexpr double kK1 = -0.12, kK2 = 0.05, kK3 = -0.01, kP1 = 0.004, kP2 = -0.007;

/// The map as it stands in the manual of OpenCV, written out.
Vec2 closed_form(Vec2 u) {
  const double x = u.x, y = u.y, r = std::hypot(x, y);
  const double radial = 1 + kK1 * std::pow(r, 2) + kK2 * std::pow(r, 4) + kK3 * std::pow(r, 6);
  return {x * radial + 2 * kP1 * x * y + kP2 * (r * r + 2 * x * x),
          y * radial + kP1 * (r * r + 2 * y * y) + 2 * kP2 * x * y};
}

DistortionSpec distortion(double distance) {
  return {kK1, kK2, kK3, kP1, kP2, distance};
}

CameraSpec thin_camera(double distance) {
  CameraSpec camera;
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = 0.05;
  camera.lens.diameter = 0.0125;
  camera.lens.distortion = distortion(distance);
  camera.sensor = {400, 300, 8e-5};
  camera.focus.mode = FocusMode::distance;
  camera.focus.lens_distance = 0.0555;
  return camera;
}

CameraSpec thin_array(double distance) {
  CameraSpec camera = thin_camera(distance);
  camera.array.present = true;
  camera.array.model = LensModel::ideal;
  camera.array.lattice = Lattice::hexagonal;
  camera.array.pitch = camera.array.diameter = 3e-4;
  camera.array.types = {{"a", kInfinity, kInfinity, 1.5, 1.2e-3}};
  camera.array.sensor_distance = 1e-3;
  return camera;
}

TEST(LensDistortion, IsTheClosedFormAndItsInverse) {
  const LensDistortion map(distortion(kInfinity), 0);
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j) {
      const Vec2 u{0.05 * i, 0.04 * j}, v = map.distorted(u), expected = closed_form(u);
      EXPECT_LE(length(v - expected), 4e-16 * (1 + length(expected)));
      const auto back = map.undistorted(v);
      ASSERT_TRUE(back);
      EXPECT_LE(length(*back - u), 8e-16 * (1 + length(u)));
      // Areas by differences.
      constexpr double kStep = 1e-5;
      const Vec2 a = (0.5 / kStep) *
                     (closed_form(u + Vec2{kStep, 0}) - closed_form(u - Vec2{kStep, 0})),
                 b = (0.5 / kStep) *
                     (closed_form(u + Vec2{0, kStep}) - closed_form(u - Vec2{0, kStep}));
      EXPECT_TRUE(relative(map.area_ratio(u), a.x * b.y - a.y * b.x, 1e-8));
    }
}

// All rays of a sensor point that is conjugate to the plane meet there in one point, which the
// closed form images onto the sensor point.
TEST(LensDistortion, KeepsItsPlaneSharp) {
  const double image = 0.0555, object = 1 / (1 / 0.05 - 1 / image);
  const Camera camera(thin_camera(object));
  for (const Vec2 s : {Vec2{0.004, -0.002}, Vec2{-0.015, 0.01}}) {
    Vec2 first;
    for (int k = 0; k < 7; ++k) {
      const Vec2 aim = k == 0 ? Vec2{} : 0.006 * Vec2{std::cos(1.0 * k), std::sin(1.0 * k)};
      const Camera::Path path = camera.trace(s, std::nullopt, aim);
      ASSERT_EQ(path.status, TraceStatus{});
      const Vec3 p = path.exit.at((object - path.exit.origin.z) / path.exit.direction.z);
      if (k == 0) first = {p.x, p.y};
      EXPECT_LE(length(Vec2{p.x, p.y} - first), 1e-13 * object);
    }
    const Vec2 seen = closed_form((1 / object) * first);
    EXPECT_LE(length(-image * seen - s), 1e-14 * image);
  }
}

// A ray and its reverse; the etendue by differences of four numbers that say a ray.
TEST(LensDistortion, ForwardIsBackwardReversed) {
  CameraSpec spec = thin_camera(0.6);
  spec.lens.decentre = {0.001, -0.0005};
  spec.lens.tilt = {0.01, -0.02};
  const Camera camera(spec);
  const Vec2 s{0.011, -0.007}, aim{0.002, 0.003};
  const auto leave = [&](Vec2 from, Vec2 to) {
    const Ray ray = camera.trace(from, std::nullopt, to).exit;
    const Vec3 at = ray.at(-ray.origin.z / ray.direction.z);
    return std::array{at.x, at.y, ray.direction.x, ray.direction.y};
  };
  const Camera::Path path = camera.trace(s, std::nullopt, aim);
  ASSERT_EQ(path.status, TraceStatus{});
  std::vector<Camera::Arrival> arrivals;
  ASSERT_EQ(camera.trace_from_scene({path.exit.at(0.7), -path.exit.direction}, arrivals),
            TraceStatus{});
  ASSERT_EQ(arrivals.size(), 1u);
  EXPECT_LE(length(arrivals[0].sensor_point - s), 1e-13 * 0.0555);
  // d^2 place d^2(direction cosines) is solid angle times projected area; on the sensor from aims.
  const double step = 1e-6;
  double jacobian[4][4];
  for (int k = 0; k < 4; ++k) {
    const Vec2 ds = k < 2 ? step * Vec2{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0} : Vec2{};
    const Vec2 da = k < 2 ? Vec2{} : step * Vec2{k == 2 ? 1.0 : 0.0, k == 3 ? 1.0 : 0.0};
    const auto high = leave(s + ds, aim + da), low = leave(s - ds, aim - da);
    for (std::size_t i = 0; i < 4; ++i) jacobian[i][k] = (high[i] - low[i]) / (2 * step);
  }
  double determinant = 1;
  for (int c = 0; c < 4; ++c) {
    int pivot = c;
    for (int r = c + 1; r < 4; ++r)
      if (std::fabs(jacobian[r][c]) > std::fabs(jacobian[pivot][c])) pivot = r;
    if (pivot != c)
      for (int i = 0; i < 4; ++i) std::swap(jacobian[pivot][i], jacobian[c][i]);
    determinant *= jacobian[c][c];
    for (int r = c + 1; r < 4; ++r)
      for (int i = 3; i >= c; --i)
        jacobian[r][i] -= jacobian[r][c] / jacobian[c][c] * jacobian[c][i];
  }
  const double away = camera.aim_plane(0) - camera.sensor();
  const double cosine = away / std::hypot(away, length(aim - s));
  const double inside = std::pow(cosine, 4) / (away * away);
  EXPECT_TRUE(relative(arrivals[0].etendue_ratio, inside / std::fabs(determinant), 1e-6));
}

// Points of the plane have their images where the closed form moves those of the camera without
// distortion: by the array's chief rays.
TEST(LensDistortion, ProjectionsFollowTheClosedForm) {
  const double object = 0.2;
  CameraSpec spec = thin_array(object);
  const Camera bent(spec);
  spec.lens.distortion = {};
  const Camera straight(spec);
  const Vec3 look = straight.to_world().direction({0, 0, 1});
  ASSERT_EQ(look, (Vec3{1, 0, 0}));
  const Vec2 u{0.09, -0.06}, v = closed_form(u);
  const auto at = [&](Vec2 direction) {
    return straight.to_world().point({object * direction.x, object * direction.y, object});
  };
  const auto images = project_point(bent, at(u)), expected = project_point(straight, at(v));
  ASSERT_GT(expected.size(), 2u);
  ASSERT_EQ(images.size(), expected.size());
  for (std::size_t k = 0; k < images.size(); ++k)
    EXPECT_LE(length(images[k].pixel - expected[k].pixel), 1e-6 * 400);
}

// The lines that views and refocusing take, against the camera's own rays.
TEST(LensDistortion, ViewsTakeTheBentRays) {
  const Camera camera(thin_array(0.5));
  const MicroImages images(camera, false);
  const LensIndex lens{3, -2};
  const MicroImages::Place place = images.place(lens);
  ASSERT_FALSE(place.dark);
  const Vec2 s = place.centre + Vec2{2e-5, -4e-5};
  const Vec3 middle = camera.lens_place(lens);
  const Camera::Path path = camera.trace(s, lens, {middle.x, middle.y});
  ASSERT_EQ(path.status, TraceStatus{});
  const MicroImages::Line line = images.chief_ray(place, s);
  const Vec2 slope{path.exit.direction.x / path.exit.direction.z,
                   path.exit.direction.y / path.exit.direction.z};
  EXPECT_LE(length(line.slope - slope), 1e-6);
  const Vec2 there = images.to_plane(place, 0.8)(s);
  const Vec3 p = path.exit.at((0.8 - path.exit.origin.z) / path.exit.direction.z);
  EXPECT_LE(length(there - Vec2{p.x, p.y}), 1e-6 * 0.8);
}

TEST(LensDistortion, FoldsAreRefused) {
  CameraSpec spec = thin_camera(kInfinity);
  spec.lens.distortion = {-20, 0, 0, 0, 0, kInfinity};
  try {
    const Camera camera(spec);
    FAIL() << "nothing was refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("camera.lens.distortion cannot be undone"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace plenoflame::test::lens_distortion_test
