#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/length.h"

/// Measured errors of whole images: how they fall with the number of samples, and how they compare
/// with what is stated about them.
namespace plenoflame::test {

inline const int kSeeds = in_full() ? 400 : 100;

/// Slope of log RMSE over lit pixels against log samples, least squares, double precision.
inline double convergence_slope(const CompiledScene& scene, PixelWindow window,
                                int reference_samples = 1 << 15) {
  RenderSettings settings;
  settings.window = window;
  settings.precision = Precision::double_precision;
  settings.samples = reference_samples;
  settings.seed = 99;
  const Image exact = render(scene, settings).light_field.channels[0].flux;
  float brightest = 0;
  for (const float p : exact.pixels) brightest = std::max(brightest, p);
  std::vector<double> x, y;
  for (int samples = 16; samples <= 1024; samples *= 4) {
    double squares = 0;
    int lit = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      settings.samples = samples;
      settings.seed = seed;
      const Image flux = render(scene, settings).light_field.channels[0].flux;
      for (std::size_t i = 0; i < flux.pixels.size(); ++i) {
        if (exact.pixels[i] < 0.01f * brightest) continue;
        const double d = static_cast<double>(flux.pixels[i]) - static_cast<double>(exact.pixels[i]);
        squares += d * d;
        ++lit;
      }
    }
    x.push_back(std::log(samples));
    y.push_back(0.5 * std::log(squares / lit));
  }
  double mx = 0, my = 0, xy = 0, xx = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mx += x[i] / static_cast<double>(x.size());
    my += y[i] / static_cast<double>(x.size());
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - mx) * (y[i] - my);
    xx += (x[i] - mx) * (x[i] - mx);
  }
  ::testing::Test::RecordProperty("slope", std::to_string(xy / xx));
  return xy / xx;
}

/// A converged image and what its own error adds to mean square differences from it.
struct Truth {
  LightFieldChannel image;
  Truth(const CompiledScene& scene, RenderSettings settings, int samples) {
    settings.estimator = Estimator::backward;
    settings.target_error = 0;
    settings.samples = samples;
    settings.replicates = 4;
    settings.seed = 0x5eed;
    image = render(scene, settings).light_field.channels[0];
  }
  double own_error() const { return estimated_relative_rmse(image.flux, image.standard_error); }
  /// Relative RMSE over the pixels that are truly lit.
  double rmse_of(const Image& flux) const {
    const PixelValues& exact = image.flux.pixels;
    const float limit =
        static_cast<float>(kLitShare) * *std::max_element(exact.begin(), exact.end());
    double squares = 0, own = 0, total = 0, lit = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      if (!(exact[i] > limit)) continue;
      const double d = static_cast<double>(flux.pixels[i]) - static_cast<double>(exact[i]);
      squares += d * d;
      own += std::pow(static_cast<double>(image.standard_error.pixels[i]), 2);
      total += static_cast<double>(exact[i]);
      lit += 1;
    }
    return std::sqrt(std::max(0.0, squares - own) * lit) / total;
  }
};

struct Coverage {
  double below_bound = 0, below_target = 0;  ///< shares of the runs
  double median_of_bound = 0;                ///< bound over true error
  double median_of_estimate = 0;             ///< estimate over true error
  /// The median of bound over true error when pixels are independent and normal, from the
  /// true errors alone, and the standard error of the measured one.
  double expected_median_of_bound = 0, its_error = 0;
};

/// The measure of how far a bound that holds with kErrorConfidence lies above the error: both are
/// sums of squares over pixels whose variances are v_i, so of (sum v)^2 / sum v^2 equal ones, and
/// the bound's is known from R - 1 times as many. Ratios of such sums are drawn.
/// @param squares mean true squared errors of the lit pixels, over kSeeds runs
/// @param margin by which the bound is wider for pixels that may be lit
/// @param caution divisor of the number of pixels that the bound counts on, for long tails
inline void expect_medians(const std::vector<double>& squares, int replicates, double margin,
                           double caution, Coverage& result) {
  double sum = 0, fourth = 0;
  for (const double v : squares) sum += v, fourth += v * v;
  // Means of kSeeds squares of normal numbers scatter by 2 / kSeeds.
  const double freedom = std::max(1.0, sum * sum / (fourth / (1 + 2.0 / kSeeds)));
  const auto quantiles_of = [&](double pixels) {
    std::mt19937_64 random{1};
    std::gamma_distribution<double> error(0.5 * pixels), estimate(0.5 * pixels * (replicates - 1));
    std::vector<double> ratios(40001);
    for (double& ratio : ratios) ratio = error(random) * (replicates - 1) / estimate(random);
    std::sort(ratios.begin(), ratios.end());
    return [ratios](double share) {
      return ratios[static_cast<std::size_t>(share * static_cast<double>(ratios.size() - 1))];
    };
  };
  const auto true_at = quantiles_of(freedom),
             stated_at = quantiles_of(std::max(1.0, freedom / caution));
  result.expected_median_of_bound = margin * std::sqrt(stated_at(kErrorConfidence) / true_at(0.5));
  // The median of kSeeds: half of them lie between the quartiles, 1.35 standard deviations apart.
  const double spread = 0.5 * std::log(true_at(0.75) / true_at(0.25)) / 1.349;
  result.its_error = result.expected_median_of_bound * 1.2533 * spread / std::sqrt(kSeeds);
}

