#include "plenoflame/radiometry/two_colour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/pyrometry.h"
#include "support/approx.h"

namespace plenoflame::two_colour_test {
namespace {

using test::relative;

const SpectralResponse kRed = SpectralResponse::band(650e-9, 10e-9);
const SpectralResponse kInfrared = SpectralResponse::band(850e-9, 40e-9);

// Ratios by mpmath, 30 digits: grey, and absorption in proportion to 1/wavelength.
TEST(TwoColour, RatiosAndTheirTemperatures) {
  const TwoColour grey(kRed, kInfrared, {});
  const TwoColour soot(kRed, kInfrared, AbsorptionSpectrum::power(650e-9, 1));
  const double rows[][3] = {{1200, 0.0124106358400224659, 0.0162494977457673028},
                            {1800, 0.0529342554712539326, 0.069256581677681297}};
  for (const auto& row : rows) {
    EXPECT_TRUE(relative(std::exp(grey.log_ratio(row[0])), row[1], 1e-11));
    EXPECT_TRUE(relative(grey.temperature(row[1]), row[0], 1e-11));
    EXPECT_TRUE(relative(soot.temperature(row[2]), row[0], 1e-11)) << row[0];
  }
  const TwoColour back(kInfrared, kRed, {});
  EXPECT_TRUE(relative(back.temperature(1 / rows[0][1]), 1200, 1e-11));
}

// Wien's law: d ln(ratio) / dT = c2 (1/l1 - 1/l2) / T^2.
TEST(TwoColour, SlopeIsThatOfWien) {
  const TwoColour narrow(SpectralResponse::band(650e-9, 1e-12),
                         SpectralResponse::band(850e-9, 1e-12), {});
  const double wien = constants::second_radiation * (1 / 650e-9 - 1 / 850e-9) / (1500.0 * 1500);
  EXPECT_TRUE(relative(narrow.slope(1500), wien, 1e-3));
}

TEST(TwoColour, HasNoTemperatureForEveryRatio) {
  const TwoColour grey(kRed, kInfrared, {});
  for (const double ratio : {0.0, -1.0, 1e-30, 1e9, std::nan(""), HUGE_VAL})
    EXPECT_TRUE(std::isnan(grey.temperature(ratio))) << ratio;
  EXPECT_THROW(TwoColour(kRed, kRed, {}), InputError);
}

LightFieldChannel channel_of(const std::vector<float>& flux, const std::vector<float>& error) {
  LightFieldChannel channel;
  channel.flux = Image(static_cast<int>(flux.size()), 1);
  channel.flux.pixels.assign(flux.begin(), flux.end());
  if (error.empty()) return channel;
  channel.standard_error = Image(static_cast<int>(error.size()), 1);
  channel.standard_error.pixels.assign(error.begin(), error.end());
  return channel;
}

// Pixels of 1200 and 1800 K by the ratios above, one too dim in either channel, one whose ratio is
// nobody's, one that is not a number. Errors by Wien's law: T^2 / (c2 (1/l1 - 1/l2)) times the
// relative ones of both channels, as the sides of a right angle.
TEST(TwoColour, MapOfPixels) {
  const float nan = std::nanf("");
  const float cold = 0.0124106358400224659F, hot = 0.0529342554712539326F;
  const LightFieldChannel red = channel_of({cold, 2 * hot, 1e-4F, 0.00108F, 0.1F, nan},
                                           {0.03F * cold, 0.02F * hot, 1, 1, 1, 1});
  const LightFieldChannel infrared =
      channel_of({1, 2, 1, 0.0199F, 0.021F, 1}, {0.04F, 0, 1, 1, 1, 1});
  const TwoColour law(kRed, kInfrared, {});
  const TemperatureMap map = two_colour_map(red, infrared, law);
  EXPECT_EQ(map.pixels, 2u);
  EXPECT_TRUE(relative(map.temperature.at(0, 0), 1200, 1e-6));
  EXPECT_TRUE(relative(map.temperature.at(1, 0), 1800, 1e-6));
  EXPECT_TRUE(std::isfinite(law.temperature(0.00108 / 0.0199)));  // but for the dimness
  for (int x = 2; x < 6; ++x) EXPECT_EQ(map.temperature.at(x, 0), 0) << x;
  EXPECT_TRUE(relative(map.mean, 1500, 1e-6));
  EXPECT_TRUE(relative(map.deviation, 300 * std::sqrt(2.0), 1e-5));
  EXPECT_TRUE(relative(map.lowest, 1200, 1e-6) && relative(map.highest, 1800, 1e-6));
  const double wien = 1 / (constants::second_radiation * (1 / 650e-9 - 1 / 850e-9));
  const double errors[] = {0.05 * 1200.0 * 1200 * wien, 0.01 * 1800.0 * 1800 * wien};
  for (int x = 0; x < 2; ++x)
    EXPECT_TRUE(relative(map.standard_error.at(x, 0), errors[x], 5e-3)) << x;
  EXPECT_TRUE(relative(map.expected_deviation,
                       std::sqrt(0.5 * (errors[0] * errors[0] + errors[1] * errors[1])), 5e-3));
  // A pixel alone does not deviate; without errors there are none; what is dark has no map.
  const LightFieldChannel one = channel_of({hot, 0}, {}), other = channel_of({1, 0}, {});
  const TemperatureMap alone = two_colour_map(one, other, law);
  EXPECT_EQ(alone.deviation, 0);
  EXPECT_EQ(alone.expected_deviation, 0);
  EXPECT_TRUE(alone.standard_error.empty());
  EXPECT_THROW(two_colour_map(one, channel_of({0, 0}, {}), law), InputError);
  EXPECT_THROW(two_colour_map(one, channel_of({1}, {}), law), InputError);
  EXPECT_THROW(two_colour_map(channel_of({1, 0}, {}), channel_of({1e-9F, 0}, {}), law), InputError);
}

// Two bins of 1200 and 1800 K, whose pixels have light in proportion to 1, 2, 3 and noise that only
// the sums are free of; a pixel in none; errors add up as squares.
TEST(TwoColour, BinsAddUpLightAndErrors) {
  const float cold = 0.0124106358400224659F, hot = 0.0529342554712539326F;
  const LightFieldChannel red =
      channel_of({cold * 1.5F, hot * 6, 7, cold * 1.5F, hot * 3, cold * -1},
                 {0.1F * cold, 0, 9, 0.1F * cold, 0, 0.1F * cold});
  const LightFieldChannel infrared =
      channel_of({1, 6, 1, 1.5F, 3, -0.5F}, {0, 0.3F, 1, 0, 0.4F, 0});
  const TwoColour law(kRed, kInfrared, {});
  PixelBins bins;
  bins.count = 2;
  bins.of_pixel = {0, 1, -1, 0, 1, 0};
  const TemperatureMap map = two_colour_map(red, infrared, law, {}, &bins);
  EXPECT_EQ(map.bins, 2u);
  EXPECT_EQ(map.pixels, 5u);
  for (const int x : {0, 3, 5}) EXPECT_TRUE(relative(map.temperature.at(x, 0), 1200, 1e-6)) << x;
  for (const int x : {1, 4}) EXPECT_TRUE(relative(map.temperature.at(x, 0), 1800, 1e-6)) << x;
  EXPECT_EQ(map.temperature.at(2, 0), 0);
  EXPECT_TRUE(relative(map.mean, 1500, 1e-6));
  const double wien = 1 / (constants::second_radiation * (1 / 650e-9 - 1 / 850e-9));
  const double errors[] = {0.1 * std::sqrt(3.0) / 2 * 1200.0 * 1200 * wien,
                           0.5 / 9 * 1800.0 * 1800 * wien};
  EXPECT_TRUE(relative(map.standard_error.at(0, 0), errors[0], 5e-3));
  EXPECT_TRUE(relative(map.standard_error.at(4, 0), errors[1], 5e-3));
  EXPECT_TRUE(
      relative(map.expected_deviation, std::hypot(errors[0], errors[1]) / std::sqrt(2.0), 5e-3));
  // Pixels not above so many standard errors would be chosen by their noise.
  PyrometrySettings strict;
  strict.least_signal_to_noise = 15;
  EXPECT_EQ(two_colour_map(red, infrared, law, strict, &bins).bins, 1u);
  bins.of_pixel.pop_back();
  EXPECT_THROW(two_colour_map(red, infrared, law, {}, &bins), InputError);
}

TEST(PixelBins, BlocksBeginInTheCorner) {
  const PixelBins bins = block_bins({7, 9, 5, 3}, 2);
  EXPECT_EQ(bins.count, 6u);
  EXPECT_EQ(bins.of_pixel,
            (std::vector<std::int32_t>{0, 0, 1, 1, 2, 0, 0, 1, 1, 2, 3, 3, 4, 4, 5}));
  EXPECT_THROW(block_bins({0, 0, 5, 3}, 0), InputError);
}

}  // namespace
}  // namespace plenoflame::two_colour_test
