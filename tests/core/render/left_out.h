#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>

#include "plenoflame/render/render.h"
#include "support/approx.h"

namespace plenoflame::test {

/// The picture is the same where nothing is left out of it. @return share of the rays that are left
inline double expect_left_out_sees_nothing(const CompiledScene& scene) {
  RenderSettings settings;
  settings.samples = 64;
  settings.precision = Precision::double_precision;
  const RenderResult left_out = render(scene, settings);
  settings.skip = false;
  const RenderResult all = render(scene, settings);
  EXPECT_GT(left_out.statistics.flux, 0);
  const auto& few = left_out.light_field.channels[0].flux.pixels;
  const auto& every = all.light_field.channels[0].flux.pixels;
  const auto largest = static_cast<double>(*std::max_element(every.begin(), every.end()));
  for (std::size_t i = 0; i < every.size(); ++i)
    EXPECT_TRUE(within(static_cast<double>(few[i]), static_cast<double>(every[i]), 1e-6, largest))
        << "pixel " << i;
  return left_out.statistics.rays / all.statistics.rays;
}

}  // namespace plenoflame::test
