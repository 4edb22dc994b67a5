#include "plenoflame/film/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::compare_test {
namespace {

using test::relative;

LightField make_field(int width, int height, bool errors) {
  LightField field;
  field.sensor_width = width;
  field.sensor_height = height;
  field.window = {0, 0, width, height};
  field.channels.push_back({"total", Image(width, height), {}});
  if (errors) field.channels[0].standard_error = Image(width, height);
  return field;
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

// Expected values: rational arithmetic and square roots with 30 digits in mpmath. The tolerance is
// that of the inputs, which are rounded to single precision.
TEST(Compare, FollowsItsDefinitions) {
  LightField a = make_field(5, 1, true), b = make_field(5, 1, true);
  // Fluxes of a real image's size: an absolute tolerance anywhere would show.
  const float unit = 0x1p-30F;
  const float va[] = {1.5F, 2.25F, 2.75F, 0.25F, 0.0625F}, vb[] = {1, 2, 3, 1, 0};
  const float ea[] = {.1F, .2F, .05F, .1F, .05F}, eb[] = {0, .1F, .12F, .02F, 0};
  for (int i = 0; i < 5; ++i) {
    a.channels[0].flux.at(i, 0) = unit * va[i];
    b.channels[0].flux.at(i, 0) = unit * vb[i];
    a.channels[0].standard_error.at(i, 0) = unit * ea[i];
    b.channels[0].standard_error.at(i, 0) = unit * eb[i];
  }
  const Comparison c = compare(a, b);
  EXPECT_EQ(c.lit_pixels, 4U);
  EXPECT_EQ(c.mean, 1.6875 * unit);
  EXPECT_EQ(c.reference_mean, 1.75 * unit);
  EXPECT_TRUE(relative(c.relative_rmse, 0.27664166758624409, 1e-12));
  EXPECT_TRUE(relative(c.relative_bias, -0.035714285714285712, 1e-12));
  EXPECT_TRUE(relative(c.stray_share, 0.0091743119266055051, 1e-12));
  EXPECT_EQ(c.dark_in_one_share, 0.2);  // the last one
  EXPECT_EQ(c.largest_difference, -0.75 * unit);
  EXPECT_EQ(c.largest_column, 3);
  EXPECT_TRUE(c.has_standard_errors);
  EXPECT_TRUE(relative(c.relative_bias_error, 0.042209390579126163, 1e-7));
  EXPECT_TRUE(relative(c.expected_rmse, 0.084418781158252326, 1e-7));
  EXPECT_TRUE(relative(c.largest_z, -7.354355067681901, 1e-6));
  EXPECT_EQ(c.largest_z_column, 3);
  EXPECT_TRUE(relative(c.chi_square, 17.119452662721894, 1e-6));
  EXPECT_EQ(c.chi_square_pixels, 5U);
  EXPECT_EQ(c.blocks, 1U);
  EXPECT_TRUE(relative(c.block_chi_square, 0.03515625 / 0.94140625, 1e-12));
}

TEST(Compare, WithoutStandardErrorsSaysSo) {
  LightField a = make_field(3, 1, false), b = a;
  b.channels[0].flux = Image(3, 1, 2e-9F);
  a.channels[0].flux = Image(3, 1, 3e-9F);
  const Comparison c = compare(a, b);
  EXPECT_FALSE(c.has_standard_errors);
  EXPECT_EQ(c.chi_square_pixels, 0U);
  EXPECT_TRUE(relative(c.relative_rmse, 0.5, 1e-6));
  EXPECT_TRUE(relative(c.relative_bias, 0.5, 1e-6));
}

// Equal up to the rounding of single precision, with no noise at all: not 1e7 standard errors
// apart.
TEST(Compare, KnowsThatValuesWereRounded) {
  LightField a = make_field(16, 16, true), b = a;
  b.channels[0].flux = Image(16, 16, 1e-9F);
  a.channels[0].flux = Image(16, 16, std::nextafter(1e-9F, 1.0F));
  const Comparison c = compare(a, b);
  EXPECT_LT(std::fabs(c.largest_z), 2.0);
  EXPECT_GT(std::fabs(c.largest_z), 0.5);
}

/// a = 1 + bias + noise of standard deviation `noise`, reference 1: fixed seed per call.
Comparison noisy(double bias, double noise, std::uint64_t seed) {
  LightField a = make_field(100, 75, true), b = make_field(100, 75, false);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < 7500; ++i) {
    a.channels[0].flux.pixels[i] = static_cast<float>(1e-9 * (1 + bias + noise * normal(random)));
    a.channels[0].standard_error.pixels[i] = static_cast<float>(1e-9 * noise);
    b.channels[0].flux.pixels[i] = 1e-9F;
  }
  return compare(a, b);
}

// Limits of 5 standard deviations: false alarm below 1e-6 per comparison.
TEST(Compare, PureNoiseIsExplained) {
  for (const std::uint64_t seed : {11ULL, 12ULL, 13ULL}) {
    const Comparison c = noisy(0, 0.05, seed);
    EXPECT_TRUE(test::within_standard_errors(c.relative_bias, 0, c.relative_bias_error, 5));
    EXPECT_TRUE(relative(c.relative_bias_error, 0.05 / std::sqrt(7500.0), 1e-5));
    EXPECT_TRUE(relative(c.relative_rmse, 0.05, 5 / std::sqrt(2 * 7500.0)));
    EXPECT_TRUE(relative(c.expected_rmse, 0.05, 1e-5));
    EXPECT_TRUE(relative(c.chi_square, 1, 5 * std::sqrt(2 / 7500.0)));
    EXPECT_LT(std::fabs(c.block_score), 5);
    EXPECT_GT(c.largest_z_probability, 1e-6);
    EXPECT_EQ(c.blocks, 35U);  // 7 x 5, those at the edge are smaller
  }
}

// A bias of a fifth of a pixel's noise is invisible in single pixels and plain in blocks.
TEST(Compare, SmallBiasIsSeenInBlocks) {
  const Comparison c = noisy(0.01, 0.05, 14);
  EXPECT_TRUE(test::within_standard_errors(c.relative_bias, 0.01, c.relative_bias_error, 5));
  EXPECT_GT(c.relative_bias, 10 * c.relative_bias_error);
  EXPECT_GT(c.block_score, 8);
  EXPECT_GT(c.largest_z_probability, 1e-6);
}

// Ten blocks of differences alike in magnitude, in which one sign prevails by 28 or 26: the
// probability of so much and the normal score with this probability by mpmath, from chi-square with
// 10 / (1 - 1/256) degrees of freedom; Wilson and Hilferty's approximation is good to 1 % here.
TEST(Compare, BlockScoreIsANormalScore) {
  LightField a = make_field(160, 16, true), b = make_field(160, 16, false);
  b.channels[0].flux = Image(160, 16, 1);
  double sum = 0;
  for (int block = 0; block < 10; ++block) {
    const int more = block < 7 ? 28 : 26, positive = (256 + more) / 2;
    for (int i = 0; i < 256; ++i)
      a.channels[0].flux.at(16 * block + i % 16, i / 16) = i < positive ? 1 + 0x1p-7F : 1 - 0x1p-7F;
    sum += more * more / 256.0;
  }
  const Comparison c = compare(a, b);
  EXPECT_EQ(c.blocks, 10U);
  EXPECT_TRUE(relative(c.block_chi_square, sum / 10, 1e-5));  // blocks have nearly equal weights
  EXPECT_TRUE(relative(c.block_score, 3.0701479576679301, 0.01));
}

// mpmath: 1 - erf(k / sqrt 2)^100.
TEST(Compare, LargestZCountsThePixels) {
  const auto probability = [](double z) {
    LightField a = make_field(10, 10, true), b = make_field(10, 10, false);
    b.channels[0].flux = Image(10, 10, 1);
    a.channels[0].flux = Image(10, 10, 1);
    a.channels[0].standard_error = Image(10, 10, 0x1p-7F);
    a.channels[0].flux.at(3, 4) = static_cast<float>(1 - z * 0x1p-7);
    const Comparison c = compare(a, b);
    EXPECT_EQ(c.largest_z_column, 3);
    EXPECT_EQ(c.largest_z_row, 4);
    EXPECT_LT(c.largest_z, 0);
    return c.largest_z_probability;
  };
  EXPECT_TRUE(relative(probability(2), 0.99050311310401604, 1e-6));
  EXPECT_TRUE(relative(probability(6), 1.9731750973510828e-7, 1e-6));
}

// Dark pixels count as well, if their errors are known; those without any error do not.
TEST(Compare, LargestZCountsDarkPixelsWithErrors) {
  LightField a = make_field(10, 30, true), b = make_field(10, 30, false);
  a.channels[0].flux = b.channels[0].flux = Image(10, 30, 0);
  a.channels[0].standard_error = Image(10, 30, 0);
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column < 10; ++column) {
      a.channels[0].flux.at(column, row) = b.channels[0].flux.at(column, row) = row < 3 ? 1.F : 0.F;
      a.channels[0].standard_error.at(column, row) = 0x1p-7F;
    }
  a.channels[0].flux.at(3, 7) = 6 * 0x1p-7F;
  const Comparison c = compare(a, b);
  EXPECT_EQ(c.chi_square_pixels, 100);
  EXPECT_EQ(c.lit_pixels, 30);
  EXPECT_EQ(c.largest_z_row, 7);
  EXPECT_TRUE(relative(c.largest_z_probability, 1.9731750973510828e-7, 1e-6));
}

