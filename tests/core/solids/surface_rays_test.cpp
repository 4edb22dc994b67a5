// Ray paths in scenes with solid surfaces: they end there, and still add up to the pixel.
#include <cmath>

#include "core/solids/surface_samples.h"
#include "plenoflame/render/ray_paths.h"
#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"

namespace plenoflame::test::surface_rays_test {
namespace {

constexpr double kWall = 1.005;  ///< [m] within the flame, which stands at 1 m

/// The small scene's camera and flame, with a glowing wall that cuts the flame in two.
CompiledScene walled() {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  SolidSurfaceSpec wall = shaped(SolidShape::plane, 1);
  wall.extent = {kInfinity, kInfinity};
  wall.position = {kWall, 0, 0};
  wall.rotation = {0, -0.5 * std::acos(-1.0), 0};
  wall.material.kind = MaterialKind::emitter;
  wall.material.radiance = 3;
  scene.surfaces = {wall};
  return compile(scene);
}

TEST(SurfaceRays, EndOnTheWallAndAddUpToThePixel) {
  const CompiledScene scene = walled();
  RenderSettings settings;
  settings.samples = 64;
  settings.precision = Precision::double_precision;
  settings.window = {28, 27, 5, 5};
  const LightField field = render(scene, settings, one_thread()).light_field;
  for (const Pixel pixel : {Pixel{30, 29}, Pixel{28, 31}}) {
    RayPaths paths = empty_ray_paths(scene);
    paths.flame_samples = 5;
    add_pixel_rays(scene, settings, {pixel}, {}, paths);
    double flux = 0;
    int reached = 0;
    for (std::size_t i = 0; i < paths.rays.size(); ++i) {
      const RayPath& ray = paths.rays[i];
      flux += ray.weight * paths.radiance_of(i, 0);
      if (ray.status.status != RayStatus::reached) continue;
      ++reached;
      for (std::size_t k = ray.first; k < ray.first + ray.count; ++k) {
        const RayVertex& v = paths.vertices[k];
        const bool last = k + 1 == ray.first + ray.count;
        EXPECT_EQ(v.surface == kSolidVertex, last);
        EXPECT_LE(v.position.x, kWall * (1 + 1e-12));
        if (last) {
          EXPECT_TRUE(relative(v.position.x, kWall, 1e-12));
        }
      }
      // Glowing wall behind what is left of the flame.
      EXPECT_GE(paths.radiance_of(i, 0), 3 * std::exp(-ray.optical_thickness) * (1 - 1e-9));
    }
    EXPECT_GT(reached, 3);
    const double expected =
        static_cast<double>(field.channels[0].flux.at(pixel.column - 28, pixel.row - 27));
    EXPECT_GT(expected, 0);
    EXPECT_TRUE(relative(flux, expected, 1.2e-7));
  }
}

TEST(SurfaceRays, HiddenPointsDoNotReachTheCamera) {
  const CompiledScene scene = walled();
  RayPaths paths = empty_ray_paths(scene);
  add_object_rays(scene, {1.1, 0, 0}, 40, paths);
  for (const RayPath& ray : paths.rays) {
    EXPECT_EQ(ray.status.status, RayStatus::missed);
    EXPECT_EQ(ray.column, -1);
    const RayVertex& last = paths.vertices[ray.first + ray.count - 1];
    EXPECT_EQ(last.surface, kSolidVertex);
    EXPECT_TRUE(relative(last.position.x, kWall, 1e-12));
  }
  // A point on the wall, and one before it, are seen.
  RayPaths seen = empty_ray_paths(scene);
  for (const double x : {kWall, 0.95}) add_object_rays(scene, {x, 0, 0}, 40, seen);
  int arrived = 0;
  for (const RayPath& ray : seen.rays) arrived += ray.status.status == RayStatus::reached;
  EXPECT_GT(arrived, 20);
}

TEST(SurfaceRays, ChiefRaysCarryTheFlameBeforeTheWall) {
  const CompiledScene scene = walled();
  const CompiledScene open =
      compile(small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real)));
  RayPaths before = empty_ray_paths(scene), all = before;
  add_chief_rays(scene, before);
  add_chief_rays(open, all);
  ASSERT_EQ(before.rays.size(), all.rays.size());
  int less = 0;
  for (std::size_t i = 0; i < all.rays.size(); ++i) {
    EXPECT_LE(before.rays[i].optical_thickness, all.rays[i].optical_thickness * (1 + 1e-9));
    less += before.rays[i].optical_thickness < 0.9999 * all.rays[i].optical_thickness;
  }
  EXPECT_GT(less, 3);
}

}  // namespace
}  // namespace plenoflame::test::surface_rays_test
