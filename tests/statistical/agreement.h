#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/length.h"

/// Both estimators against each other, in standard errors.
namespace plenoflame::test {

inline const int kBundles = in_full() ? 20000000 : 600000, kRaysPerReplicate = in_full() ? 256 : 16;
/// Relative standard error of the whole image's flux, at most.
inline const double kTotalError = in_full() ? 1e-3 : 1e-2;
inline const double kMostEffort =
    in_full() ? 12 : 1;  ///< times these numbers where they do not reach that
inline constexpr int kReplicates = 16;
inline constexpr int kBin = 3;  ///< pixels along the side of a bin

struct Bins {
  std::vector<double> flux, variance;
  double total = 0, total_variance = 0;
};

/// Sums over bins; pixels are independent in both estimators.
inline Bins bins_of(const LightFieldChannel& channel) {
  Bins bins;
  const int across = (channel.flux.width + kBin - 1) / kBin,
            down = (channel.flux.height + kBin - 1) / kBin;
  bins.flux.assign(static_cast<std::size_t>(across * down), 0);
  bins.variance = bins.flux;
  for (int row = 0; row < channel.flux.height; ++row)
    for (int column = 0; column < channel.flux.width; ++column) {
      const auto bin = static_cast<std::size_t>(row / kBin * across + column / kBin);
      const double f = static_cast<double>(channel.flux.at(column, row));
      const double s = static_cast<double>(channel.standard_error.at(column, row));
      bins.flux[bin] += f;
      bins.variance[bin] += s * s;
      bins.total += f;
      bins.total_variance += s * s;
    }
  return bins;
}

/// The factor of more work that brings an estimator's share of the total's variance down to half of
/// what kTotalError allows.
inline double needed_effort(const LightField& field) {
  double most = 0;
  for (const LightFieldChannel& channel : field.channels) {
    const Bins bins = bins_of(channel);
    const double allowed = 0.5 * kTotalError * kTotalError * bins.total * bins.total;
    if (allowed > 0) most = std::max(most, bins.total_variance / allowed);
  }
  return most;
}

/// Renders, and, for the long tests, once again with more samples where the total is not known well
/// enough: scenes differ in how few rays find light. The short ones must do with what they get.
inline RenderResult render_well(const CompiledScene& scene, RenderSettings& settings) {
  RenderResult result = render(scene, settings);
  const double more = 1.2 * needed_effort(result.light_field);
  if (kMostEffort <= 1 || more <= 1.2) return result;
  settings.samples = static_cast<int>(std::ceil(std::min(more, kMostEffort) * settings.samples));
  settings.seed += 1000;  // what has decided is not used again
  return render(scene, settings);
}

/// @param bundles of the forward estimator @param rays of the backward one, a pixel and replicate
inline void expect_agreement(const Scene& scene, const MediumLoader& loader = load_core_medium,
                             int bundles = kBundles, int rays = kRaysPerReplicate) {
  const CompiledScene compiled = compile(scene, loader);
  RenderSettings settings;
  settings.replicates = kReplicates;
  settings.samples = rays * kReplicates;
  const RenderResult backward = render_well(compiled, settings);
  settings.estimator = Estimator::forward;
  settings.samples = bundles;
  const RenderResult forward = render_well(compiled, settings);
  bundles = settings.samples;
  for (std::size_t c = 0; c < scene.channels.size(); ++c) {
    const Bins f = bins_of(forward.light_field.channels[c]),
               b = bins_of(backward.light_field.channels[c]);
    const double error = std::sqrt(f.total_variance + b.total_variance);
    EXPECT_GT(b.total, 0);
    EXPECT_LT(error, kTotalError * b.total);
    EXPECT_TRUE(within_standard_errors(f.total, b.total, error, 3));
    // Bins with fewer than a few dozen bundles are not normal; they are gathered in one. Bundles
    // count as many as equal ones would be, by the scatter of their total: where lights and
    // reflections make them uneven, few carry most of it.
    const double typical =
        std::min(bundles * forward.statistics.rays_reached / forward.statistics.rays,
                 f.total * f.total / f.total_variance);
    double chi_square = 0, rest = 0, rest_variance = 0;
    int count = 0;
    for (std::size_t i = 0; i < b.flux.size(); ++i) {
      const double variance = f.variance[i] + b.variance[i];
      if (b.flux[i] * typical < 30 * b.total) {
        rest += f.flux[i] - b.flux[i];
        rest_variance += variance;
        continue;
      }
      chi_square += (f.flux[i] - b.flux[i]) * (f.flux[i] - b.flux[i]) / variance;
      ++count;
    }
    if (rest_variance > 0) {
      chi_square += rest * rest / rest_variance;
      ++count;
    }
    std::printf(
        "channel %zu: total off by %+.4f %% = %+.2f standard errors; chi-square %.3f of %d bins\n",
        c, 100 * (f.total / b.total - 1), (f.total - b.total) / error, chi_square / count, count);
    EXPECT_GE(count, 20);
    // Variances from 16 replicates make chi-square larger by (R - 1) / (R - 3) at most. Four
    // standard deviations of a chi-square above that.
    const double inflation = (kReplicates - 1.0) / (kReplicates - 3.0);
    EXPECT_LT(chi_square / count, inflation * (1 + 4 * std::sqrt(2.0 / count)));
    EXPECT_GT(chi_square / count, 1 - 4 * std::sqrt(2.0 / count));
  }
}

}  // namespace plenoflame::test
