#include <gtest/gtest.h>

#include <random>

#include "plenoflame/camera/camera.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::trace_from_scene_test {
namespace {

/// Sends rays from the sensor to the scene and back again: both ways are traced by other code, but
/// light takes the same one. @return how many rays made it
int retrace(const CameraSpec& spec) {
  const Camera camera(spec);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int reached = 0;
  for (int i = 0; i < 4000; ++i) {
    const double size = 0.5 * spec.sensor.columns * spec.sensor.pixel_pitch;
    const Vec2 sensor_point{size * uniform(random), size * uniform(random)};
    std::optional<LensIndex> lens;
    Vec2 aim{0.05 * uniform(random), 0.05 * uniform(random)};
    if (camera.has_array()) {
      lens = camera.lattice().nearest(sensor_point +
                                      Vec2{3e-4 * uniform(random), 3e-4 * uniform(random)});
      const Vec3 place = camera.lens_place(*lens);
      aim = Vec2{place.x, place.y} +
            0.5 * spec.array.diameter * Vec2{uniform(random), uniform(random)};
    }
    const Camera::Path path = camera.trace(sensor_point, lens, aim);
    if (path.status.status != RayStatus::reached) continue;
    ++reached;
    std::vector<Camera::Arrival> arrivals;
    const Ray back{path.exit.at(1.0), -path.exit.direction};
    EXPECT_EQ(camera.trace_from_scene(back, arrivals).status, RayStatus::reached);
    bool found = false;
    for (const Camera::Arrival& arrival : arrivals) {
      if (arrival.lens != lens) continue;
      found = true;
      // A metre of way and focal lengths of millimetres multiply roundings of 1e-16.
      EXPECT_TRUE(within(arrival.sensor_point.x, sensor_point.x, 1e-11, size));
      EXPECT_TRUE(within(arrival.sensor_point.y, sensor_point.y, 1e-11, size));
      if (!camera.ideal_lens() && !camera.ideal_array()) {
        EXPECT_EQ(arrival.etendue_ratio, 1.0);
      }
    }
    EXPECT_TRUE(found) << "ray " << i << " came back through another lens";
  }
  return reached;
}

TEST(TraceFromScene, RetracesRealHexagonalArray) {
  EXPECT_GT(
      retrace(small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real)).camera),
      500);
}
TEST(TraceFromScene, RetracesMisalignedCameras) {
  for (const LensModel model : {LensModel::real, LensModel::ideal}) {
    CameraSpec spec = small_scene(model == LensModel::real ? singlet() : ideal_singlet(),
                                  large_array(Lattice::hexagonal, model))
                          .camera;
    spec.lens.decentre = {1e-3, -2e-3};
    spec.lens.tilt = {0.01, 0.02};
    spec.array.tilt = {0.04, -0.03};
    spec.array.focal_jitter = 0.05;
    EXPECT_GT(retrace(spec), 500);
  }
}
TEST(TraceFromScene, RetracesAnAsphericLens) {
  CameraSpec spec = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real)).camera;
  spec.lens.surfaces[0].conic = -0.8;
  spec.lens.surfaces[1].aspheric = {1.2, 0, -900};
  EXPECT_GT(retrace(spec), 500);
}
TEST(TraceFromScene, RetracesRealSquareArray) {
  EXPECT_GT(retrace(small_scene(singlet(), large_array(Lattice::square, LensModel::real)).camera),
            500);
}
TEST(TraceFromScene, RetracesIdealLensAndArray) {
  EXPECT_GT(
      retrace(
          small_scene(ideal_singlet(), large_array(Lattice::hexagonal, LensModel::ideal)).camera),
      500);
}
TEST(TraceFromScene, RetracesBareCamera) {
  EXPECT_GT(retrace(small_scene(singlet(), {}).camera), 500);
  EXPECT_GT(retrace(small_scene(ideal_singlet(), {}).camera), 500);
}

