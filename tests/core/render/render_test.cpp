// Settings that a rendering must not depend on, and its statements about itself.
#include "plenoflame/render/render.h"

#include <cmath>
#include <stop_token>
#include <utility>
#include <vector>

#include "plenoflame/base/error.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"
#include "support/uniform_medium.h"

namespace plenoflame::test::render_test {
namespace {

void expect_same(const LightField& a, const LightField& b) {
  ASSERT_EQ(a.channels.size(), b.channels.size());
  for (std::size_t c = 0; c < a.channels.size(); ++c) {
    EXPECT_EQ(a.channels[c].flux.pixels, b.channels[c].flux.pixels);
    EXPECT_EQ(a.channels[c].standard_error.pixels, b.channels[c].standard_error.pixels);
  }
}

double total(const Image& image) {
  double sum = 0;
  for (const float p : image.pixels) sum += static_cast<double>(p);
  return sum;
}

TEST(Render, AnyNumberOfThreads) {
  const CompiledScene scene = compile(paper_flame(200, 170, 0.009));
  RenderSettings settings;
  settings.samples = 8;
  const RenderResult one = render(scene, settings, one_thread());
  EXPECT_GT(one.statistics.flux, 0);
  for (const int count : {2, 7}) {
    const RenderResult many = render(scene, settings, threads(count));
    EXPECT_EQ(many.statistics.threads, count);
    expect_same(many.light_field, one.light_field);
    EXPECT_EQ(many.statistics.rays, one.statistics.rays);
    EXPECT_EQ(many.statistics.rays_reached, one.statistics.rays_reached);
  }
}

TEST(Render, AWindowIsPartOfTheWholeImage) {
  for (const bool array : {true, false}) {
    const CompiledScene scene =
        compile(array ? paper_flame(200, 170, 0.009) : bare_flame(200, 170, 1e-4));
    RenderSettings settings;
    settings.samples = 10;
    const Image whole = render(scene, settings, one_thread()).light_field.channels[0].flux;
    EXPECT_GT(total(whole), 0);
    for (const PixelWindow w : {PixelWindow{0, 0, 1, 1}, PixelWindow{63, 65, 67, 3},
                                PixelWindow{130, 17, 70, 80}, PixelWindow{99, 84, 3, 3}}) {
      settings.window = w;
      const LightField part = render(scene, settings, one_thread()).light_field;
      EXPECT_EQ(part.window.x, w.x);
      for (int row = 0; row < w.height; ++row)
        for (int column = 0; column < w.width; ++column)
          ASSERT_EQ(part.channels[0].flux.at(column, row), whole.at(w.x + column, w.y + row))
              << (array ? "array, " : "bare, ") << w.x + column << ", " << w.y + row;
    }
  }
}

TEST(Render, TheSeedDecides) {
  const CompiledScene scene = compile(paper_flame(60, 60));
  RenderSettings settings;
  settings.samples = 8;
  const RenderResult a = render(scene, settings), b = render(scene, settings);
  expect_same(a.light_field, b.light_field);
  settings.seed = 2;
  const RenderResult c = render(scene, settings);
  EXPECT_NE(a.light_field.channels[0].flux.pixels, c.light_field.channels[0].flux.pixels);
  EXPECT_TRUE(relative(c.statistics.flux, a.statistics.flux, 0.01));
}

TEST(Render, SkippingChangesNoPixel) {
  std::vector<CompiledScene> scenes;
  scenes.push_back(compile(paper_flame(200, 170, 0.009)));
  scenes.push_back(compile(bare_flame(200, 170, 1e-4)));
  // A thin box in the focal plane of an ideal camera: beams are points there, pixels are not.
  const Scene bare = bare_flame(200, 170, 1e-4);
  scenes.push_back(scene_of(bare.camera, std::make_unique<UniformMedium>(Box{
                                             {0.9999, -0.01, -0.02}, {1.0001, 0.0102, 0.0203}})));
  // Small boxes far off the axis, in front of and behind the focal plane.
  for (const double x : {0.4, 3.0})
    scenes.push_back(scene_of(
        bare.camera, std::make_unique<UniformMedium>(
                         Box{{x, 0.007 * x, -0.011 * x}, {x + 0.001, 0.011 * x, -0.007 * x}})));
  for (const CompiledScene& scene : scenes) {
    RenderSettings settings;
    settings.samples = 8;
    const RenderResult with = render(scene, settings, one_thread());
    settings.skip = false;
    const RenderResult without = render(scene, settings, one_thread());
    EXPECT_GT(without.statistics.flux, 0);
    expect_same(with.light_field, without.light_field);
    EXPECT_LE(with.statistics.rays, without.statistics.rays);
  }
}

TEST(Render, SomethingIsSkipped) {
  const CompiledScene scene = compile(paper_flame(3000, 3000));
  RenderSettings settings;
  settings.samples = 2;
  settings.window = {200, 1400, 100, 100};  // beside the flame
  const RenderResult result = render(scene, settings, one_thread());
  EXPECT_EQ(result.statistics.rays, 0);
  EXPECT_EQ(result.statistics.flux, 0);
  settings.skip = false;
  EXPECT_GT(render(scene, settings, one_thread()).statistics.rays, 1e4);
}

TEST(Render, PixelsThatSeeNothingAreExactlyZero) {
  const CompiledScene scene = compile(bare_flame(200, 170, 1e-4));
  RenderSettings settings;
  settings.samples = 16;
  settings.skip = false;
  const Image flux = render(scene, settings, one_thread()).light_field.channels[0].flux;
  // The outer layer is 20 mm wide; with m = 0.43 it covers 86 pixels of 0.1 mm, blur a few more.
  for (int row = 0; row < 170; ++row) {
    for (const int column : {0, 20, 179, 199}) EXPECT_EQ(flux.at(column, row), 0.f);
    EXPECT_GT(flux.at(100, row), 0.f);
  }
}

TEST(Render, SinglePrecisionAndEveryInstructionSet) {
  for (const bool array : {true, false}) {
    const CompiledScene scene =
        compile(array ? paper_flame(120, 100, 0.009) : bare_flame(120, 100, 2e-4));
    RenderSettings settings;
    settings.samples = 64;
    settings.isa = Isa::baseline;
    settings.precision = Precision::double_precision;
    const RenderResult reference = render(scene, settings, one_thread());
    EXPECT_EQ(reference.statistics.precision, "double");
    const Image& exact = reference.light_field.channels[0].flux;
    const double mean = total(exact) / static_cast<double>(exact.pixels.size());
    for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
      if (!is_supported(isa)) continue;
      for (const Precision precision : {Precision::double_precision, Precision::single_precision}) {
        settings.isa = isa;
        settings.precision = precision;
        const RenderResult other = render(scene, settings, one_thread());
        const bool single = precision == Precision::single_precision;
        EXPECT_EQ(other.statistics.precision, single ? "single" : "double");
        const Image& flux = other.light_field.channels[0].flux;
        double squares = 0;
        for (std::size_t i = 0; i < exact.pixels.size(); ++i) {
          const double d =
              static_cast<double>(flux.pixels[i]) - static_cast<double>(exact.pixels[i]);
          squares += d * d;
          // A ray that grazes the rim of the stop or of a layer may fall to either side of it: one
          // of 64 rays. Everything else is rounding.
          EXPECT_TRUE(within(flux.pixels[i], exact.pixels[i], single ? 0.04 : 1e-6,
                             mean + static_cast<double>(exact.pixels[i])))
              << name(isa) << " pixel " << i;
        }
        const double rms = std::sqrt(squares / static_cast<double>(exact.pixels.size()));
        EXPECT_LT(rms, (single ? 1e-3 : 1e-6) * mean) << name(isa);
        EXPECT_TRUE(relative(total(flux), total(exact), single ? 1e-5 : 1e-8));
      }
    }
  }
}

TEST(Render, WrongSettings) {
  const CompiledScene scene = compile(paper_flame(60, 60));
  const auto with = [&](auto change) {
    RenderSettings settings;
    settings.samples = 4;
    change(settings);
    return render(scene, settings, one_thread());
  };
  EXPECT_THROW(with([](RenderSettings& s) { s.samples = 0; }), UsageError);
  EXPECT_THROW(with([](RenderSettings& s) { s.samples = -5; }), UsageError);
  EXPECT_THROW(with([](RenderSettings& s) { s.samples = 1; }), UsageError);  // 2 replicates
  EXPECT_THROW(with([](RenderSettings& s) { s.replicates = 0; }), UsageError);
  for (const PixelWindow w :
       {PixelWindow{0, 0, 61, 1}, PixelWindow{-1, 0, 5, 5}, PixelWindow{0, 0, 5, 0},
        PixelWindow{58, 0, 5, 5}, PixelWindow{0, 2147483647, 5, 5}})
    EXPECT_THROW(with([w](RenderSettings& s) { s.window = w; }), UsageError);
  EXPECT_EQ(with([](RenderSettings& s) { s.samples = 5; }).light_field.samples, 6);
  const RenderResult one = with([](RenderSettings& s) { s.replicates = 1; });
  EXPECT_TRUE(one.light_field.channels[0].standard_error.empty());
}

TEST(Render, StoppedEarlyItIsMarkedPartial) {
  const CompiledScene scene = compile(paper_flame(256, 256));
  RenderSettings settings;
  settings.samples = 4;
  const LightField whole = render(scene, settings, one_thread()).light_field;
  EXPECT_TRUE(whole.complete);
  std::stop_source stop;
  Execution execution = one_thread();
  execution.stop = stop.get_token();
  int reports = 0;
  execution.progress = [&](const Progress& progress) {
    EXPECT_GT(progress.fraction, 0);
    EXPECT_LE(progress.fraction, 1);
    if (++reports == 3) stop.request_stop();
  };
  const RenderResult part = render(scene, settings, execution);
  EXPECT_FALSE(part.light_field.complete);
  EXPECT_FALSE(part.statistics.complete);
  // Pixels that are there are right, the rest is zero.
  int same = 0, missing = 0;
  for (std::size_t i = 0; i < whole.channels[0].flux.pixels.size(); ++i) {
    const float p = part.light_field.channels[0].flux.pixels[i],
                w = whole.channels[0].flux.pixels[i];
    if (w == 0) continue;
    if (p == w)
      ++same;
    else {
      EXPECT_EQ(p, 0.f);
      ++missing;
    }
  }
  EXPECT_GT(same, 0);
  EXPECT_GT(missing, 0);
}

TEST(Render, SceneWithoutFlameIsDark) {
  Scene scene = paper_flame(60, 60);
  scene.flames.clear();
  RenderSettings settings;
  settings.samples = 2;
  const RenderResult result = render(compile(scene), settings, one_thread());
  EXPECT_EQ(result.statistics.flux, 0);
  EXPECT_TRUE(result.light_field.complete);
}

TEST(Render, StandardErrorsAreHonest) {
  // Differences of independent runs in units of their standard errors: with 16 replicates nearly
  // normal, so that a share of 4.6 % lies beyond 2 and 0.27 % beyond 3.
  const CompiledScene scene = compile(paper_flame(60, 60, 0.004));
  RenderSettings settings;
  settings.samples = 16 * 8;
  settings.replicates = 16;
  std::vector<LightFieldChannel> runs;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    settings.seed = seed;
    runs.push_back(render(scene, settings).light_field.channels[0]);
  }
  double count = 0, squares = 0, beyond2 = 0, beyond3 = 0, sum = 0;
  for (std::size_t k = 0; k + 1 < runs.size(); k += 2)
    for (std::size_t i = 0; i < runs[k].flux.pixels.size(); ++i) {
      const double se =
          std::hypot(runs[k].standard_error.pixels[i], runs[k + 1].standard_error.pixels[i]);
      if (!(se > 0)) continue;
      const double z = (static_cast<double>(runs[k].flux.pixels[i]) -
                        static_cast<double>(runs[k + 1].flux.pixels[i])) /
                       se;
      count += 1;
      sum += z;
      squares += z * z;
      beyond2 += std::fabs(z) > 2;
      beyond3 += std::fabs(z) > 3;
    }
  ASSERT_GT(count, 5000);
  // Student's t with 30 degrees of freedom: variance 30/28, 5.5 % beyond 2, 0.54 % beyond 3.
  EXPECT_TRUE(within(squares / count, 30.0 / 28, 0.08, 1));
  EXPECT_TRUE(within(beyond2 / count, 0.0546, 0.012, 1));
  EXPECT_TRUE(within(beyond3 / count, 0.0054, 0.006, 1));
  EXPECT_TRUE(within(sum / count, 0, 4 / std::sqrt(count), 1));
}

}  // namespace
}  // namespace plenoflame::test::render_test
