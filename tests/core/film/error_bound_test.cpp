#include "film/error_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "plenoflame/film/film.h"
#include "support/approx.h"

namespace plenoflame::test::error_bound_test {
namespace {

TEST(ErrorBound, QuantilesOfFisher) {
  // P(F < f) = p by 40-digit arithmetic (mpmath).
  const struct {
    double p, numerator, denominator, f;
  } cases[] = {
      {0.95, 1, 1, 161.447638797588},       {0.95, 1, 3, 10.1279644860139},
      {0.5, 2.5, 7.25, 0.825291477420655},  {0.05, 4, 9, 0.166700589369475},
      {0.95, 30, 30, 1.84087168911176},     {0.95, 1000.5, 3001.5, 1.08752580301254},
      {0.95, 5000, 5000, 1.04762731843436}, {0.95, 20000, 60000, 1.01912173237253},
      {0.95, 1e6, 1e6, 1.00329512584861},
  };
  for (const auto& c : cases)
    EXPECT_TRUE(relative(f_quantile(c.p, c.numerator, c.denominator), c.f, 1e-10))
        << c.p << " " << c.numerator << " " << c.denominator;
}

TEST(ErrorBound, TailsOfStudent) {
  // P(|T| >= t) by 40-digit arithmetic (mpmath).
  const struct {
    double t, freedom, p;
  } cases[] = {
      {0, 1, 1},
      {1e-9, 3, 0.999999999264894806},
      {0.5, 1, 0.704832764699133452},
      {3, 2.5, 0.0725760955490318439},
      {12, 7, 6.35831037818510027e-6},
      {1e6, 1, 6.36619772367369136e-7},
      {40, 1000, 1.04788521551733609e-209},
  };
  for (const auto& c : cases) {
    EXPECT_TRUE(relative(student_tail(c.t, c.freedom), c.p, 1e-10)) << c.t << " " << c.freedom;
    EXPECT_EQ(student_tail(-c.t, c.freedom), student_tail(c.t, c.freedom));
  }
}

TEST(ErrorBound, OfEqualPixels) {
  // n pixels with the same standard error from R replicates: sum e^4 = n e^4, hence n (R + 1)/(R -
  // 1) degrees of freedom if they were not more than there are pixels.
  Image flux(10, 5), error(10, 5);
  for (float& f : flux.pixels) f = 100;
  for (float& e : error.pixels) e = 3;
  const StatedError stated = stated_error(flux, error, 3);
  EXPECT_TRUE(relative(stated.relative_rmse, 0.03, 1e-7));
  EXPECT_TRUE(relative(stated.bound, 0.03 * std::sqrt(f_quantile(0.95, 50, 100)), 1e-7));
  Image many(1000, 1000, 100), its_error(1000, 1000, 3);
  EXPECT_TRUE(relative(stated_error(many, its_error, 3).bound,
                       0.03 * std::sqrt(f_quantile(0.95, 1e6, 2e6)), 3e-5));
}

TEST(ErrorBound, PixelsThatMayBeLitCount) {
  Image flux(4, 1), error(4, 1);
  const float f[] = {100, 50, 0.5f, 0.5f}, e[] = {3, 4, 0.3f, 0.2f};
  for (int i = 0; i < 4; ++i) {
    flux.at(i, 0) = f[i];
    error.at(i, 0) = e[i];
  }
  const StatedError stated = stated_error(flux, error, 2);
  EXPECT_TRUE(relative(stated.relative_rmse, std::sqrt(12.5) / 75, 1e-7));
  EXPECT_TRUE(relative(stated.bound, std::sqrt(25 * 3 * f_quantile(0.95, 2, 2)) / 150, 1e-7));
}

struct Bounds {
  double share_below = 0;  ///< how often the true error is below the bound
  double width = 0;        ///< median of bound / estimate
};

/// The bounds of pictures of one pixel for each of `sigmas`, with normal errors of this size around
/// a flux of 1000.
Bounds bounds_of(const std::vector<double>& sigmas, int replicates, int runs) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const int pixels = static_cast<int>(sigmas.size());
  int below = 0;
  std::vector<double> widths;
  for (int run = 0; run < runs; ++run) {
    Image flux(pixels, 1), error(pixels, 1);
    double squares = 0, total = 0;
    for (int i = 0; i < pixels; ++i) {
      double mean = 0, scatter = 0;
      std::vector<double> values(static_cast<std::size_t>(replicates));
      for (double& v : values)
        mean += (v = 1000 + sigmas[static_cast<std::size_t>(i)] * normal(random)) / replicates;
      for (const double v : values) scatter += (v - mean) * (v - mean);
      flux.at(i, 0) = static_cast<float>(mean);
      error.at(i, 0) = static_cast<float>(std::sqrt(scatter / (replicates * (replicates - 1.0))));
      squares += (mean - 1000) * (mean - 1000);
      total += mean;
    }
    const double truth = std::sqrt(squares * pixels) / total;
    const StatedError stated = stated_error(flux, error, replicates);
    below += truth <= stated.bound;
    widths.push_back(stated.bound / stated.relative_rmse);
  }
  std::nth_element(widths.begin(), widths.begin() + runs / 2, widths.end());
  return {below / static_cast<double>(runs), widths[static_cast<std::size_t>(runs / 2)]};
}

constexpr int kRuns = 20000;
const double kLeastShare = 0.95 - 4 * std::sqrt(0.95 * 0.05 / kRuns);

TEST(ErrorBound, OfFewNormalPixels) {
  // Normal errors of known size: the true error is below the bound in 95 % of all cases.
  for (const int pixels : {1, 2, 4, 16})
    for (const int replicates : {2, 4}) {
      const std::vector<double> sigmas(static_cast<std::size_t>(pixels), 1.0);
      const double share = bounds_of(sigmas, replicates, kRuns).share_below;
      EXPECT_GT(share, kLeastShare) << pixels << " pixels, " << replicates << " replicates";
      EXPECT_LT(share, 0.975) << pixels << " pixels, " << replicates << " replicates";
    }
}

TEST(ErrorBound, OfPixelsWhoseErrorsAreUnequal) {
  // A few pixels make most of the error, as those at the edges of micro-images do.
  // (How few they are is hidden by the others where it is only one, or two that two randomisations
  // tell of.)
  const struct {
    int dominant, replicates;
    double wider;  ///< than if it were known how few they are, at most
  } cases[] = {{3, 2, 4.5}, {8, 2, 2.7}, {2, 4, 1.6}, {3, 4, 1.8}, {8, 4, 1.3}};
  for (const auto& c : cases) {
    std::vector<double> sigmas(64, 1.0);
    std::fill_n(sigmas.begin(), c.dominant, 20.0);
    const Bounds bounds = bounds_of(sigmas, c.replicates, kRuns);
    EXPECT_GT(bounds.share_below, kLeastShare)
        << c.dominant << " pixels, " << c.replicates << " replicates";
    const double known = std::sqrt(f_quantile(0.95, c.dominant, c.dominant * (c.replicates - 1.0)));
    EXPECT_LT(bounds.width, c.wider * known)
        << c.dominant << " pixels, " << c.replicates << " replicates";
  }
}

// Errors of pictures differ from pixel to pixel by factors, with a long tail: logarithms that are
// normal.
TEST(ErrorBound, OfPixelsWithALongTailOfErrors) {
  constexpr int kPixels = 600, kFewerRuns = 3000;
  std::vector<double> logs(kPixels);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  for (double& log : logs) log = normal(random);
  for (const double spread : {0.5, 1.0})
    for (const int replicates : {2, 4, 8}) {
      std::vector<double> sigmas;
      for (const double log : logs) sigmas.push_back(std::exp(spread * log));
      const Bounds bounds = bounds_of(sigmas, replicates, kFewerRuns);
      EXPECT_GT(bounds.share_below, 0.93) << spread << ", " << replicates << " replicates";
      EXPECT_LT(bounds.width, 1.6) << spread << ", " << replicates << " replicates";
    }
}

TEST(ErrorBound, DoesNotDependOnTheUnit) {
  const auto stated = [](float unit) {
    Image flux(8, 8, 50 * unit), error(8, 8, 0.5f * unit);
    flux.at(3, 4) = 100 * unit;
    error.at(3, 4) = 3 * unit;
    error.at(5, 1) = 4 * unit;
    return stated_error(flux, error, 2);
  };
  const StatedError expected = stated(1);
  for (const float unit : {0x1p-140f, 0x1p-60f, 0x1p120f}) {
    EXPECT_EQ(stated(unit).relative_rmse, expected.relative_rmse) << unit;
    EXPECT_EQ(stated(unit).bound, expected.bound) << unit;
  }
}

TEST(ErrorBound, WhatIsNotKnown) {
  Image flux(2, 1);
  EXPECT_EQ(stated_error(flux, Image(2, 1), 2).bound, 0);  // nothing lit
  flux.at(0, 0) = 1;
  EXPECT_EQ(stated_error(flux, Image(2, 1), 2).bound, 0);  // no scatter
  EXPECT_EQ(stated_error(flux, {}, 1).bound, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace plenoflame::test::error_bound_test