/// Volume of the map from (x, y, direction cosines) in the scene to those on the sensor, by central
/// differences: what a thin beam's solid angle times area is multiplied by.
double etendue_ratio_by_differences(const Camera& camera, Vec2 at, Vec2 cosines) {
  const auto end = [&](const double* v) {
    const double z = -std::sqrt(1 - v[2] * v[2] - v[3] * v[3]);
    std::vector<Camera::Arrival> arrivals;
    camera.trace_from_scene({{v[0], v[1], 0.5}, {v[2], v[3], z}}, arrivals);
    // The direction on the sensor from where the same ray meets the plane of an ideal lens: without
    // array, height h there and arrival give it.
    const double slope_x = v[2] / z, slope_y = v[3] / z;
    const double reach = camera.ideal().front_principal - 0.5;
    const Vec2 h{v[0] + reach * slope_x, v[1] + reach * slope_y};
    const Vec2 s = arrivals.at(0).sensor_point;
    const Vec3 d =
        normalize({s.x - h.x, s.y - h.y, camera.sensor() - camera.ideal().rear_principal});
    return std::array<double, 4>{s.x, s.y, d.x, d.y};
  };
  const double v0[4] = {at.x, at.y, cosines.x, cosines.y};
  double m[4][4];
  for (int j = 0; j < 4; ++j) {
    double plus[4], minus[4];
    for (int i = 0; i < 4; ++i) plus[i] = minus[i] = v0[i];
    const double step = 1e-5;
    plus[j] += step, minus[j] -= step;
    const auto a = end(plus), b = end(minus);
    for (std::size_t i = 0; i < 4; ++i) m[i][j] = (a[i] - b[i]) / (2 * step);
  }
  double determinant = 1;
  for (int k = 0; k < 4; ++k) {
    int pivot = k;
    for (int i = k + 1; i < 4; ++i)
      if (std::fabs(m[i][k]) > std::fabs(m[pivot][k])) pivot = i;
    std::swap(m[k], m[pivot]);
    determinant *= m[k][k];
    for (int i = k + 1; i < 4; ++i)
      for (int j = 3; j >= k; --j) m[i][j] -= m[i][k] / m[k][k] * m[k][j];
  }
  return std::fabs(determinant);
}

TEST(TraceFromScene, IdealLensChangesEtendueAsStated) {
  const Camera camera(small_scene(ideal_singlet(), {}).camera);
  for (const auto& [at, cosines] : {std::pair{Vec2{0.05, 0.01}, Vec2{-0.04, 0.03}},
                                    std::pair{Vec2{-0.1, 0.02}, Vec2{0.25, 0.0}}}) {
    std::vector<Camera::Arrival> arrivals;
    const double z = -std::sqrt(1 - dot(cosines, cosines));
    camera.trace_from_scene({{at.x, at.y, 0.5}, {cosines.x, cosines.y, z}}, arrivals);
    ASSERT_EQ(arrivals.size(), 1u);
    EXPECT_TRUE(relative(arrivals[0].etendue_ratio,
                         etendue_ratio_by_differences(camera, at, cosines), 1e-7));
    EXPECT_GT(std::fabs(arrivals[0].etendue_ratio - 1), 1e-3);
  }
}

TEST(TraceFromScene, BetweenTheLenses) {
  CameraSpec spec =
      small_scene(ideal_singlet(), large_array(Lattice::square, LensModel::real)).camera;
  spec.array.diameter = 0.8e-3;
  const auto arrivals_at_corner = [&] {
    const Camera camera(spec);
    // Along the axis of a thin beam: through the corner between four lenses, away from the axis.
    const Vec3 corner{0.5e-3, 0.5e-3, camera.array_front()};
    const IdealLens& lens = camera.ideal();
    const Vec2 slope{corner.x / (corner.z - lens.rear_principal),
                     corner.y / (corner.z - lens.rear_principal)};
    std::vector<Camera::Arrival> arrivals;
    const Vec3 direction = -normalize({slope.x, slope.y, 1});
    const Ray ray{Vec3{0, 0, lens.front_principal} - direction, direction};
    const TraceStatus status = camera.trace_from_scene(ray, arrivals);
    if (arrivals.empty()) {
      EXPECT_EQ(status, (TraceStatus{RayStatus::vignetted, 1}));
    } else {
      // Straight on from the corner.
      const double expected = corner.x + slope.x * (camera.sensor() - corner.z);
      EXPECT_FALSE(arrivals[0].lens.has_value());
      EXPECT_TRUE(relative(arrivals[0].sensor_point.x, expected, 1e-12));
    }
    return arrivals.size();
  };
  EXPECT_EQ(arrivals_at_corner(), 0u);
  spec.array.opaque_between = false;
  EXPECT_EQ(arrivals_at_corner(), 1u);
}

}  // namespace
}  // namespace plenoflame::test::trace_from_scene_test
