#include "plenoflame/render/exposure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "plenoflame/media/brightened_medium.h"
#include "plenoflame/media/layered_medium.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::exposure_test {
namespace {

Scene flame_at(double y, double brightness = 1) {
  Scene scene =
      test::small_scene(test::singlet(), test::large_array(Lattice::hexagonal, LensModel::real));
  scene.flames[0].position.y = y;
  scene.flames[0].brightness = brightness;
  return scene;
}

RenderResult expose(const std::vector<SceneMoment>& moments, const RenderSettings& settings) {
  std::optional<CompiledScene> compiled;
  return render_exposure(
      moments,
      [&](const Scene& scene) -> const CompiledScene& {
        compiled = compile(scene);
        return *compiled;
      },
      settings);
}

RenderSettings settings_of(int samples, std::uint64_t seed) {
  RenderSettings settings;
  settings.samples = samples;
  settings.seed = seed;
  return settings;
}

const Image& flux_of(const RenderResult& result) {
  return result.light_field.channels.front().flux;
}
const Image& error_of(const RenderResult& result) {
  return result.light_field.channels.front().standard_error;
}

TEST(Exposure, OneMomentIsThatPicture) {
  const Scene scene = flame_at(0.001);
  const RenderSettings settings = settings_of(8, 3);
  const RenderResult alone = render(compile(scene), settings);
  const RenderResult exposed = expose({{scene, 1}}, settings);
  EXPECT_EQ(flux_of(exposed), flux_of(alone));
  EXPECT_EQ(error_of(exposed), error_of(alone));
  EXPECT_FALSE(exposed.light_field.numbers.contains("exposure.moments"));
}

// The reference: each moment by itself with many more samples, summed here. Differences in units of
// the stated errors follow Student's t with 7 degrees of freedom, half of which is below 0.711 by
// magnitude; the median does not mind pixels that hardly any ray reaches.
TEST(Exposure, ItIsTheMeanWithHonestErrors) {
  const double shares[] = {0.2, 0.5, 0.3};
  const Scene scenes[] = {flame_at(0.001), flame_at(0.004), flame_at(-0.003, 3)};
  std::vector<SceneMoment> moments;
  std::vector<double> expected(60 * 60);
  for (std::size_t i = 0; i < 3; ++i) {
    moments.push_back({scenes[i], shares[i]});
    const RenderResult fine = render(compile(scenes[i]), settings_of(4096, 7));
    for (std::size_t p = 0; p < expected.size(); ++p)
      expected[p] += shares[i] * static_cast<double>(flux_of(fine).pixels[p]);
  }
  RenderSettings settings = settings_of(96, 1);
  settings.replicates = 8;
  const RenderResult result = expose(moments, settings);
  const double lit = 0.01 * *std::max_element(expected.begin(), expected.end());
  std::vector<double> differences;
  double sum = 0, whole = 0;
  for (std::size_t p = 0; p < expected.size(); ++p) {
    const double flux = static_cast<double>(flux_of(result).pixels[p]);
    sum += flux;
    whole += expected[p];
    if (expected[p] > lit)
      differences.push_back(std::fabs(flux - expected[p]) /
                            static_cast<double>(error_of(result).pixels[p]));
  }
  ASSERT_GT(differences.size(), 300u);
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  EXPECT_TRUE(test::relative(*middle, 0.711, 0.12));
  EXPECT_TRUE(test::relative(sum, whole, 2e-3));
  EXPECT_EQ(result.light_field.numbers.at("exposure.moments"), 3);
  EXPECT_TRUE(test::relative(result.statistics.flux, sum, 1e-12));
}

TEST(Exposure, TheTargetIsThatOfTheMean) {
  std::vector<SceneMoment> moments{{flame_at(0.001), 0.5}, {flame_at(0.003, 0.1), 0.5}};
  RenderSettings settings = settings_of(kMostSamples, 1);
  settings.target_error = 0.02;
  const RenderResult result = expose(moments, settings);
  EXPECT_TRUE(result.statistics.target_reached);
  EXPECT_LE(result.statistics.relative_error_bound, 0.02);
  EXPECT_GT(result.statistics.relative_error_bound, 0.005);  // no more work than that asks for
}

// Closed form: along the diameter of a sphere b (1 - exp(-2 kappa R)) S.
TEST(Exposure, BrightnessIsAFactorOnTheLight) {
  const auto medium = std::shared_ptr<const Medium>(make_layered_medium(
      {{{0, 0, 0}, {0.01, 0.01, 0.01}, 1500, 40}}, {}, {SourceFunction::total()}));
  const auto bright = brightened(medium, 2.5);
  EXPECT_EQ(brightened(medium, 1), medium);
  const double source = 5.670374419e-8 * std::pow(1500.0, 4) / 3.14159265358979323846;
  const Ray ray{{-1, 0, 0}, {1, 0, 0}};
  const std::vector<double> seen = integrate_reference(*bright, ray, 0, 2);
  EXPECT_TRUE(test::relative(seen[0], 2.5 * source * -std::expm1(-0.8), 1e-9));
  EXPECT_TRUE(test::relative(seen[1], 0.8, 1e-9));  // what it absorbs stays
  // The way of the renderer: two scenes, the flame's light twice as bright.
  const RenderSettings settings = settings_of(8, 3);
  const RenderResult one = expose({{flame_at(0.001), 1}}, settings);
  const RenderResult two = expose({{flame_at(0.001, 2), 1}}, settings);
  for (std::size_t p = 0; p < flux_of(one).pixels.size(); ++p)
    ASSERT_TRUE(test::relative(static_cast<double>(flux_of(two).pixels[p]),
                               2 * static_cast<double>(flux_of(one).pixels[p]), 1e-6));
}

}  // namespace
}  // namespace plenoflame::exposure_test
