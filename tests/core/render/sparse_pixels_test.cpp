// Pixels of so little worth that chance decides whether they are sampled: right in the mean, with
// standard errors that know about it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"

namespace plenoflame::test {
namespace {

struct Mean {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double x) {
    sum += x;
    squares += x * x;
    ++count;
  }
  double value() const { return sum / count; }
  double error() const { return std::sqrt((squares / count - value() * value()) / (count - 1)); }
};

TEST(SparsePixels, AreRightInTheMeanAndKnowTheirErrors) {
  const CompiledScene scene = compile(paper_flame(64, 64, 0.001));
  RenderSettings settings;
  settings.samples = 1 << 13;
  const RenderResult exact = render(scene, settings, threads(2));
  EXPECT_EQ(exact.statistics.pairs_left_to_chance, 0);
  const std::vector<float>& truth = exact.light_field.channels[0].flux.pixels;
  double brightest = 0;
  for (const float f : truth) brightest = std::max(brightest, static_cast<double>(f));
  std::vector<std::size_t> dim;
  double dim_flux = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (truth[i] > 0 && static_cast<double>(truth[i]) < 0.05 * brightest) {
      dim.push_back(i);
      dim_flux += static_cast<double>(truth[i]);
    }
  ASSERT_GT(dim.size(), 100U);

  settings.samples = 8;
  Mean flux, excess;
  double left_to_chance = 0;
  for (int seed = 1; seed <= 600; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    const RenderResult result = render(scene, settings, one_thread());
    left_to_chance += result.statistics.pairs_left_to_chance;
    const LightFieldChannel& channel = result.light_field.channels[0];
    double sum = 0, stated = 0, true_squares = 0;
    for (const std::size_t i : dim) {
      const double f = static_cast<double>(channel.flux.pixels[i]);
      const double e = static_cast<double>(channel.standard_error.pixels[i]);
      const double off = f - static_cast<double>(truth[i]);
      sum += f;
      stated += e * e;
      true_squares += off * off;
    }
    flux.add(sum / dim_flux);
    excess.add(stated - true_squares);
  }
  EXPECT_GT(left_to_chance, 0);
  // The reference's own error is a hundredth of that of so few points.
  EXPECT_TRUE(within_standard_errors(flux.value(), 1, flux.error(), 4));
  EXPECT_LT(flux.error(), 0.01);
  EXPECT_TRUE(within_standard_errors(excess.value(), 0, excess.error(), 4));
}

}  // namespace
}  // namespace plenoflame::test
