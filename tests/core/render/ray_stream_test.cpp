// The rays of pixels as a stream: they make the picture, whoever consumes them.
#include "plenoflame/render/ray_stream.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/render/stream_picture.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/ray_paths.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"
#include "support/small_scene.h"
#include "support/uniform_medium.h"

namespace plenoflame::test::ray_stream_test {
namespace {

struct Case {
  std::string name;
  Scene scene;
  PixelWindow window;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

Scene small(const MainLensSpec& lens, Lattice lattice, LensModel array) {
  return small_scene(lens, large_array(lattice, array));
}

Scene glasses() {
  Scene scene = small(singlet(), Lattice::square, LensModel::real);
  scene.camera.lens.surfaces[0].glass = "N-SF11";
  scene.camera.array.types[0].glass = "N-BK7";
  scene.channels = {{"red", ChannelKind::band, 700e-9, 10e-9},
                    {"blue", ChannelKind::band, 450e-9, 10e-9}};
  return scene;
}

Scene clear_between() {
  Scene scene = small(singlet(), Lattice::square, LensModel::real);
  scene.camera.array.diameter = 0.7 * scene.camera.array.pitch;
  scene.camera.array.opaque_between = false;
  return scene;
}

Scene coated() {
  Scene scene = small(singlet(), Lattice::hexagonal, LensModel::real);
  scene.camera.transmission.fresnel = true;
  return scene;
}

Scene two_channels() {
  Scene scene = small(ideal_singlet(), Lattice::hexagonal, LensModel::ideal);
  scene.channels = {{"red", ChannelKind::band, 700e-9, 10e-9},
                    {"blue", ChannelKind::band, 450e-9, 10e-9}};
  return scene;
}

std::vector<Case> cases() {
  const PixelWindow all{0, 0, 60, 60};
  return {{"paper, a part", paper_flame(200, 180, 0.001), {60, 40, 90, 70}},
          {"bare", bare_flame(40, 30, 0.2e-3), {0, 0, 40, 30}},
          {"bare, real lens", small_scene(singlet(), {}), all},
          {"square", small(singlet(), Lattice::square, LensModel::real), {7, 11, 40, 33}},
          {"three types", small(singlet(), Lattice::hexagonal, LensModel::real), all},
          {"two channels", two_channels(), all},
          {"clear between", clear_between(), all},
          {"reflecting", coated(), all},
          {"two paths", glasses(), all}};
}

class EveryScene : public testing::TestWithParam<Case> {
 protected:
  CompiledScene scene_ = compile(GetParam().scene);
  RenderSettings settings(Precision precision) const {
    RenderSettings settings;
    settings.window = GetParam().window;
    settings.samples = 24;
    settings.precision = precision;
    settings.control_variate = false;
    return settings;
  }
};

template <class Real>
void expect_picture(const CompiledScene& scene, const RenderSettings& settings,
                    RayStreamContent content) {
  const LightField field = render(scene, settings, threads(2)).light_field;
  for (const int count : {1, 2}) {
    const StreamPicture<Real> picture(scene, settings, threads(count), content);
    // The picture's sums of up to 8 rays are the tracer's, and its pixels single precision.
    const double tolerance =
        std::is_same_v<Real, float> ? 1e-5 : 2 * std::numeric_limits<float>::epsilon();
    double total = 0;
    for (std::size_t c = 0; c < field.channels.size(); ++c) {
      const auto& expected = field.channels[c].flux.pixels;
      const std::vector<double>& sums = picture.flux(c);
      ASSERT_EQ(sums.size(), expected.size());
      for (std::size_t i = 0; i < sums.size(); ++i) {
        ASSERT_TRUE(relative(sums[i], static_cast<double>(expected[i]), tolerance))
            << "pixel " << i << ", channel " << c;
        total += sums[i];
      }
    }
    EXPECT_GT(total, 0);
  }
}

TEST_P(EveryScene, SumOverRaysIsThePictureInDoublePrecision) {
  const RenderSettings of_run = settings(Precision::double_precision);
  expect_picture<double>(scene_, of_run, RayStreamContent::rays);
  expect_picture<double>(scene_, of_run, RayStreamContent::radiance);
}

TEST_P(EveryScene, SumOverRaysIsThePictureInSinglePrecision) {
  const RenderSettings of_run = settings(Precision::single_precision);
  expect_picture<float>(scene_, of_run, RayStreamContent::rays);
  expect_picture<float>(scene_, of_run, RayStreamContent::radiance);
}

// One point of each of four randomisations: all factors but two are powers of two, and the picture
// adds ray by ray, so that not even the last bit may differ.
TEST_P(EveryScene, BitsAreThoseOfThePicture) {
  RenderSettings of_run = settings(Precision::double_precision);
  of_run.samples = of_run.replicates = 4;
  const LightField field = render(scene_, of_run, threads(2)).light_field;
  const StreamPicture<double> picture(scene_, of_run, threads(2), RayStreamContent::rays);
  for (std::size_t c = 0; c < field.channels.size(); ++c)
    for (std::size_t i = 0; i < field.channels[c].flux.pixels.size(); ++i) {
      ASSERT_EQ(static_cast<float>(picture.flux(c)[i]), field.channels[c].flux.pixels[i]);
      ASSERT_TRUE(relative(picture.standard_error(c)[i],
                           static_cast<double>(field.channels[c].standard_error.pixels[i]), 1e-6));
    }
}

// A pixel's sum, in the order in which its rays come, is the same in any window.
TEST_P(EveryScene, WindowDoesNotMatter) {
  RenderSettings of_run = settings(Precision::single_precision);
  of_run.samples = 4;
  const StreamPicture<float> whole(scene_, of_run, threads(2), RayStreamContent::rays);
  const PixelWindow all = of_run.window;
  const PixelWindow part{all.x + 3, all.y + 5, all.width - 12, all.height - 9};
  of_run.window = part;
  const StreamPicture<float> cut(scene_, of_run, threads(1), RayStreamContent::rays);
  for (int row = 0; row < part.height; ++row)
    for (int column = 0; column < part.width; ++column)
      ASSERT_EQ(cut.flux(0)[static_cast<std::size_t>(row * part.width + column)],
                whole.flux(0)[static_cast<std::size_t>((row + 5) * all.width + column + 3)]);
}

/// The rays of a pixel against exported paths, which the camera's own trace of single rays follows:
/// it shares no code with the vector kernels. @return number of rays, and of those that ended
std::pair<std::size_t, std::size_t> compare_with_exact_trace(const CompiledScene& scene,
                                                             RenderSettings settings, Pixel pixel) {
  settings.window = {pixel.column, pixel.row, 1, 1};
  RayPaths paths = empty_ray_paths(scene);
  add_pixel_rays(scene, settings, {pixel}, one_thread(), paths);
  std::size_t at = 0, ended = 0;
  const RayBlockConsumer<double> compare = [&](const RayBlock<double>& block, int) {
    for (int k = 0; k < block.size; ++k, ++at) {
      const auto i = static_cast<std::size_t>(k);
      ASSERT_LT(at, paths.rays.size());
      const RayPath& ray = paths.rays[at];
      EXPECT_EQ(block.columns[i], ray.column);
      EXPECT_EQ(block.rows[i], ray.row);
      EXPECT_EQ(block.lenses[i], ray.lens);
      EXPECT_EQ(block.types[i], ray.type);
      EXPECT_EQ(block.status[i], ray.status);
      if (ray.status.status != RayStatus::reached) {
        EXPECT_EQ(block.etendue[i], 0);
        ++ended;
        continue;
      }
      EXPECT_TRUE(relative(block.etendue[i], ray.weight, 1e-10));
      EXPECT_GE(block.sampled_etendue[i], block.etendue[i]);
      const Vec3 in_scene = paths.vertices[ray.first + ray.count - 1].position;
      const RayBatch<double>& lines = block.rays;
      const Vec3 along{lines.dx[k], lines.dy[k], lines.dz[k]};
      const Vec3 origin = lines.anchor + Vec3{lines.x[k], lines.y[k], lines.z[k]};
      EXPECT_TRUE(relative(length(along), 1, 1e-13));
      // The vertex' distance from the line, beside its distance from the camera (1 m).
      EXPECT_LT(length(cross(in_scene - origin, along)), 1e-11);
    }
  };
  EXPECT_TRUE(stream_rays<double>(scene, settings, one_thread(), compare));
  EXPECT_EQ(at, paths.rays.size());
  return {at, ended};
}

TEST_P(EveryScene, RaysEndWhereTheExactTraceEnds) {
  RenderSettings of_run = settings(Precision::double_precision);
  of_run.skip = false;
  const PixelWindow all = of_run.window;
  std::size_t rays = 0, ended = 0;
  // Exported paths know one wavelength: the last of several.
  const CompiledScene& scene = scene_.paths().back();
  for (int k = 1; k < 10; ++k) {
    const Pixel pixel{all.x + k * all.width / 10, all.y + (k * 7 % 10) * all.height / 10};
    const auto [of_pixel, of_them_ended] = compare_with_exact_trace(scene, of_run, pixel);
    rays += of_pixel;
    ended += of_them_ended;
  }
  EXPECT_GT(rays, 100u);
  if (GetParam().scene.camera.array.present) {
    EXPECT_GT(ended, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(RayStream, EveryScene, testing::ValuesIn(cases()));

/// All that identifies a block but its worker.
struct Seen {
  int size = 0;
  double etendue = 0, x = 0;
  friend bool operator==(const Seen&, const Seen&) = default;
};

std::map<std::pair<int, int>, Seen> blocks_of(const CompiledScene& scene,
                                              const RenderSettings& settings, int count) {
  std::map<std::pair<int, int>, Seen> blocks;
  std::map<int, std::pair<int, int>> last;  // of each tile, the worker and the sequence
  std::mutex mutex;
  const RayBlockConsumer<float> note = [&](const RayBlock<float>& block, int worker) {
    Seen seen{block.size, 0, 0};
    for (int i = 0; i < block.size; ++i) {
      seen.etendue += static_cast<double>(block.etendue[static_cast<std::size_t>(i)]);
      seen.x +=
          static_cast<double>(block.rays.x[i]) * (1 + block.columns[static_cast<std::size_t>(i)]);
    }
    const std::lock_guard lock(mutex);
    EXPECT_LT(worker, count);
    const auto [known, is_new] = last.try_emplace(block.tile, worker, -1);
    EXPECT_EQ(known->second.first, worker);
    EXPECT_EQ(++known->second.second, block.sequence);
    EXPECT_TRUE(blocks.emplace(std::pair{block.tile, block.sequence}, seen).second);
    EXPECT_EQ(block.rays.size % kRayPadding, 0);
    EXPECT_GE(block.rays.size, block.size);
  };
  EXPECT_TRUE(stream_rays<float>(scene, settings, threads(count), note));
  return blocks;
}

TEST(RayStream, BlocksDoNotDependOnThreads) {
  Scene paths = glasses();
  paths.camera.sensor = {150, 140, 0.08e-3};
  for (const Scene& scene : {paper_flame(200, 150, 0.001), paths}) {
    const CompiledScene compiled = compile(scene);
    RenderSettings settings;
    settings.samples = 4;
    const auto alone = blocks_of(compiled, settings, 1);
    EXPECT_GT(alone.rbegin()->first.first, 3);  // several tiles
    EXPECT_EQ(blocks_of(compiled, settings, 2), alone);
    EXPECT_EQ(blocks_of(compiled, settings, 5), alone);
  }
}

// A thin lens that is open as far as its rim: a pixel's etendue is pi * its area * the view factor
// of the lens, r^2 / (r^2 + d^2) on the axis.
TEST(RayStream, EtendueOfAThinLensIsElementary) {
  CameraSpec spec;
  spec.lens.model = LensModel::ideal;
  spec.lens.focal_length = 0.05;
  spec.sensor = {3, 3, 1e-5};
  spec.focus.object_distance = 1;
  spec.focus.conjugate = "sensor";
  for (const double diameter : {0.005, 0.025, 0.1}) {
    spec.lens.diameter = diameter;
    const CompiledScene scene = scene_of(spec, std::make_unique<UniformMedium>());
    RenderSettings settings;
    settings.samples = 1024;
    settings.window = {1, 1, 1, 1};
    double sum = 0, sampled = 0;
    const RayBlockConsumer<double> add = [&](const RayBlock<double>& block, int) {
      for (const double e : block.etendue) sum += e;
      for (const double e : block.sampled_etendue) sampled += e;
    };
    stream_rays<double>(scene, settings, one_thread(), add);
    const double d = scene.camera.lens_distance(), r = 0.5 * diameter;
    const double expected = std::acos(-1.0) * 1e-10 * r * r / (r * r + d * d);
    EXPECT_TRUE(relative(sum, expected, 1e-4)) << diameter;
    EXPECT_GE(sampled, sum);  // the disc that is sampled exceeds the rim by 1e-5
    EXPECT_TRUE(relative(sampled, expected, 1e-4)) << diameter;
  }
}

// Lines begin in the plane where the camera ends.
TEST(RayStream, LightIsCollectedFromTheFrontOfTheCamera) {
  const CompiledScene scene = compile(small(singlet(), Lattice::square, LensModel::real));
  RenderSettings settings;
  settings.samples = 4;
  int seen = 0;
  const RayBlockConsumer<double> look = [&](const RayBlock<double>& block, int) {
    const RigidTransform camera = block.scene->camera.to_world().inverse();
    for (int i = 0; i < block.size; ++i) {
      const RayBatch<double>& r = block.rays;
      const Vec3 at =
          r.anchor + Vec3{r.x[i], r.y[i], r.z[i]} + r.t_near[i] * Vec3{r.dx[i], r.dy[i], r.dz[i]};
      // The front surface is convex: it ends at its vertex, the origin of the camera's frame.
      EXPECT_LT(std::fabs(camera.point(at).z), 1e-12);
      EXPECT_TRUE(std::isinf(r.t_far[i]));
      ++seen;
    }
  };
  stream_rays<double>(scene, settings, one_thread(), look);
  EXPECT_GT(seen, 1000);
}

TEST(RayStream, RefusesWhatIsNoFixedNumberOfRays) {
  const CompiledScene scene = compile(small(singlet(), Lattice::square, LensModel::real));
  const RayBlockConsumer<float> none = [](const RayBlock<float>&, int) { FAIL(); };
  const auto refuses = [&](const auto& change) {
    RenderSettings settings;
    change(settings);
    EXPECT_THROW(stream_rays<float>(scene, settings, one_thread(), none), UsageError);
  };
  refuses([](RenderSettings& s) { s.estimator = Estimator::forward; });
  refuses([](RenderSettings& s) { s.target_error = 0.01; });
  refuses([](RenderSettings& s) { s.time_limit = 1; });
  refuses([](RenderSettings& s) { s.samples = 1; });
  refuses([](RenderSettings& s) { s.window = {50, 50, 11, 2}; });
}

TEST(RayStream, EndsWithTheConsumersExceptionAndOnAStop) {
  const CompiledScene scene = compile(paper_flame(200, 150, 0.001));
  RenderSettings settings;
  settings.samples = 4;
  const RayBlockConsumer<float> full = [](const RayBlock<float>&, int) {
    throw std::length_error("full");
  };
  EXPECT_THROW(stream_rays<float>(scene, settings, threads(2), full), std::length_error);
  std::stop_source stop;
  Execution execution = one_thread();
  execution.stop = stop.get_token();
  int last = 0;
  const RayBlockConsumer<float> once = [&](const RayBlock<float>& block, int) {
    stop.request_stop();
    last = block.tile;
  };
  EXPECT_FALSE(stream_rays<float>(scene, settings, execution, once));
  EXPECT_LT(last, 11);
}

TEST(RayStream, ProgressIsThatOfTheWindow) {
  const CompiledScene scene = compile(paper_flame(200, 150, 0.001));
  RenderSettings settings;
  settings.samples = 2;
  Execution execution = threads(2);
  std::vector<double> fractions;
  execution.progress = [&](const Progress& progress) { fractions.push_back(progress.fraction); };
  stream_rays<float>(scene, settings, execution, [](const RayBlock<float>&, int) {});
  // 200 x 150 pixels in 12 tiles of 64 x 64, each of which takes several blocks of rays.
  ASSERT_GT(fractions.size(), 24u);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace plenoflame::test::ray_stream_test
