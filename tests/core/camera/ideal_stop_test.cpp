// Which rays an ideal lens lets through, by similar triangles alone; and where rays meet a
// microlens.
#include <cmath>

#include "plenoflame/camera/camera.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"

namespace plenoflame::test::ideal_stop_test {
namespace {

/// A thin lens of 0.25 m with a stop in front of it; numbers that are exact in binary.
CameraSpec stop_in_front(double distance) {
  CameraSpec spec = small_scene({}, {}).camera;
  spec.lens.model = LensModel::ideal;
  spec.lens.surfaces = {{kInfinity, distance, 1, 0.015625, true},
                        {0.25, 0, 1.5, 0.25, false},
                        {-0.25, 0, 1, 0.25, false}};
  spec.focus.mode = FocusMode::distance;
  spec.focus.lens_distance = 0.3125;
  return spec;
}

bool passes(const Camera& camera, Vec2 sensor, Vec2 at_lens) {
  // The aim plane of an ideal lens without array is its rear principal plane: the thin lens.
  return camera.trace(sensor, std::nullopt, at_lens).status.status == RayStatus::reached;
}

/// Height on the stop of the ray from a sensor point through a point of the thin lens.
Vec2 on_stop(Vec2 sensor, Vec2 at_lens, double distance) {
  const Vec2 slope = (1 / 0.3125) * (at_lens - sensor);
  const Vec2 bent = slope - (1 / 0.25) * at_lens;
  return at_lens + distance * bent;
}

TEST(IdealStop, PassesWhatMeetsTheStop) {
  const double radius = 0.0078125;
  // Inside the focal length, in the focal plane (telecentric on the sensor's side), and beyond.
  for (const double distance : {0.0625, 0.25, 0.375}) {
    const Camera camera(stop_in_front(distance));
    if (distance == 0.25) {
      EXPECT_FALSE(std::isfinite(camera.exit_pupil()));
    }
    int inside = 0, outside = 0;
    for (int i = -20; i <= 20; ++i)
      for (int j = -20; j <= 20; ++j)
        for (const Vec2 sensor : {Vec2{0, 0}, Vec2{0.004, -0.003}}) {
          const Vec2 at_lens{1e-3 * i + 3e-5, 1e-3 * j - 2e-5};
          const double height = length(on_stop(sensor, at_lens, distance));
          if (std::fabs(height / radius - 1) < 1e-9) continue;
          EXPECT_EQ(passes(camera, sensor, at_lens), height < radius) << distance << " " << height;
          (height < radius ? inside : outside) += 1;
        }
    EXPECT_GT(inside, 50) << distance;
    EXPECT_GT(outside, 50) << distance;
  }
}

TEST(IdealStop, NearTheRimToRounding) {
  const double radius = 0.0078125, distance = 0.0625;
  const Camera camera(stop_in_front(distance));
  // Along a line from the axis outwards: height on the stop is linear in the height on the lens.
  const Vec2 sensor{0.002, 0.001};
  for (const double step : {-1e-9, 1e-9}) {
    // height(h) = |a h + b| with a = 1 + distance / 0.3125 - distance / 0.25.
    const double a = 1 + distance / 0.3125 - distance / 0.25;
    const Vec2 b = (-distance / 0.3125) * sensor;
    const Vec2 at_lens = (1 / a) * (Vec2{radius * (1 + step), 0} - b);
    EXPECT_EQ(passes(camera, sensor, at_lens), step < 0) << step;
  }
}

TEST(CameraPath, PointsLieOnTheFacesOfTheirMicrolens) {
  CameraSpec spec =
      small_scene(ideal_singlet(), large_array(plenoflame::Lattice::hexagonal, LensModel::real))
          .camera;
  const Camera camera(spec);
  const LensIndex lens{2, 1};
  const Vec2 centre = camera.lattice().centre(lens);
  ASSERT_GT(length(centre), 2e-3);
  const Camera::Path path =
      camera.trace(centre + Vec2{1e-4, -5e-5}, lens, centre + Vec2{2e-4, 1e-4}, true);
  ASSERT_GE(path.points.size(), 3u);
  const double radius = 2.25e-3;  // of both faces
  // Back face: its centre of curvature is on the scene's side; front face: on the sensor's.
  const Vec3 of_back{centre.x, centre.y, camera.array_back() + radius};
  const Vec3 of_front{centre.x, centre.y, camera.array_front() - radius};
  EXPECT_TRUE(relative(length(path.points[1] - of_back), radius, 1e-12));
  EXPECT_TRUE(relative(length(path.points[2] - of_front), radius, 1e-12));
  EXPECT_LT(std::hypot(path.points[1].x - centre.x, path.points[1].y - centre.y), 0.5e-3);
}

}  // namespace
}  // namespace plenoflame::test::ideal_stop_test
