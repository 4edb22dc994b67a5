// Bundles beyond single pixels: rays of a point find back to it, samples in the flame are the
// flame's, and a selection keeps what it says.
#include <algorithm>
#include <cmath>
#include <set>

#include "plenoflame/base/error.h"
#include "plenoflame/render/ray_paths.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"

namespace plenoflame::test::ray_bundles_test {
namespace {

CompiledScene small(LensModel lens, LensModel array) {
  return compile(small_scene(lens == LensModel::real ? singlet() : ideal_singlet(),
                             large_array(Lattice::hexagonal, array)));
}

struct Models {
  LensModel lens, array;
};

class ObjectRays : public ::testing::TestWithParam<Models> {};

TEST_P(ObjectRays, TracedBackFromTheSensorTheyMeetThePoint) {
  const CompiledScene scene = small(GetParam().lens, GetParam().array);
  const Camera& camera = scene.camera;
  const Vec3 point{1.02, 0.004, -0.003};
  RayPaths paths = empty_ray_paths(scene);
  add_object_rays(scene, point, 300, paths);
  ASSERT_EQ(paths.rays.size(), 300U);
  int arrived = 0;
  for (const RayPath& ray : paths.rays) {
    const RayVertex* const v = paths.vertices.data() + ray.first;
    EXPECT_EQ(v[0].surface, kObjectVertex);
    EXPECT_TRUE(v[0].position == point);
    for (std::size_t k = 1; k < ray.count; ++k)
      EXPECT_TRUE(relative(v[k].distance,
                           v[k - 1].distance + length(v[k].position - v[k - 1].position), 1e-12));
    if (ray.status.status != RayStatus::reached) continue;
    ++arrived;
    const RayVertex& end = v[ray.count - 1];
    EXPECT_EQ(end.surface, kSensorVertex);
    // The same way backwards: another function, from the sensor point and where it aims.
    const RigidTransform to_camera = camera.to_world().inverse();
    const Vec3 start = to_camera.point(end.position);
    const Vec3 before = to_camera.point(v[ray.count - 2].position);
    const double t = (camera.aim_plane(ray.type) - start.z) / (before.z - start.z);
    const Vec3 aim = start + t * (before - start);
    const Camera::Path back = camera.trace({start.x, start.y}, ray.lens, {aim.x, aim.y});
    ASSERT_EQ(back.status.status, RayStatus::reached);
    const Vec3 target = to_camera.point(point);
    const Vec3 miss = cross(target - back.exit.origin, back.exit.direction);
    // The aim is 2.5 mm away and the point 1 m: rounding of 1e-16 m grows by 400 and more.
    EXPECT_TRUE(within(length(miss), 0, 1e-9, 1.0));
    // Pixel: counted from the upper left corner, columns against camera x.
    EXPECT_EQ(ray.column, static_cast<int>(std::floor(30 - start.x / 0.2e-3)));
    EXPECT_EQ(ray.row, static_cast<int>(std::floor(30 - start.y / 0.2e-3)));
  }
  EXPECT_GT(arrived, 100);
}

INSTANTIATE_TEST_SUITE_P(Models, ObjectRays,
                         ::testing::Values(Models{LensModel::real, LensModel::real},
                                           Models{LensModel::ideal, LensModel::real},
                                           Models{LensModel::real, LensModel::ideal},
                                           Models{LensModel::ideal, LensModel::ideal}));

TEST(ObjectRays, PointBehindTheCameraIsRefused) {
  const CompiledScene scene = small(LensModel::real, LensModel::real);
  RayPaths paths = empty_ray_paths(scene);
  EXPECT_THROW(add_object_rays(scene, {-0.1, 0, 0}, 10, paths), InputError);
  EXPECT_THROW(add_object_rays(scene, {1, 0, 0}, 0, paths), UsageError);
}

TEST(RayBundles, FlameSamplesAreTheFlame) {
  const CompiledScene scene = small(LensModel::real, LensModel::real);
  const FlameSpec& flame = scene.scene.flames[0];
  RayPaths paths = empty_ray_paths(scene);
  paths.flame_samples = 40;
  RenderSettings settings;
  settings.samples = 16;
  add_pixel_rays(scene, settings, {{30, 30}, {28, 33}}, {}, paths);
  int inside = 0;
  for (const RayPath& ray : paths.rays) {
    std::size_t samples = 0;
    for (std::size_t k = ray.first; k < ray.first + ray.count; ++k) {
      const RayVertex& v = paths.vertices[k];
      samples += v.surface == kFlameVertex;
      if (v.surface >= kSensorVertex) {
        EXPECT_EQ(v.absorption, 0);
      }
      if (v.surface != kFlameVertex) continue;
      // The first ellipsoid that holds the point.
      double kappa = 0, hot = 0, margin = 1;
      for (const EllipsoidSpec& layer : flame.layers) {
        const Vec3 d = v.position - flame.position - layer.centre;
        const double r =
            std::hypot(d.x / layer.semi_axes.x, d.y / layer.semi_axes.y, d.z / layer.semi_axes.z);
        margin = std::min(margin, std::fabs(r - 1));
        if (r < 1 && kappa == 0) {
          kappa = layer.absorption;
          hot = layer.temperature;
        }
      }
      if (margin < 1e-9) continue;
      EXPECT_EQ(v.absorption, kappa);
      if (kappa > 0) {
        EXPECT_EQ(v.temperature, hot);
      }
      inside += kappa > 0;
    }
    EXPECT_TRUE(samples == 0 || samples == 40) << samples;
  }
  EXPECT_GT(inside, 100);
}

TEST(RayBundles, MicrolensThatLightsNothingIsRefused) {
  const CompiledScene scene = small(LensModel::real, LensModel::real);
  RayPaths paths = empty_ray_paths(scene);
  RenderSettings settings;
  EXPECT_THROW(add_microlens_rays(scene, settings, {1000, 0}, {}, paths), UsageError);
}

/// Rays whose number is their weight, with i % 3 + 1 vertices each.
RayPaths numbered(int count) {
  RayPaths paths;
  paths.channels = {"a", "b"};
  for (int i = 0; i < count; ++i) {
    RayPath ray;
    ray.weight = i;
    ray.type = i % 4 - 1;
    ray.status.status = static_cast<RayStatus>(i % 3);
    ray.first = paths.vertices.size();
    ray.count = static_cast<std::size_t>(i % 3 + 1);
    for (std::size_t k = 0; k < ray.count; ++k)
      paths.vertices.push_back({{static_cast<double>(i), static_cast<double>(k), 0}, 0, 1, 0});
    paths.rays.push_back(ray);
    paths.radiance.push_back(10.0 * i);
    paths.radiance.push_back(10.0 * i + 1);
  }
  return paths;
}

/// Checks that every ray still has its own vertices and radiances.
void expect_consistent(const RayPaths& paths) {
  std::size_t first = 0;
  for (std::size_t i = 0; i < paths.rays.size(); ++i) {
    const RayPath& ray = paths.rays[i];
    ASSERT_EQ(ray.first, first);
    ASSERT_EQ(ray.count, static_cast<std::size_t>(static_cast<int>(ray.weight) % 3 + 1));
    for (std::size_t k = 0; k < ray.count; ++k) {
      ASSERT_EQ(paths.vertices[first + k].position.x, ray.weight);
      ASSERT_EQ(paths.vertices[first + k].position.y, static_cast<double>(k));
    }
    ASSERT_EQ(paths.radiance_of(i, 1), 10 * ray.weight + 1);
    first += ray.count;
  }
  ASSERT_EQ(paths.vertices.size(), first);
  ASSERT_EQ(paths.radiance.size(), 2 * paths.rays.size());
}

TEST(RaySelection, KeepsStatusesAndTypes) {
  RayPaths paths = numbered(120);
  RaySelection selection;
  selection.statuses = {RayStatus::vignetted, RayStatus::total_internal_reflection};
  selection.types = {-1, 2};
  select_rays(selection, paths);
  expect_consistent(paths);
  std::vector<int> expected, kept;
  for (int i = 0; i < 120; ++i)
    if (i % 3 != 0 && (i % 4 == 0 || i % 4 == 3)) expected.push_back(i);
  for (const RayPath& ray : paths.rays) kept.push_back(static_cast<int>(ray.weight));
  EXPECT_EQ(kept, expected);
}

TEST(RaySelection, ThinnedRaysAreSpreadEvenly) {
  for (const std::size_t most : {1U, 7U, 64U, 333U, 999U}) {
    RayPaths paths = numbered(1000);
    RaySelection selection;
    selection.most = most;
    select_rays(selection, paths);
    expect_consistent(paths);
    ASSERT_EQ(paths.rays.size(), most);
    std::set<int> kept;
    for (std::size_t i = 0; i < most; ++i) {
      const double number = paths.rays[i].weight;
      kept.insert(static_cast<int>(number));
      // One out of each stretch of the list.
      EXPECT_GE(number, std::floor(1000.0 * static_cast<double>(i) / static_cast<double>(most)));
      EXPECT_LT(number, std::ceil(1000.0 * static_cast<double>(i + 1) / static_cast<double>(most)));
    }
    EXPECT_EQ(kept.size(), most);
  }
  RayPaths paths = numbered(5);
  RaySelection selection;
  selection.most = 10;
  select_rays(selection, paths);
  EXPECT_EQ(paths.rays.size(), 5U);
}

}  // namespace
}  // namespace plenoflame::test::ray_bundles_test
