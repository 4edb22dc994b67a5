#include "plenoflame/lightfield/develop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::develop_test {
namespace {

using test::relative;

LightField make_field(const std::vector<double>& fluxes) {
  LightField field;
  const int width = static_cast<int>(fluxes.size());
  field.sensor_width = width + 5;
  field.sensor_height = 10;
  field.window = {3, 2, width, 1};
  field.channels.push_back({"total", Image(width, 1), {}});
  for (int i = 0; i < width; ++i)
    field.channels[0].flux.at(i, 0) = static_cast<float>(fluxes[static_cast<std::size_t>(i)]);
  return field;
}

// IEC 61966-2-1 evaluated with 30 digits in mpmath.
TEST(Develop, SrgbFollowsTheStandard) {
  EXPECT_EQ(encode_srgb(0), 0);
  EXPECT_TRUE(relative(encode_srgb(0.001), 0.01292, 1e-15));
  EXPECT_TRUE(relative(encode_srgb(0.0031308), 0.040449936, 1e-15));
  EXPECT_TRUE(relative(encode_srgb(0.0031309), 0.040451177778598044, 1e-14));
  EXPECT_TRUE(relative(encode_srgb(0.18), 0.46135612950044165, 1e-14));
  EXPECT_TRUE(relative(encode_srgb(0.5), 0.73535698305244949, 1e-14));
  EXPECT_TRUE(relative(encode_srgb(1), 1, 1e-15));
}

TEST(Develop, LinearDigitalNumbersAreTheUpperBits) {
  for (int bits = 1; bits <= 16; ++bits) {
    // Each digital number of the sensor once (of wide sensors, some of them), in the middle.
    const int largest = (1 << bits) - 1, step = std::max(1, largest / 500);
    std::vector<double> fluxes;
    for (int number = 0; number <= largest; number += step)
      fluxes.push_back(5e-6 * number / largest);
    const DevelopedImage image = develop(make_field(fluxes), {5e-6, bits, ToneCurve::linear});
    EXPECT_EQ(image.picture.significant_bits, bits);
    EXPECT_EQ(image.picture.transfer, Transfer::linear);
    for (std::size_t i = 0; i < fluxes.size(); ++i)
      EXPECT_EQ(image.picture.samples[i] >> (16 - bits), static_cast<int>(i) * step) << bits;
    EXPECT_EQ(image.picture.samples[0], 0);
    if (largest % step == 0) {
      EXPECT_EQ(image.picture.samples.back(), 65535);
    }
  }
}

TEST(Develop, RoundsAndClips) {
  // 2 bits, saturation 3 W: the flux in W is the digital number.
  const DevelopedImage image = develop(
      make_field({-1, 0, 0.49, 0.51, 1.49, 1.51, 2.51, 2.999, 3, 40}), {3, 2, ToneCurve::linear});
  std::vector<int> numbers;
  for (const std::uint16_t sample : image.picture.samples) numbers.push_back(sample >> 14);
  EXPECT_EQ(numbers, (std::vector<int>{0, 0, 0, 1, 1, 2, 3, 3, 3, 3}));
  EXPECT_EQ(image.saturated, 2U);
  EXPECT_EQ(image.lit, 8U);
  EXPECT_TRUE(relative(image.saturated_share, 0.2, 1e-15));
  EXPECT_FALSE(image.automatic);
  EXPECT_EQ(image.saturation, 3);
}

TEST(Develop, DisplayCurveComesAfterTheSensor) {
  // 1 bit: 0.4 and 0.6 of saturation become black and white whatever the curve.
  const DevelopedImage coarse = develop(make_field({0.4, 0.6}), {1, 1, ToneCurve::display});
  EXPECT_EQ(coarse.picture.samples, (std::vector<std::uint16_t>{0, 65535}));
  EXPECT_EQ(coarse.picture.transfer, Transfer::srgb);
  // 16 bits: mpmath's 0.46135612950044165 * 65535 = 30234.97.
  const DevelopedImage fine = develop(make_field({0.18, 1}), {1, 16, ToneCurve::display});
  EXPECT_LE(std::abs(fine.picture.samples[0] - 30235), 1);
  EXPECT_EQ(fine.picture.samples[1], 65535);
}

TEST(Develop, AutomaticExposureKeepsAThousandthAbove) {
  // 10000 lit fluxes 1..10000 pW in mixed order and 500 dark pixels: 10 may exceed.
  std::vector<double> fluxes(10500, 0.0);
  for (std::size_t i = 0; i < 10000; ++i)
    fluxes[i] = 1e-12 * static_cast<double>(i * 7919 % 10000 + 1);
  const DevelopedImage image = develop(make_field(fluxes), {0, 14, ToneCurve::display});
  EXPECT_TRUE(image.automatic);
  EXPECT_TRUE(relative(image.saturation, 9990e-12, 1e-7));
  EXPECT_EQ(image.saturated, 11U);  // those above, and the one at saturation
  EXPECT_EQ(image.lit, 10000U);
  // Few pixels: the largest.
  EXPECT_TRUE(relative(develop(make_field({1e-9, 3e-9, 0}), {}).saturation, 3e-9, 1e-7));
}

TEST(Develop, DarkImageIsBlack) {
  const DevelopedImage image = develop(make_field({0, 0, -1e-12}), {});
  EXPECT_EQ(image.saturation, 0);
  EXPECT_EQ(image.lit, 0U);
  EXPECT_EQ(image.saturated, 0U);
  EXPECT_EQ(image.picture.samples, (std::vector<std::uint16_t>{0, 0, 0}));
}

TEST(Develop, ExtremesStayInRange) {
  const double tiny = std::numeric_limits<float>::denorm_min();
  const double huge = std::numeric_limits<float>::max();
  for (const double saturation : {0.0, 1e-300, 1e300}) {
    const DevelopedImage image =
        develop(make_field({tiny, huge, 0}), {saturation, 14, ToneCurve::linear});
    EXPECT_EQ(image.picture.samples[1] > 0, saturation < 1e300);
    EXPECT_EQ(image.picture.samples[2], 0);
  }
}

TEST(Develop, ChoosesTheChannel) {
  LightField field = make_field({1, 2});
  field.channels.push_back({"650nm", Image(2, 1, 4), {}});
  EXPECT_EQ(develop(field, {}).saturation, 2);
  EXPECT_EQ(develop(field, {}, "650nm").saturation, 4);
  try {
    develop(field, {}, "450nm");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("total, 650nm"), std::string::npos) << error.what();
  }
}

TEST(Develop, RefusesWhatMakesNoSense) {
  const LightField field = make_field({1, 2});
  EXPECT_THROW(develop(field, {1, 0, ToneCurve::linear}), InputError);
  EXPECT_THROW(develop(field, {1, 17, ToneCurve::linear}), InputError);
  EXPECT_THROW(develop(field, {-1, 14, ToneCurve::linear}), InputError);
  EXPECT_THROW(develop(field, {std::nan(""), 14, ToneCurve::linear}), InputError);
  LightField broken = field;
  broken.channels[0].flux.at(1, 0) = std::numeric_limits<float>::quiet_NaN();
  try {
    develop(broken, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("column 4, row 2"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace plenoflame::develop_test
