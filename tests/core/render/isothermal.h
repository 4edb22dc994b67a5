#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "plenoflame/render/render.h"
#include "plenoflame/scene/spectral.h"
#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::test {

/// In surroundings of one temperature there is nothing but the radiance of a black body: the total
/// of each of two channels is that of the camera alone under an even sky.
/// @param scene with flames; `with`: compiled, with all else at this temperature [K], too
inline void expect_isothermal(const Scene& scene, const CompiledScene& with, int samples,
                              double temperature, const std::string& what) {
  RenderSettings settings;
  settings.samples = samples;
  settings.replicates = 16;
  const LightField seen = render(with, settings, one_thread()).light_field;
  Scene dark = scene;
  dark.flames.clear();
  CompiledScene without = compile(dark);
  without.lights.environment = {1, 1};
  const LightField unit = render(without, settings, one_thread()).light_field;
  for (std::size_t c = 0; c < 2; ++c) {
    const double expected = source_function(scene.channels[c])(temperature);
    double sum = 0, variance = 0, all = 0;
    for (std::size_t i = 0; i < seen.channels[c].flux.pixels.size(); ++i) {
      sum += static_cast<double>(seen.channels[c].flux.pixels[i]);
      const double e = static_cast<double>(seen.channels[c].standard_error.pixels[i]);
      variance += e * e;
      all += expected * static_cast<double>(unit.channels[c].flux.pixels[i]);
    }
    // Nodes stand for a wide channel within their stated error.
    const double error = std::sqrt(variance) + with.spectral_error * all;
    EXPECT_LT(error, 0.01 * all);
    EXPECT_TRUE(within_standard_errors(sum, all, error, 4)) << what << " " << c;
  }
}

}  // namespace plenoflame::test
