// Skipping changes no bit of the picture, and leaves all that the scene asks for.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "plenoflame/media/layered_medium.h"
#include "plenoflame/media/voxel_medium.h"
#include "plenoflame/render/render.h"
#include "render/visibility/occupied_region.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"
#include "support/uniform_medium.h"

namespace plenoflame::test::skipping_test {
namespace {

/// Numbers in [0, 1) (a linear congruence modulo 2^64, Knuth's multiplier).
class Numbers {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }
  double between(double a, double b) { return a + (b - a) * (*this)(); }

 private:
  std::uint64_t state_ = 1;
};

RigidTransform turned(Vec3 place) {
  // A rotation matrix of small whole numbers.
  const double n = 1.0 / 9;
  RigidTransform t;
  t.rotation.rows = {Vec3{8 * n, -4 * n, 1 * n}, Vec3{1 * n, 4 * n, 8 * n},
                     Vec3{-4 * n, -7 * n, 4 * n}};
  t.translation = place;
  return t;
}

std::vector<SourceFunction> total_channel() {
  return {SourceFunction::total()};
}

/// Two turned ellipsoids that do not meet.
std::shared_ptr<const Medium> ellipsoids() {
  return make_layered_medium({{{0, 0, 0.012}, {0.002, 0.003, 0.01}, 1700, 20},
                              {{0.001, 0.002, -0.009}, {0.004, 0.002, 0.003}, 1800, 5}},
                             turned({1, 0.001, 0.002}), total_channel());
}

/// Two clouds of voxels at opposite corners of a turned lattice, and nothing between.
std::shared_ptr<const Medium> clouds() {
  VoxelField temperature, absorption;
  temperature.background = 300;
  for (VoxelField* field : {&temperature, &absorption}) {
    const RigidTransform place = turned({1.004, 0.003, -0.006});
    for (std::size_t i = 0; i < 3; ++i)
      field->index_to_world.linear.rows[i] = 2e-4 * place.rotation.rows[i];
    field->index_to_world.translation = place.translation;
    field->brick_origins = {{0, 0, 0}, {40, 48, 40}};
    field->name = field == &temperature ? "temperature" : "absorption";
    for (int i = 0; i < 2 * 512; ++i)
      field->values.push_back(field == &temperature ? 1700.F : 10.F + static_cast<float>(i % 7));
  }
  return make_voxel_medium(temperature, absorption, VoxelInterpolation::trilinear, total_channel());
}

std::shared_ptr<const Medium> both() {
  std::vector<std::shared_ptr<const Medium>> media;
  media.push_back(ellipsoids());
  media.push_back(clouds());
  return make_composite_medium(std::move(media));
}

bool holds(const Box& box, Vec3 p) {
  return p.x >= box.lower.x && p.x <= box.upper.x && p.y >= box.lower.y && p.y <= box.upper.y &&
         p.z >= box.lower.z && p.z <= box.upper.z;
}

TEST(Skipping, OccupiedBoxesHoldEveryPlaceWithAbsorption) {
  for (const auto& make : {&ellipsoids, &clouds, &both}) {
    const std::shared_ptr<const Medium> medium = make();
    const Box bounds = medium->bounds();
    const std::vector<Box> boxes = medium->occupied();
    ASSERT_GT(boxes.size(), 1u);
    EXPECT_LT(boxes.size(), 20000u);
    Numbers random;
    int absorbing = 0, outside = 0;
    for (int i = 0; i < 50000; ++i) {
      const Vec3 p{random.between(bounds.lower.x, bounds.upper.x),
                   random.between(bounds.lower.y, bounds.upper.y),
                   random.between(bounds.lower.z, bounds.upper.z)};
      const bool held =
          std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) { return holds(box, p); });
      outside += !held;
      if (!(medium->sample(p).absorption > 0)) continue;
      ++absorbing;
      ASSERT_TRUE(held) << p.x << ", " << p.y << ", " << p.z;
    }
    EXPECT_GT(absorbing, 100);
    EXPECT_GT(outside, 5000) << "the boxes hold everything";
  }
}

/// Tells if a straight line meets a box, by its slabs.
bool line_meets(const Box& box, Vec3 a, Vec3 b) {
  double from = 0, to = 1;
  const auto slab = [&](double lower, double upper, double p, double q) {
    const double d = q - p;
    if (d == 0) {
      if (p < lower || p > upper) to = -1;
      return;
    }
    from = std::max(from, std::min((lower - p) / d, (upper - p) / d));
    to = std::min(to, std::max((lower - p) / d, (upper - p) / d));
  };
  slab(box.lower.x, box.upper.x, a.x, b.x);
  slab(box.lower.y, box.upper.y, a.y, b.y);
  slab(box.lower.z, box.upper.z, a.z, b.z);
  return from <= to;
}

