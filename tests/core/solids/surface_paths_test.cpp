// Exported rays in scenes with solid surfaces: they end at the first one, carry what it sends, and
// sum to the image.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "core/solids/surface_samples.h"
#include "plenoflame/render/ray_paths.h"
#include "render/estimators/backward.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"

namespace plenoflame::test::surface_paths_test {
namespace {

constexpr double kPi = 3.14159265358979323846;
const Vec3 kBall{0.99, 3e-3, 0};
constexpr double kRadius = 4e-3, kWall = 1.02;

SolidSurfaceSpec wall() {
  SolidSurfaceSpec spec = shaped(SolidShape::plane, 1);
  spec.extent = {0.02, 0.02};
  spec.position = {kWall, 0, 0};
  spec.rotation = {0, -0.5 * kPi, 0};
  return spec;
}

/// A flame in front of a ball in front of a small wall, under a lamp and the sky.
Scene crowded() {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  SolidSurfaceSpec ball = shaped(SolidShape::sphere, kRadius);
  ball.position = kBall;
  scene.surfaces = {ball, wall()};
  scene.flames[0].position.x = 0.97;
  LightSpec lamp, sky;
  lamp.position = {0.8, 0.2, 0.2};
  lamp.power = 30;
  sky.kind = LightKind::environment;
  sky.radiance = 100;
  scene.lights = {lamp, sky};
  scene.render.reflections = 2;
  return scene;
}

RayPaths paths_of(const CompiledScene& scene, const RenderSettings& settings, PixelWindow window) {
  std::vector<Pixel> pixels;
  for (int y = window.y; y < window.y + window.height; ++y)
    for (int x = window.x; x < window.x + window.width; ++x) pixels.push_back({x, y});
  RayPaths paths = empty_ray_paths(scene);
  add_pixel_rays(scene, settings, pixels, one_thread(), paths);
  return paths;
}

TEST(SurfacePaths, SumIsTheFluxOfThePixel) {
  const CompiledScene scene = compile(crowded(), load_core_medium, one_thread());
  RenderSettings settings;
  settings.samples = 24;
  settings.replicates = 2;
  settings.precision = Precision::double_precision;
  const PixelWindow window{22, 22, 16, 16};
  const RayPaths paths = paths_of(scene, settings, window);
  Film film(window, 1, 2);
  RenderStatistics statistics;
  ASSERT_TRUE(BackwardPass(scene, settings, {{0, 12}}, BackwardShared(scene, settings, {}))
                  .run({{0}}, one_thread(), film, statistics));
  std::map<std::pair<int, int>, double> sums;
  for (std::size_t i = 0; i < paths.rays.size(); ++i)
    sums[{paths.rays[i].column, paths.rays[i].row}] +=
        paths.rays[i].weight * paths.radiance_of(i, 0);
  int lit = 0;  // at the rims of micro-images none of so few rays may get through
  for (int y = 22; y < 38; ++y)
    for (int x = 22; x < 38; ++x) {
      const double flux = (film.sum(0, 0, x, y) + film.sum(0, 1, x, y)) / 24;
      lit += flux > 0;
      EXPECT_TRUE(relative(sums[{x, y}], flux, 1e-12)) << x << "," << y;
    }
  EXPECT_GT(lit, 240);
}

/// The distance of a line from the middle of the ball.
double beside_ball(Vec3 from, Vec3 towards) {
  const Vec3 d = normalize(towards - from), to = kBall - from;
  return length(to - dot(to, d) * d);
}

TEST(SurfacePaths, RaysEndAtTheFirstSurface) {
  Scene scene = crowded();
  scene.lights.pop_back();  // no sky: what meets nothing carries only the flame
  scene.flames.clear();
  const CompiledScene compiled = compile(scene, load_core_medium, one_thread());
  RenderSettings settings;
  settings.samples = 16;
  const RayPaths paths = paths_of(compiled, settings, {16, 16, 28, 28});
  int on_ball = 0, on_wall = 0, free = 0;
  for (std::size_t i = 0; i < paths.rays.size(); ++i) {
    const RayPath& ray = paths.rays[i];
    const RayVertex& last = paths.vertices[ray.first + ray.count - 1];
    if (ray.status.status != RayStatus::reached) {
      EXPECT_EQ(ray.solid, -1);
      continue;
    }
    std::size_t front = ray.first;  // where it left the camera, far from all else
    while (paths.vertices[front].surface != 0) ++front;
    const Vec3 before = paths.vertices[front].position;
    const double beside = beside_ball(before, last.position);
    if (ray.solid == 0) {
      ++on_ball;
      EXPECT_EQ(last.surface, kSolidVertex);
      EXPECT_TRUE(relative(length(last.position - kBall), kRadius, 1e-10));
      EXPECT_LT(dot(last.position - kBall, last.position - before), 0);  // its near side
    } else if (ray.solid == 1) {
      ++on_wall;
      EXPECT_EQ(last.surface, kSolidVertex);
      EXPECT_TRUE(relative(last.position.x, kWall, 1e-12));
      EXPECT_GE(beside, kRadius * (1 - 1e-9));  // nothing behind the ball
    } else {
      ++free;
      EXPECT_NE(last.surface, kSolidVertex);
      EXPECT_GE(beside, kRadius * (1 - 1e-9));
      EXPECT_EQ(paths.radiance_of(i, 0), 0.0);
    }
  }
  EXPECT_GT(on_ball, 100);
  EXPECT_GT(on_wall, 100);
  EXPECT_GT(free, 100);
}

TEST(SurfacePaths, CarryTheRadianceOfTheSurface) {
  Scene scene = crowded();
  scene.flames.clear();
  scene.lights.clear();
  for (SolidSurfaceSpec& surface : scene.surfaces) {
    surface.material.kind = MaterialKind::blackbody;
    surface.material.temperature = 1300;
  }
  const CompiledScene compiled = compile(scene, load_core_medium, one_thread());
  RenderSettings settings;
  settings.samples = 4;
  RayPaths paths = paths_of(compiled, settings, {24, 24, 12, 12});
  add_chief_rays(compiled, paths);
  const double glow = 5.670374419e-8 * std::pow(1300.0, 4) / kPi;
  int chief = 0;
  for (std::size_t i = 0; i < paths.rays.size(); ++i) {
    const bool hit = paths.rays[i].solid >= 0;
    chief += hit && paths.rays[i].weight == 0;
    EXPECT_TRUE(relative(paths.radiance_of(i, 0), hit ? glow : 0.0, 1e-8)) << i;
  }
  EXPECT_GT(chief, 3);
}

TEST(SurfacePaths, RaysOfAPointEndWhereASurfaceBlocksThem) {
  Scene scene = crowded();
  scene.flames.clear();
  const CompiledScene compiled = compile(scene, load_core_medium, one_thread());
  // Behind the middle of the ball, close by: all are blocked, and on its far side.
  RayPaths paths = empty_ray_paths(compiled);
  add_object_rays(compiled, kBall + Vec3{2 * kRadius, 0, 0}, 50, paths);
  for (const RayPath& ray : paths.rays) {
    EXPECT_EQ(ray.status.status, RayStatus::missed);
    EXPECT_EQ(ray.solid, 0);
    const RayVertex& last = paths.vertices[ray.first + ray.count - 1];
    EXPECT_TRUE(relative(length(last.position - kBall), kRadius, 1e-10));
    EXPECT_GT(last.position.x, kBall.x);
  }
  // A point on the wall beside the ball is free to be seen.
  RayPaths seen = empty_ray_paths(compiled);
  add_object_rays(compiled, {kWall, -8e-3, 0}, 50, seen);
  int arrived = 0;
  for (const RayPath& ray : seen.rays) {
    EXPECT_EQ(ray.solid, -1);
    arrived += ray.status.status == RayStatus::reached;
  }
  EXPECT_GT(arrived, 10);
}

}  // namespace
}  // namespace plenoflame::test::surface_paths_test
