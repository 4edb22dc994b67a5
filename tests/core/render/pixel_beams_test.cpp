// Single rays stay within the beam of their pixel, and that is not much wider.
#include "render/visibility/pixel_beams.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "plenoflame/render/render.h"
#include "render/visibility/beam_bounds.h"
#include "render/visibility/occupied_region.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"

namespace plenoflame::test::pixel_beams_test {
namespace {

CameraSpec stopped_down(CameraSpec spec) {
  for (SurfaceSpec& surface : spec.lens.surfaces)
    surface.diameter = std::min(surface.diameter, 0.02);
  return spec;
}

CameraSpec with_ideal_lenses(CameraSpec spec) {
  spec.lens.model = LensModel::ideal;
  return spec;
}

TEST(PixelBeams, HoldTheRaysOfTheirPixels) {
  const CameraSpec paper = paper_flame(3000, 3000).camera;
  std::mt19937_64 generator(7);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * (static_cast<double>(generator() >> 11) * 0x1p-53);
  };
  for (const CameraSpec& spec : {paper, stopped_down(paper), with_ideal_lenses(paper)}) {
    const Camera camera(spec);
    const PupilSampling pupils(camera);
    const double pitch = spec.sensor.pixel_pitch, aperture = 0.5 * spec.array.diameter;
    const Vec2 corner = camera.sensor_point(0, 0);
    int rays = 0, apart = 0, told = 0;
    for (int attempt = 0; attempt < 200000 && rays < 300; ++attempt) {
      const Vec2 near{uniform(-std::fabs(corner.x), std::fabs(corner.x)),
                      uniform(-std::fabs(corner.y), std::fabs(corner.y))};
      const Vec2 room{spec.array.pitch, spec.array.pitch};
      const auto lenses = camera.lattice().within(near - room, near + room);
      if (lenses.empty()) continue;
      const LensIndex lens = lenses[generator() % lenses.size()];
      const Vec3 place = camera.lens_place(lens);
      const int type = camera.lattice().type(lens);
      // Mostly the edge of the aperture, where beams end.
      const double turn = uniform(0, 6.283185307179586);
      const double r = aperture * std::sqrt(uniform(0.5, 1.0));
      const Vec2 aim{place.x + r * std::cos(turn), place.y + r * std::sin(turn)};
      const Vec2 sensor = near;
      const Camera::Path path = camera.trace(sensor, lens, aim);
      if (path.status.status != RayStatus::reached) continue;
      ++rays;
      // The pixel that the sensor point lies in.
      const double i = std::floor(0.5 * spec.sensor.columns - sensor.x / pitch);
      const double j = std::floor(0.5 * spec.sensor.rows - sensor.y / pitch);
      const Vec2 centre = camera.sensor_point(i + 0.5, j + 0.5);
      ASSERT_LE(std::fabs(centre.x - sensor.x), 0.5001 * pitch);
      const Vec2 pixel{centre.x - place.x, centre.y - place.y};
      const double z = uniform(0.9, 1.1);
      const Vec3 seen = path.exit.at((z - path.exit.origin.z) / path.exit.direction.z);
      const auto meets = [&](Vec3 at) {
        const Vec3 world = camera.to_world().point(at), speck{1e-7, 1e-7, 1e-7};
        const OccupiedRegion region(camera, {{world - speck, world + speck}});
        EXPECT_TRUE(region.bounded());
        // Neither is the lens, nor all that is around it, said to see nothing.
        EXPECT_TRUE(at.x != seen.x || at.y != seen.y ||
                    BeamBounds(camera, pupils.tables(), region).may_meet(type, place))
            << "lens of type " << type << " at " << place.x << ", " << place.y;
        const auto beams = PixelBeams::make(camera, pupils.tables(), region);
        return beams->of(type, {place.x, place.y}).may_meet(pixel);
      };
      ASSERT_TRUE(meets(seen)) << "ray " << rays << " of type " << type << " from " << sensor.x
                               << ", " << sensor.y;
      // Thirty millimetres beside is beyond all beams.
      if (rays % 8 != 0) continue;
      ++apart;
      const double away = uniform(0, 6.283185307179586);
      told += !meets(seen + 30e-3 * Vec3{std::cos(away), std::sin(away), 0});
    }
    EXPECT_EQ(rays, 300);
    EXPECT_GT(told, 0.9 * apart) << spec.lens.surfaces.front().diameter << " "
                                 << (spec.lens.model == LensModel::ideal);
  }
}

TEST(PixelBeams, AreNotKnownBehindALensThatIsNotRound) {
  CameraSpec spec = paper_flame(300, 300).camera;
  const Camera round(spec);
  SurfaceSpec& front = spec.lens.surfaces.front();
  front.radius = kInfinity;
  front.radius_x = 0.3;
  front.radius_y = 0.6;
  const Camera camera(spec);
  const OccupiedRegion region(round, {{{0.99, -0.01, -0.01}, {1.01, 0.01, 0.01}}});
  EXPECT_TRUE(PixelBeams::make(round, PupilSampling(round).tables(), region));
  EXPECT_FALSE(PixelBeams::make(camera, PupilSampling(camera).tables(), region));
}

// Without array, in front of and behind the focus of all zones of the lens: where they cross, the
// outermost rays are not those of the lens' edge.
TEST(BeamBounds, HoldTheRaysOfBarePixels) {
  const CameraSpec paper = paper_flame(3000, 3000).camera;
  std::mt19937_64 generator(11);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * (static_cast<double>(generator() >> 11) * 0x1p-53);
  };
  for (CameraSpec spec : {paper, stopped_down(paper), with_ideal_lenses(paper)}) {
    spec.array.present = false;
    const Camera camera(spec);
    const PupilSampling pupils(camera);
    const Vec2 corner = camera.sensor_point(0, 0);
    int rays = 0, apart = 0, told = 0;
    for (int attempt = 0; attempt < 100000 && rays < 400; ++attempt) {
      const Vec2 sensor{uniform(-std::fabs(corner.x), std::fabs(corner.x)),
                        uniform(-std::fabs(corner.y), std::fabs(corner.y))};
      const double turn = uniform(0, 6.283185307179586), r = 0.05 * std::sqrt(uniform(0, 1));
      const double reach = spec.lens.surfaces.front().diameter < 0.05 ? 0.2 : 1;
      const Vec2 aim{reach * r * std::cos(turn), reach * r * std::sin(turn)};
      const Camera::Path path = camera.trace(sensor, std::nullopt, aim);
      if (path.status.status != RayStatus::reached) continue;
      ++rays;
      const Vec3 at =
          path.exit.at((uniform(0.7, 1.4) - path.exit.origin.z) / path.exit.direction.z);
      const auto meets = [&](Vec3 seen) {
        const Vec3 world = camera.to_world().point(seen), speck{1e-7, 1e-7, 1e-7};
        const OccupiedRegion region(camera, {{world - speck, world + speck}});
        return BeamBounds(camera, pupils.tables(), region)
            .may_meet(0, {sensor.x, sensor.y, camera.sensor()});
      };
      ASSERT_TRUE(meets(at)) << "ray " << rays << " from " << sensor.x << ", " << sensor.y
                             << " through " << aim.x << ", " << aim.y << " at " << at.z;
      if (rays % 8 != 0) continue;
      ++apart;
      const double away = uniform(0, 6.283185307179586);
      told += !meets(at + 80e-3 * Vec3{std::cos(away), std::sin(away), 0});
    }
    EXPECT_EQ(rays, 400);
    EXPECT_EQ(told, apart);
  }
}