// The same with errors from few randomisations. mpmath: 1 - (1 - p)^100 with Student's
// p = 1 - 2/pi atan(z) for 2 of them, I_{7/(7 + z^2)}(7/2, 1/2) for 8.
TEST(Compare, LargestZKnowsHowFewRandomisationsMadeTheErrors) {
  const auto probability = [](double z, double replicates, double of_reference) {
    LightField a = make_field(10, 10, true), b = make_field(10, 10, of_reference > 0);
    b.channels[0].flux = Image(10, 10, 1);
    a.channels[0].flux = Image(10, 10, 1);
    a.channels[0].standard_error = Image(10, 10, 0x1p-7F);
    if (of_reference > 0) b.channels[0].standard_error = Image(10, 10, 0);
    a.channels[0].flux.at(3, 4) = static_cast<float>(1 + z * 0x1p-7);
    a.numbers["render.replicates"] = replicates;
    b.numbers["render.replicates"] = of_reference;
    return compare(a, b).largest_z_probability;
  };
  EXPECT_TRUE(relative(probability(6, 2, 0), 0.999985014909682734, 1e-6));
  EXPECT_TRUE(relative(probability(600, 2, 0), 0.10071882249360856, 1e-6));
  EXPECT_TRUE(relative(probability(12, 8, 0), 0.000635630960229027331, 1e-6));
  EXPECT_EQ(probability(12, 8, 2), probability(12, 2, 0));  // the fewest
  EXPECT_EQ(probability(12, 8, 64), probability(12, 8, 0));
}

