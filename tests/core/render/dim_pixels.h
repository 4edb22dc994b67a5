#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/tally.h"

namespace plenoflame::test {

struct DimPixelsCase {
  int replicates, samples;
  int seeds;
  int samples_of_truth;
};

/// Renders a scene many times with so few points that its dim pixels get one or two of each
/// randomisation: their mean is that of many points, and the stated errors are theirs.
inline void expect_dim_pixels_right(const CompiledScene& scene, const DimPixelsCase& with) {
  RenderSettings settings;
  settings.samples = with.samples_of_truth;
  settings.seed = 0x7275656;
  const RenderResult exact = render(scene, settings, threads(2));
  const LightFieldChannel& reference = exact.light_field.channels[0];
  const PixelValues& truth = reference.flux.pixels;
  double brightest = 0;
  for (const float f : truth) brightest = std::max(brightest, static_cast<double>(f));
  std::vector<std::size_t> dim;
  double dim_flux = 0, of_truth = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (truth[i] > 0 && static_cast<double>(truth[i]) < 0.05 * brightest) {
      dim.push_back(i);
      dim_flux += static_cast<double>(truth[i]);
      const double e = static_cast<double>(reference.standard_error.pixels[i]);
      of_truth += e * e;
    }
  ASSERT_GT(dim.size(), 100U);

  settings.samples = with.samples;
  settings.replicates = with.replicates;
  Tally flux, excess;
  for (int seed = 1; seed <= with.seeds; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    const RenderResult result = render(scene, settings, one_thread());
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
    excess.add((stated - true_squares + of_truth) / (dim_flux * dim_flux));
  }
  const double error = std::hypot(flux.error(), std::sqrt(of_truth) / dim_flux);
  EXPECT_TRUE(within_standard_errors(flux.value(), 1, error, 4));
  EXPECT_LT(error, 0.01);
  EXPECT_TRUE(within_standard_errors(excess.value(), 0, excess.error(), 4));
}

}  // namespace plenoflame::test