// A lens in a deep hood: the field gets dark where the pupil tables still have nodes, and the
// outermost light comes from between the last of them that is lit and the first that is not.
TEST(PixelBeams, NothingIsLostWhereTheFieldGetsDark) {
  for (const auto& [columns, jitter] : {std::pair{3120, 0.0}, {3280, 0.0}, {3280, 1e-9}}) {
    Scene scene;
    scene.camera.lens.surfaces = {{kInfinity, 0.15, 1, 0.04, false},
                                  {0.3, 0.02426, 1.5, 0.06, false},
                                  {-0.3, 0, 1, 0.06, false},
                                  {kInfinity, 0, 1, 0.03, true}};
    ArraySpec& array = scene.camera.array;
    array.present = true;
    array.lattice = Lattice::square;
    array.pitch = array.diameter = 1e-3;
    array.thickness = 0.5e-3;
    array.sensor_distance = 7e-3;
    array.focal_jitter = jitter;  // then the camera is not aligned, and pixels are not looked at
    array.types = {{"type1", 6e-3, 6e-3, 1.5, 0}};
    scene.camera.sensor = {columns, 60, 1e-4};
    scene.camera.focus = {FocusMode::paraxial, 0, 1.0, "array"};
    scene.flames = {{}};
    scene.flames[0].position = {1, 0.226, 0};
    scene.flames[0].layers = {{"ball", {}, {4e-3, 4e-3, 4e-3}, 1700, 50}};
    const CompiledScene compiled = compile(scene);
    RenderSettings settings;
    settings.samples = 16;
    const RenderResult some = render(compiled, settings, one_thread());
    settings.skip = false;
    const RenderResult all = render(compiled, settings, one_thread());
    EXPECT_GT(all.statistics.flux, 0) << columns;
    EXPECT_LT(some.statistics.rays, 0.5 * all.statistics.rays) << columns;
    EXPECT_EQ(some.light_field.channels[0].flux.pixels, all.light_field.channels[0].flux.pixels)
        << columns;
  }
}

// With a stop that is imaged sharply, pixels at the edge of a micro-image see slivers, whose bounds
// are less close.
TEST(PixelBeams, LetNearlyAllRaysReachTheScene) {
  const std::pair<const char*, double> presets[] = {{"paper-plenoptic1", 0.87},
                                                    {"paper-plenoptic2", 0.9},
                                                    {"paper-previous-60x60", 0.84},
                                                    {"raytrix-r29", 0.9},
                                                    {"r12", 0.9}};
  for (const auto& [preset, least] : presets) {
    Scene scene = paper_flame(1, 1);
    scene.camera = preset_camera(preset);
    if (scene.camera.array.types.size() == 1) scene.camera.focus.conjugate = "array";
    const CompiledScene compiled = compile(scene);
    const SensorSpec& sensor = scene.camera.sensor;
    RenderSettings settings;
    settings.samples = 64;
    const int width = std::min(400, sensor.columns), height = std::min(400, sensor.rows);
    settings.window = {(sensor.columns - width) / 2, (sensor.rows - height) / 2, width, height};
    const RenderStatistics statistics = render(compiled, settings, one_thread()).statistics;
    EXPECT_GT(statistics.rays, 1e5) << preset;
    EXPECT_GE(statistics.rays_reached, least * statistics.rays) << preset;
  }
}

}  // namespace
}  // namespace plenoflame::test::pixel_beams_test