/// Errors with long tails to one side, much larger in some pixels than in others, and known from
/// two randomisations only.
Comparison uneven(double bias, std::uint64_t seed) {
  constexpr int kSize = 640;
  LightField a = make_field(kSize, kSize, true), b = make_field(kSize, kSize, false);
  b.channels[0].flux = Image(kSize, kSize, 1);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < b.channels[0].flux.pixels.size(); ++i) {
    const double noise = 0.01 * std::exp(normal(random));
    const auto error = [&] { return noise * (std::exp(normal(random)) - std::exp(0.5)); };
    const double one = error(), other = error();
    a.channels[0].flux.pixels[i] = static_cast<float>(1 + bias + 0.5 * (one + other));
    a.channels[0].standard_error.pixels[i] = static_cast<float>(0.5 * std::fabs(one - other));
  }
  return compare(a, b);
}

TEST(Compare, BlocksNeedNotKnowHowErrorsAreDistributed) {
  for (const std::uint64_t seed : {21ULL, 22ULL, 23ULL}) {
    const Comparison c = uneven(0, seed);
    EXPECT_EQ(c.blocks, 1600U);
    EXPECT_LT(std::fabs(c.block_score), 5) << seed;
    // The mean of 1600 squares of about normal sums.
    EXPECT_TRUE(relative(c.block_chi_square, 1, 5 * std::sqrt(2 / 1600.0))) << seed;
  }
  EXPECT_GT(uneven(0.003, 24).block_score, 8);
}

