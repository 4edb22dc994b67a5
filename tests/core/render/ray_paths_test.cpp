// Exported ray paths: the sum over a pixel's rays is its flux, every vertex obeys the law of
// refraction at the surface that it names, and radiance is what the path sees.
#include "plenoflame/render/ray_paths.h"

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/media/layered_medium.h"
#include "render/estimators/backward.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/temporary_folder.h"

namespace plenoflame::test::ray_paths_test {
namespace {

struct Case {
  std::string name;
  CameraSpec camera;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

CameraSpec with_models(CameraSpec camera, LensModel lens, LensModel array) {
  camera.lens.model = lens;
  camera.array.model = array;
  return camera;
}

std::vector<Case> cases() {
  const CameraSpec paper = preset_camera("paper-plenoptic2");
  CameraSpec bare = paper;
  bare.array = {};
  bare.focus.conjugate = "sensor";
  CameraSpec clear = paper;
  clear.array.diameter = 0.7 * clear.array.pitch;
  clear.array.opaque_between = false;
  return {{"plenoptic 2.0", paper},
          {"plenoptic 1.0", preset_camera("paper-plenoptic1")},
          {"ideal", with_models(paper, LensModel::ideal, LensModel::ideal)},
          {"ideal lens", with_models(paper, LensModel::ideal, LensModel::real)},
          {"clear between", clear},
          {"no array", bare}};
}

std::vector<Case> refracting_cases() {
  std::vector<Case> real = cases();
  std::erase_if(real, [](const Case& c) { return c.camera.lens.model == LensModel::ideal; });
  return real;
}

/// Two nested ellipsoids at 1 m, in two channels.
CompiledScene flame_scene(const CameraSpec& camera) {
  std::vector<EllipsoidLayer> layers{{{0, 0, 0}, {0.012, 0.012, 0.02}, 1800, 40},
                                     {{0, 0, 0}, {0.02, 0.02, 0.035}, 1400, 20}};
  CompiledScene scene = scene_of(
      camera, make_layered_medium(layers, {{}, {1, 0, 0}},
                                  {SourceFunction::total(), SourceFunction::band(6e-7, 1e-8)}));
  scene.scene.channels = {{}, {"red", ChannelKind::band, 6e-7, 1e-8}};
  return scene;
}

PixelWindow window_of(const CameraSpec& camera) {
  return {camera.sensor.columns / 2 - 9, camera.sensor.rows / 2 + 5, 16, 12};
}

std::vector<Pixel> pixels_of(const PixelWindow& window) {
  std::vector<Pixel> pixels;
  for (int y = window.y; y < window.y + window.height; ++y)
    for (int x = window.x; x < window.x + window.width; ++x) pixels.push_back({x, y});
  return pixels;
}

class RayPathsTest : public ::testing::TestWithParam<Case> {
 protected:
  RayPaths paths_of(const CompiledScene& scene) {
    RayPaths paths = empty_ray_paths(scene);
    add_pixel_rays(scene, settings_, pixels_of(window_of(GetParam().camera)), {}, paths);
    return paths;
  }
  RenderSettings settings_;
};

TEST_P(RayPathsTest, SumIsTheFluxOfThePixel) {
  const CompiledScene scene = flame_scene(GetParam().camera);
  settings_.samples = 64;  // with fewer, pixels at the rim may be left to chance and dark
  settings_.replicates = 2;
  settings_.seed = 11;
  settings_.precision = Precision::double_precision;
  const RayPaths paths = paths_of(scene);
  const PixelWindow window = window_of(GetParam().camera);
  Film film(window, 2, settings_.replicates);
  ASSERT_EQ(film.tile_count(), 1);
  RenderStatistics statistics;
  ASSERT_TRUE(BackwardPass(scene, settings_, {{0, 32}}, BackwardShared(scene, settings_, {}))
                  .run({{0}}, one_thread(), film, statistics));
  std::map<std::pair<int, int>, std::array<double, 2>> sums;
  for (std::size_t i = 0; i < paths.rays.size(); ++i)
    for (std::size_t c = 0; c < 2; ++c)
      sums[{paths.rays[i].column, paths.rays[i].row}][c] +=
          paths.rays[i].weight * paths.radiance_of(i, c);
  int lit = 0;
  for (const Pixel pixel : pixels_of(window))
    for (int c = 0; c < 2; ++c) {
      const double flux =
          (film.sum(c, 0, pixel.column, pixel.row) + film.sum(c, 1, pixel.column, pixel.row)) / 64;
      lit += flux > 0;
      EXPECT_TRUE(
          relative(sums[{pixel.column, pixel.row}][static_cast<std::size_t>(c)], flux, 1e-12))
          << pixel.column << "," << pixel.row << " channel " << c;
    }
  EXPECT_GT(lit, window.width * window.height);
}

/// The same for cameras whose main lens has surfaces.
class RefractedRayPathsTest : public RayPathsTest {};

TEST_P(RefractedRayPathsTest, VerticesObeyTheLawOfRefraction) {
  const CameraSpec& camera = GetParam().camera;
  const CompiledScene scene = flame_scene(camera);
  settings_.samples = 8;
  const RayPaths paths = paths_of(scene);
  const auto& surfaces = camera.lens.surfaces;
  const int lens_surfaces = static_cast<int>(surfaces.size());
  const RigidTransform to_camera = scene.camera.to_world().inverse();
  int refractions = 0, reached = 0;
  for (const RayPath& ray : paths.rays) {
    reached += ray.status.status == RayStatus::reached;
    for (std::size_t k = ray.first + 1; k + 1 < ray.first + ray.count; ++k) {
      const RayVertex& vertex = paths.vertices[k];
      if (vertex.surface < 0) continue;
      // The centre of curvature, from the scene file's radii.
      Vec3 centre;
      if (vertex.surface < lens_surfaces) {
        const auto s = static_cast<std::size_t>(vertex.surface);
        double z = 0;
        for (std::size_t i = 0; i < s; ++i) z -= surfaces[i].thickness;
        centre = {0, 0, z - surfaces[s].radius};
        if (!std::isfinite(centre.z)) continue;
      } else {
        const Vec2 place = scene.camera.lattice().centre(ray.lens);
        const auto& type = camera.array.types[static_cast<std::size_t>(ray.type)];
        const bool back = vertex.surface == lens_surfaces + 1;
        centre = {place.x, place.y,
                  back ? scene.camera.array_back() + type.radius_back
                       : scene.camera.array_front() - type.radius_front};
        if (!std::isfinite(centre.z)) continue;
      }
      const Vec3 at = to_camera.point(vertex.position);
      const Vec3 normal = normalize(centre - at);
      const Vec3 in = normalize(vertex.position - paths.vertices[k - 1].position);
      const Vec3 out = normalize(paths.vertices[k + 1].position - vertex.position);
      const Vec3 before = paths.vertices[k - 1].index * cross(to_camera.direction(in), normal);
      const Vec3 behind = vertex.index * cross(to_camera.direction(out), normal);
      // Segments inside a microlens are 50 um long, at coordinates of 1 m: 2e-16 / 5e-5.
      EXPECT_TRUE(within(length(behind - before), 0, 1e-10, 1)) << "surface " << vertex.surface;
      ++refractions;
    }
  }
  EXPECT_GT(reached, 0);
  EXPECT_GT(refractions, reached);
}

TEST_P(RayPathsTest, CarryWhatThePathSees) {
  const CompiledScene scene = flame_scene(GetParam().camera);
  settings_.samples = 4;
  const RayPaths paths = paths_of(scene);
  int seen = 0;
  for (std::size_t i = 0; i < paths.rays.size(); ++i) {
    const RayPath& ray = paths.rays[i];
    if (ray.status.status != RayStatus::reached) {
      EXPECT_EQ(paths.radiance_of(i, 0), 0);
      EXPECT_EQ(paths.radiance_of(i, 1), 0);
      continue;
    }
    if (paths.radiance_of(i, 0) == 0) continue;
    const RayVertex& last = paths.vertices[ray.first + ray.count - 1];
    const RayVertex& before = paths.vertices[ray.first + ray.count - 2];
    const double segment = length(last.position - before.position);
    const Ray line{before.position, normalize(last.position - before.position)};
    // The segment between the bounds holds all of the flame.
    const std::vector<double> expected = integrate_reference(*scene.medium, line, 0, segment);
    EXPECT_TRUE(relative(paths.radiance_of(i, 0), expected[0], 1e-8));
    EXPECT_TRUE(relative(paths.radiance_of(i, 1), expected[1], 1e-8));
    EXPECT_TRUE(relative(ray.optical_thickness, expected[2], 1e-8));
    ++seen;
  }
  EXPECT_GT(seen, 20);
}

TEST_P(RayPathsTest, EndedRaysEndOutsideOfTheSurface) {
  const CameraSpec& camera = GetParam().camera;
  const CompiledScene scene = flame_scene(camera);
  const RayPaths paths = paths_of(scene);
  const RigidTransform to_camera = scene.camera.to_world().inverse();
  const int lens_surfaces = scene.camera.surface_count() -
                            (scene.camera.has_array() ? scene.camera.ideal_array() ? 1 : 2 : 0);
  for (const RayPath& ray : paths.rays) {
    EXPECT_GE(ray.weight, 0);  // 0: aimed from beyond the edge of the micro-image
    if (ray.status.status != RayStatus::vignetted) continue;
    const RayVertex& last = paths.vertices[ray.first + ray.count - 1];
    ASSERT_EQ(last.surface, ray.status.surface);
    const Vec3 at = to_camera.point(last.position);
    if (last.surface < lens_surfaces) {
      if (scene.camera.ideal_lens()) continue;
      const auto& surface = camera.lens.surfaces[static_cast<std::size_t>(last.surface)];
      EXPECT_GT(std::hypot(at.x, at.y), 0.5 * surface.diameter * (1 - 1e-12));
    } else {
      if (scene.camera.has_array() && ray.type < 0) {  // meant to pass between, met a lens
        const Vec2 lens =
            scene.camera.lattice().centre(scene.camera.lattice().nearest({at.x, at.y}));
        EXPECT_LT(std::hypot(at.x - lens.x, at.y - lens.y), 0.5 * camera.array.diameter * 1.05);
        continue;
      }
      const Vec2 place = scene.camera.lattice().centre(ray.lens);
      EXPECT_GT(std::hypot(at.x - place.x, at.y - place.y),
                0.5 * camera.array.diameter * (1 - 1e-9));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, RayPathsTest, ::testing::ValuesIn(cases()));
INSTANTIATE_TEST_SUITE_P(Cameras, RefractedRayPathsTest, ::testing::ValuesIn(refracting_cases()));

TEST(RayPaths, ChiefRaysPassTheMiddleOfTheStop) {
  CameraSpec camera = preset_camera("paper-plenoptic2");
  camera.sensor.columns = 400;
  camera.sensor.rows = 300;
  const CompiledScene scene = flame_scene(camera);
  RayPaths paths = empty_ray_paths(scene);
  add_chief_rays(scene, paths);
  std::size_t stop = 0;
  while (!camera.lens.surfaces[stop].stop) ++stop;
  const double radius = 0.5 * camera.lens.surfaces[stop].diameter;
  std::set<std::pair<int, int>> lenses;
  int lit = 0;
  for (std::size_t i = 0; i < paths.rays.size(); ++i) {
    const RayPath& ray = paths.rays[i];
    lenses.insert({ray.lens.q, ray.lens.r});
    ASSERT_EQ(ray.status.status, RayStatus::reached);
    EXPECT_EQ(ray.weight, 0);
    lit += paths.radiance_of(i, 0) > 0;
    for (std::size_t k = ray.first; k < ray.first + ray.count; ++k) {
      const RayVertex& vertex = paths.vertices[k];
      if (vertex.surface != static_cast<int>(stop)) continue;
      const Vec3 at = scene.camera.to_world().inverse().point(vertex.position);
      EXPECT_LT(std::hypot(at.x, at.y), 0.02 * radius);
    }
  }
  EXPECT_EQ(lenses.size(), paths.rays.size());
  // One lens for each hexagon of the pitch, within a rim of one pitch.
  const double p = camera.sensor.pixel_pitch / camera.array.pitch, hexagon = std::sqrt(0.75);
  const double w = 400 * p, h = 300 * p;
  EXPECT_GT(static_cast<double>(lenses.size()), (w - 1) * (h - 1) / hexagon);
  EXPECT_LT(static_cast<double>(lenses.size()), (w + 1) * (h + 1) / hexagon);
  EXPECT_GT(lit, 10);
}

TEST(RayPaths, PixelsGivenTwiceHaveTheirRaysOnce) {
  const CompiledScene scene = flame_scene(preset_camera("paper-plenoptic2"));
  RenderSettings settings;
  settings.samples = 8;
  const auto flux_of = [](const RayPaths& paths) {
    double flux = 0;
    for (std::size_t i = 0; i < paths.rays.size(); ++i)
      flux += paths.rays[i].weight * paths.radiance_of(i, 0);
    return flux;
  };
  RayPaths one = empty_ray_paths(scene), two = empty_ray_paths(scene);
  add_pixel_rays(scene, settings, {{1500, 1500}, {1502, 1499}}, {}, one);
  add_pixel_rays(scene, settings, {{1500, 1500}, {1502, 1499}, {1500, 1500}}, {}, two);
  EXPECT_GT(flux_of(one), 0);
  EXPECT_EQ(two.rays.size(), one.rays.size());
  EXPECT_EQ(flux_of(two), flux_of(one));
  // A microlens beside: only what is not there yet.
  const LensIndex lens = one.rays.front().lens;
  const std::vector<Pixel> given{{1500, 1500}, {1502, 1499}};
  RayPaths rest = empty_ray_paths(scene);
  add_microlens_rays(scene, settings, lens, {}, rest, given);
  ASSERT_FALSE(rest.rays.empty());
  for (const RayPath& ray : rest.rays)
    EXPECT_FALSE((ray.column == 1500 && ray.row == 1500) ||
                 (ray.column == 1502 && ray.row == 1499));
}

TEST(RayPaths, RandomPixelsAreDifferentAndEvenlyDrawn) {
  SensorSpec sensor;
  sensor.columns = 10;
  sensor.rows = 8;
  std::vector<int> drawn(80);
  constexpr int kTimes = 1000;
  for (std::uint64_t seed = 0; seed < kTimes; ++seed) {
    std::set<std::pair<int, int>> seen;
    for (const Pixel pixel : random_pixels(sensor, 20, seed)) {
      EXPECT_TRUE(seen.insert({pixel.column, pixel.row}).second);
      ++drawn[static_cast<std::size_t>(pixel.row * 10 + pixel.column)];
    }
    EXPECT_EQ(seen.size(), 20u);
  }
  // A quarter of the pixels each time: binomial.
  for (const int count : drawn)
    EXPECT_TRUE(within_standard_errors(count, 0.25 * kTimes, std::sqrt(0.1875 * kTimes), 5));
  std::set<std::pair<int, int>> all;
  for (const Pixel pixel : random_pixels(sensor, 80, 1)) all.insert({pixel.column, pixel.row});
  EXPECT_EQ(all.size(), 80u);
  EXPECT_THROW(random_pixels(sensor, 81, 1), UsageError);
}

TEST(RayPaths, SceneWithoutFlameCarriesNothing) {
  CompiledScene scene = flame_scene(preset_camera("paper-plenoptic2"));
  scene.medium.reset();
  RayPaths paths = empty_ray_paths(scene);
  add_pixel_rays(scene, {}, {{1500, 1500}}, {}, paths);
  ASSERT_FALSE(paths.rays.empty());
  for (const double radiance : paths.radiance) EXPECT_EQ(radiance, 0);
}

TEST(RayPaths, RefusesWhatItCannotDo) {
  const CompiledScene scene = flame_scene(preset_camera("paper-plenoptic2"));
  RayPaths paths = empty_ray_paths(scene);
  EXPECT_THROW(add_pixel_rays(scene, {}, {{3000, 0}}, {}, paths), UsageError);
  EXPECT_THROW(add_pixel_rays(scene, {}, {{0, -1}}, {}, paths), UsageError);
  RenderSettings settings;
  settings.samples = 1;
  EXPECT_THROW(add_pixel_rays(scene, settings, {{0, 0}}, {}, paths), UsageError);
  EXPECT_TRUE(paths.rays.empty());
  const TemporaryFolder folder;
  EXPECT_THROW(write_ray_paths(folder.path() + "/a.txt", paths), UsageError);
  CameraSpec bare = preset_camera("paper-plenoptic2");
  bare.array = {};
  bare.focus.conjugate = "sensor";
  const CompiledScene no_array = flame_scene(bare);
  EXPECT_THROW(add_chief_rays(no_array, paths), InputError);
}

}  // namespace
}  // namespace plenoflame::test::ray_paths_test