/// The divisor of docs/theory/errors.md, "Upper limit of the error", where few of the standard
/// errors make most of their sum.
inline double caution_of(const std::vector<double>& errors, int replicates) {
  double fourth = 0, eighth = 0;
  for (const double e : errors) fourth += std::pow(e, 4), eighth += std::pow(e, 8);
  const double r = replicates;
  const double alike = (r + 3) * (r + 5) / ((r - 1) * (r + 1)) / static_cast<double>(errors.size());
  return 1 + (1 + 3 / (r - 1)) * std::sqrt(std::max(0.0, eighth / (fourth * fourth) - alike));
}

inline double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// @param truth of the same window
inline Coverage coverage(const CompiledScene& scene, RenderSettings settings, const Truth& truth) {
  Coverage result;
  std::vector<double> bounds, estimates, squares, margins, cautions;
  double mean_error = 0;
  const Image& exact = truth.image.flux;
  const double limit =
      kLitShare * static_cast<double>(*std::max_element(exact.pixels.begin(), exact.pixels.end()));
  squares.assign(exact.pixels.size(), 0);
  for (int seed = 1; seed <= kSeeds; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    const RenderResult run = render(scene, settings);
    EXPECT_TRUE(run.statistics.target_reached);
    const double error = truth.rmse_of(run.light_field.channels[0].flux);
    result.below_bound += (error <= run.statistics.relative_error_bound ? 1.0 : 0.0) / kSeeds;
    result.below_target += (error <= settings.target_error ? 1.0 : 0.0) / kSeeds;
    mean_error += error / kSeeds;
    const LightFieldChannel& image = run.light_field.channels[0];
    double lit = 0, lit_at_most = 0;
    std::vector<double> lit_errors;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const double f = static_cast<double>(image.flux.pixels[i]);
      const double e = static_cast<double>(image.standard_error.pixels[i]);
      lit += f > limit ? 1 : 0;
      if (f > limit) lit_errors.push_back(e / limit);
      lit_at_most += f + 2 * e > limit ? 1 : 0;
      if (static_cast<double>(exact.pixels[i]) > limit)
        squares[i] += std::pow(f - static_cast<double>(exact.pixels[i]), 2) / kSeeds;
    }
    margins.push_back(std::sqrt(lit_at_most / lit));
    cautions.push_back(caution_of(lit_errors, settings.replicates));
    bounds.push_back(run.statistics.relative_error_bound / error);
    estimates.push_back(run.statistics.relative_error / error);
  }
  EXPECT_LT(truth.own_error(), 0.25 * mean_error) << "the reference is not good enough";
  result.median_of_bound = median(bounds);
  expect_medians(squares, settings.replicates, median(margins), median(cautions), result);
  ::testing::Test::RecordProperty("expected_median_of_bound",
                                  std::to_string(result.expected_median_of_bound));
  result.median_of_estimate = median(estimates);
  ::testing::Test::RecordProperty("below_bound", std::to_string(result.below_bound));
  ::testing::Test::RecordProperty("median_of_bound", std::to_string(result.median_of_bound));
  ::testing::Test::RecordProperty("median_of_estimate", std::to_string(result.median_of_estimate));
  return result;
}

/// A share of 95 % seen in kSeeds runs, less three of its standard errors.
inline const double kLeastShare =
    kErrorConfidence - 3 * std::sqrt(kErrorConfidence * (1 - kErrorConfidence) / kSeeds);

}  // namespace plenoflame::test