// As of images with the same seed: what neighbours have in common is far below the noise.
TEST(Compare, DifferencesBelowTheNoiseAreNotMoreThanNoise) {
  LightField a = make_field(64, 64, true), b = a;
  b.channels[0].flux = Image(64, 64, 1);
  a.channels[0].flux = Image(64, 64, 1 + 0x1p-14F);
  a.channels[0].standard_error = Image(64, 64, 0.05F);
  const Comparison c = compare(a, b);
  EXPECT_GT(c.block_chi_square, 1);
  EXPECT_LT(c.block_chi_square, 1.001);
  EXPECT_LT(c.block_score, 5);
}

// Fluxes on both sides of the limit of 1 %, seen twice with noise: whichever of them is the
// reference, and however much noisier it is, its noise must not choose the pixels.
TEST(Compare, NoiseDoesNotChooseTheLitPixels) {
  constexpr int kSize = 300;
  std::mt19937_64 random(31);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 0.02);
  for (const double noise_b : {0.005, 0.02}) {
    LightField a = make_field(kSize, kSize, true), b = make_field(kSize, kSize, true);
    for (std::size_t i = 0; i < a.channels[0].flux.pixels.size(); ++i) {
      const double flux = i == 0 ? 1 : uniform(random);
      a.channels[0].flux.pixels[i] = static_cast<float>(flux + 0.005 * normal(random));
      b.channels[0].flux.pixels[i] = static_cast<float>(flux + noise_b * normal(random));
      a.channels[0].standard_error.pixels[i] = 0.005F;
      b.channels[0].standard_error.pixels[i] = static_cast<float>(noise_b);
    }
    const Comparison one = compare(a, b), other = compare(b, a);
    EXPECT_EQ(one.lit_pixels, other.lit_pixels);
    EXPECT_GT(one.lit_pixels, 30000U);
    for (const Comparison& c : {one, other}) {
      EXPECT_TRUE(test::within_standard_errors(c.relative_bias, 0, c.relative_bias_error, 4.5));
      EXPECT_EQ(verdict(c), Verdict::noise);
    }
  }
}

TEST(Compare, SaysWhatTheDifferencesMean) {
  EXPECT_EQ(verdict(noisy(0, 0.05, 11)), Verdict::noise);
  EXPECT_EQ(verdict(noisy(0.01, 0.05, 14)), Verdict::more_than_noise);
  Comparison c = noisy(0, 0.05, 11);
  c.largest_z_probability = 1e-9;
  EXPECT_EQ(verdict(c), Verdict::more_than_noise);
  // Two randomisations hardly tell the error of a single pixel.
  c.freedom = 1;
  EXPECT_EQ(verdict(c), Verdict::noise);
  c.dark_in_one_share = 0.02;
  EXPECT_EQ(verdict(c), Verdict::unknown);
  EXPECT_EQ(verdict(Comparison{}), Verdict::unknown);
}

