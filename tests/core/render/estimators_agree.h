#pragma once
#include <gtest/gtest.h>

#include <cmath>

#include "plenoflame/render/render.h"
#include "support/approx.h"

namespace plenoflame::test {

/// Pictures of 60 x 60 pixels by both estimators, in blocks of pixels and as a whole: within their
/// standard errors, which are below a percent of the flux.
inline void expect_estimators_agree(const CompiledScene& scene) {
  RenderSettings settings;
  settings.samples = 256;
  settings.replicates = 8;
  const RenderResult backward = render(scene, settings);
  settings.estimator = Estimator::forward;
  settings.samples = 1'000'000;
  const RenderResult forward = render(scene, settings);
  constexpr int kBlock = 10;
  double squares = 0, total = 0, variance = 0, other = 0;
  int blocks = 0;
  for (int top = 0; top < 60; top += kBlock)
    for (int left = 0; left < 60; left += kBlock) {
      double b = 0, f = 0, v = 0;
      for (int row = top; row < top + kBlock; ++row)
        for (int column = left; column < left + kBlock; ++column) {
          const LightFieldChannel& from = backward.light_field.channels[0];
          const LightFieldChannel& to = forward.light_field.channels[0];
          b += static_cast<double>(from.flux.at(column, row));
          f += static_cast<double>(to.flux.at(column, row));
          v += std::pow(static_cast<double>(from.standard_error.at(column, row)), 2) +
               std::pow(static_cast<double>(to.standard_error.at(column, row)), 2);
        }
      total += f;
      other += b;
      variance += v;
      if (!(f > 0) || !(v > 0)) continue;
      ++blocks;
      squares += (b - f) * (b - f) / v;
      EXPECT_TRUE(within_standard_errors(b, f, std::sqrt(v), 5)) << left << ", " << top;
    }
  EXPECT_GT(blocks, 8);
  EXPECT_LT(squares / blocks, 2.5);
  EXPECT_LT(std::sqrt(variance), 0.01 * total);
  EXPECT_TRUE(within_standard_errors(other, total, std::sqrt(variance), 4));
}

}  // namespace plenoflame::test