TEST(Skipping, NoRayOfABeamMeetsAnythingWhereTheBeamDoesNot) {
  const CompiledScene scene = compile(paper_flame(200, 170));
  const RigidTransform to_world = scene.camera.to_world();
  Numbers random;
  std::vector<Box> boxes;
  for (int i = 0; i < 12; ++i) {
    const Vec3 low{random.between(0.9, 1.1), random.between(-0.05, 0.05),
                   random.between(-0.05, 0.05)};
    boxes.push_back({low, low + Vec3{random.between(0, 0.02), random.between(0, 0.02),
                                     random.between(0, 0.003)}});
  }
  const OccupiedRegion region(scene.camera, boxes);
  ASSERT_TRUE(region.bounded());
  int missing = 0, meeting = 0;
  for (int beam = 0; beam < 3000; ++beam) {
    const double radius = random.between(0, 0.01);
    const Vec2 centre[2] = {{random.between(-0.08, 0.08), random.between(-0.08, 0.08)},
                            {random.between(-0.08, 0.08), random.between(-0.08, 0.08)}};
    const bool meets = region.meets(centre, radius);
    (meets ? meeting : missing) += 1;
    if (meets) continue;
    for (int ray = 0; ray < 20; ++ray) {
      const auto in_disc = [&](Vec2 middle, double z) {
        const double r = radius * std::sqrt(random()), turn = 6.283185307179586 * random();
        return to_world.point({middle.x + r * std::cos(turn), middle.y + r * std::sin(turn), z});
      };
      const Vec3 a = in_disc(centre[0], region.near_plane());
      const Vec3 b = in_disc(centre[1], region.far_plane());
      for (const Box& box : boxes) ASSERT_FALSE(line_meets(box, a, b)) << "beam " << beam;
    }
  }
  EXPECT_GT(missing, 300);
  EXPECT_GT(meeting, 300);
}

// The boxes' distance from a point of a plane across the axis, looked at along the axis.
double distance_to(const std::vector<Box>& boxes, const RigidTransform& to_camera, Vec2 p) {
  double nearest = 1e300;
  for (const Box& box : boxes) {
    const Vec3 a = to_camera.point(box.lower), b = to_camera.point(box.upper);
    const double x = std::clamp(p.x, std::min(a.x, b.x), std::max(a.x, b.x));
    const double y = std::clamp(p.y, std::min(a.y, b.y), std::max(a.y, b.y));
    nearest = std::min(nearest, std::hypot(p.x - x, p.y - y));
  }
  return nearest;
}

TEST(Skipping, BeamsAreToldFromWhatIsHardlyBesideThem) {
  const CompiledScene scene = compile(paper_flame(200, 170));
  const RigidTransform to_camera = scene.camera.to_world().inverse();
  Numbers random;
  int total_far = 0;
  for (int round = 0; round < 20; ++round) {
    std::vector<Box> boxes;
    for (int i = 0; i < 5; ++i) {
      const Vec3 low{1, random.between(-0.03, 0.03), random.between(-0.02, 0.02)};
      boxes.push_back(
          {low, low + Vec3{1e-3, random.between(1e-3, 0.02), random.between(1e-3, 0.02)}});
    }
    const OccupiedRegion region(scene.camera, boxes);
    Box all = boxes.front();
    for (const Box& box : boxes) {
      all.lower = {1, std::min(all.lower.y, box.lower.y), std::min(all.lower.z, box.lower.z)};
      all.upper = {1, std::max(all.upper.y, box.upper.y), std::max(all.upper.z, box.upper.z)};
    }
    // Two places of the raster: one that a box only touches, one for where in it the beam is.
    // Distances beside the raster are told only roughly.
    const std::vector<Box> raster{all};
    const double blur = 3 * std::hypot(all.upper.y - all.lower.y, all.upper.z - all.lower.z) / 128;
    int near = 0, far = 0;
    for (int beam = 0; beam < 2000; ++beam) {
      const Vec2 p{random.between(-0.06, 0.06), random.between(-0.06, 0.06)};
      const Vec2 centre[2] = {p, p};
      const double radius = random.between(0, 0.01);
      const double away = distance_to(boxes, to_camera, p);
      if (away <= radius) {
        ++near;
        ASSERT_TRUE(region.meets(centre, radius));
      } else if (away > radius + blur && distance_to(raster, to_camera, p) == 0) {
        ++far;
        ASSERT_FALSE(region.meets(centre, radius)) << away << " against " << radius;
      }
    }
    total_far += far;
    EXPECT_GT(near, 20);
  }
  EXPECT_GT(total_far, 200);
}