/// Pictures of 64 x 64 pixels in which rays bring one unit of light each: `mean_a` and `mean_b` of
/// them to a pixel in the mean (Poisson), the variance of whose number is its estimate.
Comparison of_few_rays(double mean_a, double mean_b, std::uint64_t seed) {
  LightField a = make_field(64, 64, true), b = a;
  std::mt19937_64 random(seed);
  const auto fill = [&](LightFieldChannel& channel, double mean, double unit) {
    std::poisson_distribution<int> rays(std::max(mean, 1e-9));
    for (std::size_t i = 0; mean > 0 && i < channel.flux.pixels.size(); ++i) {
      const int n = rays(random);
      channel.flux.pixels[i] = static_cast<float>(unit * n);
      channel.standard_error.pixels[i] = static_cast<float>(unit * std::sqrt(n));
    }
  };
  fill(a.channels[0], mean_a, 1e-9);
  fill(b.channels[0], mean_b, 1e-9);
  return compare(a, b);
}

TEST(Compare, FewRaysHideNoLargeDifference) {
  for (std::uint64_t seed = 41; seed < 61; ++seed) {
    const Comparison same = of_few_rays(0.5, 0.5, seed);
    EXPECT_GT(same.dark_in_one_share, kTooManyDark);
    EXPECT_EQ(verdict(same), Verdict::unknown) << seed;
    const Comparison other = of_few_rays(0.05, 0.5, seed);
    EXPECT_GT(other.dark_in_one_share, kTooManyDark);
    EXPECT_EQ(verdict(other), Verdict::more_than_noise) << seed;
    // A handful of rays in all: their errors say nothing of the rays that found nothing.
    EXPECT_EQ(verdict(of_few_rays(0.002, 0.01, seed)), Verdict::unknown) << seed;
  }
  EXPECT_EQ(verdict(of_few_rays(0, 0.5, 61)), Verdict::more_than_noise);  // one without light
}

// The variance of the number of rays in a Poisson process is its mean.
TEST(Compare, KnowsHowWellTheMeansAreKnown) {
  const double rays = 0.05 * 64 * 64;  // all pixels with light are lit
  EXPECT_TRUE(
      relative(of_few_rays(0.05, 4, 62).mean_error, 1 / std::sqrt(rays), 5 / std::sqrt(rays)));
}

TEST(Compare, UsesWhatBothWindowsHold) {
  LightField a = make_field(20, 10, false), b = make_field(20, 10, false);
  a.window = {2, 1, 6, 5};
  b.window = {5, 3, 8, 7};
  a.channels[0].flux = Image(6, 5, 1);
  b.channels[0].flux = Image(8, 7, 1);
  a.channels[0].flux.at(7 - 2, 4 - 1) = 3;  // column 7, row 4 of the sensor
  b.channels[0].flux.at(5, 5) = 100;        // outside of a
  const Comparison c = compare(a, b);
  EXPECT_EQ(c.window, (PixelWindow{5, 3, 3, 3}));
  EXPECT_EQ(c.lit_pixels, 9U);
  EXPECT_EQ(c.largest_difference, 2);
  EXPECT_EQ(c.largest_column, 7);
  EXPECT_EQ(c.largest_row, 4);
}

TEST(Compare, RefusesWhatCannotBeCompared) {
  LightField a = make_field(4, 3, true), b = make_field(4, 3, true);
  b.channels[0].flux = a.channels[0].flux = Image(4, 3, 1);
  const auto mentions = [&](const std::string& part) {
    const std::string message = message_of([&] { compare(a, b); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  EXPECT_EQ(compare(a, b).relative_rmse, 0);
  a.sensor_width = 5;
  mentions("5 x 3 and 4 x 3");
  a = b;
  a.sensor_width = b.sensor_width = 20;
  a.window.x = 4;
  mentions("don't overlap");
  b.window = a.window;
  a.channels[0].name = "650nm";
  mentions("no channel 'total'; it has: 650nm");
  a = b;
  a.channels[0].flux.at(1, 2) = std::numeric_limits<float>::infinity();
  mentions("first image holds a value that is not finite, in column 5, row 2");
  a = b;
  b.channels[0].standard_error.at(3, 0) = std::numeric_limits<float>::quiet_NaN();
  mentions("reference holds a value that is not finite, in column 7, row 0");
  b = a;
  b.channels[0].flux = Image(4, 3, 0);
  mentions("dark");
}

}  // namespace
}  // namespace plenoflame::compare_test