TEST(Skipping, NothingIsSaidOfWhatStandsBesideTheCamera) {
  const CompiledScene scene = compile(paper_flame(200, 170));
  const OccupiedRegion region(scene.camera, {{{-0.1, 1, 1}, {1, 2, 2}}});
  EXPECT_FALSE(region.bounded());
  const Vec2 centre[2] = {{-9, -9}, {-9, -9}};
  EXPECT_TRUE(region.meets(centre, 1e-3));
}

struct Pair {
  RenderResult with, without;
};

Pair render_both(const CompiledScene& scene, RenderSettings settings) {
  Pair pair;
  pair.with = render(scene, settings);
  settings.skip = false;
  pair.without = render(scene, settings);
  return pair;
}

double lit(const RenderResult& result) {
  const PixelValues& p = result.light_field.channels[0].flux.pixels;
  return static_cast<double>(std::count_if(p.begin(), p.end(), [](float f) { return f > 0; }));
}

TEST(Skipping, ScatteredFlamesKeepEveryBit) {
  CameraSpec camera = paper_flame(700, 700).camera;
  CameraSpec stopped = camera;  // narrow beams
  for (SurfaceSpec& surface : stopped.lens.surfaces)
    surface.diameter = std::min(surface.diameter, 0.02);
  CameraSpec ideal = camera;
  ideal.lens.model = LensModel::ideal;
  CameraSpec bare = bare_flame(200, 170, 1e-4).camera;
  double skipped = 0, lenses = 0, pairs_skipped = 0, pairs = 0;
  for (const CameraSpec& spec : {camera, stopped, ideal, bare})
    for (const auto& make : {&ellipsoids, &clouds, &both}) {
      RenderSettings settings;
      settings.samples = make == &ellipsoids ? 32 : 8;  // of many samples, single pixels are tested
      settings.control_variate = false;                 // a table is filled by the rays there are
      const CompiledScene scene = scene_of(spec, make());
      const Pair p = render_both(scene, settings);
      EXPECT_GT(p.without.statistics.flux, 0);
      EXPECT_EQ(p.with.light_field.channels[0].flux.pixels,
                p.without.light_field.channels[0].flux.pixels);
      EXPECT_EQ(p.with.light_field.channels[0].standard_error.pixels,
                p.without.light_field.channels[0].standard_error.pixels);
      EXPECT_EQ(p.without.statistics.lenses_skipped, 0);
      EXPECT_LE(p.with.statistics.rays_reached, p.without.statistics.rays_reached);
      skipped += p.with.statistics.lenses_skipped;
      lenses += p.with.statistics.lenses;
      pairs_skipped += p.with.statistics.pairs_skipped;
      if (make == &ellipsoids && spec.array.present) pairs += p.with.statistics.pairs;
      EXPECT_EQ(p.without.statistics.pairs_skipped, 0);
    }
  EXPECT_GT(skipped, 0.5 * lenses);
  EXPECT_GT(pairs_skipped, 0.1 * pairs);
}

// Micro-images lie beside their microlenses there.
TEST(Skipping, TheRimOfTheSensorKeepsEveryBit) {
  double skipped = 0, lenses = 0;
  for (const int side : {2000, 3000}) {
    CameraSpec camera = paper_flame(side, side).camera;
    if (side == 2000)
      for (SurfaceSpec& surface : camera.lens.surfaces)
        surface.diameter = std::min(surface.diameter, 0.02);
    const double half = 0.0087 * side / 1000;  // of the scene's 10 mm that the sensor sees
    const CompiledScene scene = scene_of(
        camera, std::make_unique<UniformMedium>(Box{{0.998, -half, -half}, {1.002, half, half}}));
    RenderSettings settings;
    settings.samples = 4;
    for (const PixelWindow window :
         {PixelWindow{0, side / 2, 300, 100}, PixelWindow{side - 300, side - 300, 300, 300}}) {
      settings.window = window;
      const Pair p = render_both(scene, settings);
      skipped += p.with.statistics.lenses_skipped;
      lenses += p.with.statistics.lenses;
      EXPECT_GT(lit(p.without), 100);
      EXPECT_EQ(p.with.light_field.channels[0].flux.pixels,
                p.without.light_field.channels[0].flux.pixels);
    }
  }
  EXPECT_GT(skipped, 0.05 * lenses);
}

// Nor where the camera is not mounted as it should be: more than anything that is made.
TEST(Skipping, MisalignedCamerasKeepEveryBit) {
  const CameraSpec camera = paper_flame(500, 500).camera;
  CameraSpec stopped = camera;  // narrow beams
  for (SurfaceSpec& surface : stopped.lens.surfaces)
    surface.diameter = std::min(surface.diameter, 0.02);
  CameraSpec jitter = camera, tilt = stopped, moved = stopped, ideal = camera;
  jitter.array.focal_jitter = 0.1;
  tilt.array.tilt = {0.03, -0.05};
  moved.lens.decentre = {2e-3, -1e-3};
  moved.lens.tilt = {0.02, 0.03};
  ideal.lens.model = LensModel::ideal;
  ideal.lens.tilt = {-0.02, 0.01};
  ideal.array.tilt = {-0.02, 0.04};
  ideal.array.focal_jitter = 0.05;
  CameraSpec bare = bare_flame(200, 170, 1e-4).camera;
  bare.lens.decentre = {1e-3, 2e-3};
  bare.lens.tilt = {0.03, -0.02};
  double skipped = 0, lenses = 0;
  for (const CameraSpec& spec : {jitter, tilt, moved, ideal, bare}) {
    RenderSettings settings;
    settings.samples = 4;
    settings.control_variate = false;
    const CompiledScene scene = scene_of(spec, both());
    ASSERT_TRUE(scene.camera.misaligned());
    const Pair p = render_both(scene, settings);
    EXPECT_GT(p.without.statistics.flux, 0);
    EXPECT_EQ(p.with.light_field.channels[0].flux.pixels,
              p.without.light_field.channels[0].flux.pixels);
    EXPECT_EQ(p.without.statistics.lenses_skipped, 0);
    skipped += p.with.statistics.lenses_skipped;
    lenses += p.with.statistics.lenses;
  }
  EXPECT_GT(skipped, 0.3 * lenses);
}

TEST(Skipping, OnePercentOfThePictureIsAboutOnePercentOfTheWork) {
  // Boxes 1 m away, where the paper's camera is focused: one fills the sensor, one a hundredth.
  for (const bool ideal : {true, false}) {
    const int side = ideal ? 1500 : 3000;
    CameraSpec camera = paper_flame(side, side).camera;
    camera.focus.mode = FocusMode::best;
    camera.focus.object_distance = 1;
    camera.focus.conjugate = "type2";
    if (ideal) camera.lens.model = LensModel::ideal;
    const auto scene = [&](double half) {
      return scene_of(camera, std::make_unique<UniformMedium>(
                                  Box{{0.9995, -half, -half}, {1.0005, half, half}}));
    };
    RenderSettings settings;
    settings.samples = 2;
    const RenderResult full = render(scene(0.05), settings);
    const double half = ideal ? 0.0016 : 0.0028;
    const double share = lit(render(scene(half), settings)) / lit(full);
    RenderSettings many = settings;
    many.samples = 32;  // from then on, single pixels are tested
    const RenderResult part = render(scene(half), many);
    const double rays =
        part.statistics.rays / (full.statistics.rays * many.samples / settings.samples);
    ::testing::Test::RecordProperty(ideal ? "lit ideal" : "lit", std::to_string(share));
    ::testing::Test::RecordProperty(ideal ? "rays ideal" : "rays", std::to_string(rays));
    EXPECT_GT(share, 0.008);
    EXPECT_LT(share, 0.0145);
    // Pixels whose beams only touch the flame are traced whole: across the rim of so small a
    // picture that is some, with the real lens' blur, which is as wide as the flame, more.
    EXPECT_LT(rays, (ideal ? 1.2 : 2.3) * share);
    // All pixels that get any light, however little, by so many rays that those that two
    // rays miss are found: none is left out, to begin with.
    RenderSettings all = settings;
    all.samples = 256;
    all.skip = false;
    all.window = {side / 2 - side / 12, side / 2 - side / 12, side / 6, side / 6};
    const double reached = lit(render(scene(half), all)) / lit(full);
    ::testing::Test::RecordProperty(ideal ? "reached ideal" : "reached", std::to_string(reached));
    EXPECT_LT(rays, 1.35 * reached);
    EXPECT_GT(part.statistics.pairs_skipped, 0.2 * part.statistics.pairs);
    EXPECT_GT(part.statistics.tiles_skipped, 0.9 * part.statistics.tiles);
  }
}

}  // namespace
}  // namespace plenoflame::test::skipping_test
