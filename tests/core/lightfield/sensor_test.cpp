#include "plenoflame/lightfield/sensor.h"

#include <cmath>
#include <limits>
#include <utility>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "plenoflame/camera/sensor_levels.h"
#include "plenoflame/radiometry/source_function.h"
#include "support/approx.h"

namespace plenoflame::sensor_test {
namespace {

using test::relative;

constexpr PixelWindow kWindow{5, 3, 64, 48};
constexpr int kWidth = 100;

SensorSpec quiet() {
  SensorSpec sensor;
  sensor.shot_noise = false;
  return sensor;
}

SensorFrame one(const Image& flux, const SensorSpec& sensor, double time, bool light = true,
                std::uint64_t number = 0, int threads = 1) {
  Execution execution;
  execution.threads = threads;
  return expose({{&flux, 650e-9}}, kWindow, kWidth, sensor, {time, light, number}, execution);
}

/// [W] that is so many electrons in 1 ms.
Image flux_of(double electrons, const SensorSpec& sensor) {
  const double per_joule =
      sensor.quantum_efficiency * sensor.fill_factor * 650e-9 / (6.62607015e-34 * 299792458.0);
  return Image(kWindow.width, kWindow.height, static_cast<float>(electrons / per_joule / 1e-3));
}

// kappa s = 0.1, 650 nm with 10 nm, f/2.7, transmission 0.85, quantum efficiency 0.4, pixels of 5.5
// um, 1 ms: published to four digits.
TEST(Sensor, CountsTheElectronsOfAFlame) {
  SensorSpec sensor = quiet();
  sensor.quantum_efficiency = 0.4;
  sensor.full_well = 1e9;
  const double rows[][2] = {{1500, 1336}, {1650, 5110}, {1800, 15630}, {2000, 53460}};
  for (const auto& row : rows) {
    // The spectral radiance at the centre for the whole band, as the source has it.
    const double radiance = planck_radiance(650e-9, row[0]) * 10e-9 * -std::expm1(-0.1);
    const double flux = radiance * 5.5e-6 * 5.5e-6 * constants::pi / (4 * 2.7 * 2.7 + 1) * 0.85;
    const Image image(kWindow.width, kWindow.height, static_cast<float>(flux));
    const SensorFrame frame = one(image, sensor, 1e-3);
    // 15 630 and 53 460 are rounded to tens.
    const double half = row[1] > 1e4 ? 5 : 0.5;
    EXPECT_TRUE(test::within(frame.electrons.at(0, 0), row[1], half, 1)) << row[0];
  }
  // With Planck's function integrated over the band (mpmath).
  const double of_band[][2] = {{1500, 1337.032}, {1650, 5112.847}, {1800, 15635.43}};
  for (const auto& row : of_band) {
    const double radiance = SourceFunction::band(650e-9, 10e-9)(row[0]) * -std::expm1(-0.1);
    const double flux = radiance * 5.5e-6 * 5.5e-6 * constants::pi / (4 * 2.7 * 2.7 + 1) * 0.85;
    const Image image(kWindow.width, kWindow.height, static_cast<float>(flux));
    const SensorFrame frame = one(image, sensor, 1e-3);
    EXPECT_TRUE(test::relative(frame.electrons.at(0, 0), row[1], 1e-6)) << row[0];
  }
  sensor.full_well = 20000;
  const Image bright(kWindow.width, kWindow.height, 1e-10F);
  const SensorFrame full = one(bright, sensor, 1e-3);
  EXPECT_EQ(full.electrons.at(3, 3), 20000);
  EXPECT_EQ(full.saturated, full.numbers.size());
  EXPECT_EQ(full.numbers[0], 16383);
}

TEST(Sensor, DigitalNumbers) {
  SensorSpec sensor = quiet();
  sensor.gain = 2.5;
  sensor.black_level = 64;
  sensor.bits = 12;
  sensor.fill_factor = 0.5;
  EXPECT_EQ(one(flux_of(1000, sensor), sensor, 1e-3).numbers[7], 464);
  EXPECT_EQ(one(flux_of(1000, sensor), sensor, 2e-3).numbers[7], 864);
  EXPECT_EQ(one(flux_of(1000, sensor), sensor, 1e-3, false).numbers[7], 64);
  EXPECT_EQ(one(flux_of(15000, sensor), sensor, 1e-3).numbers[7], 4095);
  sensor.dark_current = 5e4;
  EXPECT_EQ(one(flux_of(1000, sensor), sensor, 1e-3, false).numbers[7], 84);
  sensor.gain = 0;
  const SensorFrame frame = one(flux_of(1000, sensor), sensor, 1e-3);
  EXPECT_TRUE(relative(frame.gain, 20000.0 / (4095 - 64), 1e-15));
}

TEST(Sensor, LevelsLeaveRoomForTheReadNoise) {
  SensorSpec sensor;
  EXPECT_EQ(resolved_levels(sensor).black_level, 0) << "without read noise none is needed";
  sensor.read_noise = 12;
  sensor.bits = 12;
  // 5 x 12 electrons of 20060 / 4095 each are 12.2 numbers, of which rounding gives a half.
  EXPECT_EQ(resolved_levels(sensor).black_level, 12);
  EXPECT_TRUE(relative(resolved_levels(sensor).gain, 20000.0 / (4095 - 12), 1e-15));
  sensor.gain = 2;
  EXPECT_EQ(resolved_levels(sensor).black_level, 30);
  EXPECT_EQ(resolved_levels(sensor).gain, 2);
  sensor.black_level = 3;
  EXPECT_EQ(resolved_levels(sensor).black_level, 3);
  sensor = {};
  sensor.read_noise = 12;
  sensor.gain = 200;
  EXPECT_EQ(resolved_levels(sensor).black_level, 0) << "one number is more than all noise";
  sensor.bits = 2;
  sensor.gain = 1;
  EXPECT_EQ(resolved_levels(sensor).black_level, 1) << "of 0 to 3";
}

/// Mean electrons by the digital numbers of 40 dark frames, and its standard error.
std::pair<double, double> dark_mean(const SensorSpec& sensor) {
  const Image black(kWindow.width, kWindow.height);
  double sum = 0, squares = 0, n = 0;
  for (std::uint64_t number = 0; number < 40; ++number) {
    const SensorFrame frame = one(black, sensor, 1e-3, false, number);
    for (const std::uint16_t value : frame.numbers) {
      const double electrons = (value - frame.black_level) * frame.gain;
      sum += electrons;
      squares += electrons * electrons;
      n += 1;
    }
  }
  return {sum / n, std::sqrt((squares - sum * sum / n) / (n - 1) / n)};
}

// With a black level of 0 half of the noise would be cut off: 12 / sqrt(2 pi) electrons too many.
TEST(Sensor, DarkPixelsAreDarkOnAverage) {
  SensorSpec sensor;
  sensor.read_noise = 12;
  for (const int bits : {10, 12, 14}) {
    sensor.bits = bits;
    const auto [mean, error] = dark_mean(sensor);
    EXPECT_TRUE(test::within_standard_errors(mean, 0, error, 4)) << bits;
    EXPECT_LT(dark_pixel_excess(sensor), 1e-6 * sensor.read_noise);
  }
  sensor.gain = 1;
  for (const double black_level : {1.0, 6.0, 20.0}) {
    sensor.black_level = black_level;
    const auto [mean, error] = dark_mean(sensor);
    const double excess = dark_pixel_excess(sensor);
    EXPECT_TRUE(test::within_standard_errors(mean, excess, error, 4));
    EXPECT_GT(excess, 0.1);
  }
  sensor.gain = 10;
  sensor.black_level = 0.5;
  const auto [coarse, error] = dark_mean(sensor);
  EXPECT_TRUE(test::within_standard_errors(coarse, dark_pixel_excess(sensor), error, 4));
  // A dark current lifts the pixels away from 0.
  sensor.black_level = 1;
  sensor.exposure_time = 1e-3;
  sensor.dark_current = 50e3;
  EXPECT_LT(dark_pixel_excess(sensor), 0.01);
}

struct Moments {
  double mean = 0, variance = 0;
};
Moments moments(const Image& image) {
  Moments m;
  const auto n = static_cast<double>(image.pixels.size());
  for (const float v : image.pixels) m.mean += static_cast<double>(v) / n;
  for (const float v : image.pixels)
    m.variance += (static_cast<double>(v) - m.mean) * (static_cast<double>(v) - m.mean) / (n - 1);
  return m;
}

// Sum of squares over the variance: chi-square with one degree of freedom per pixel.
TEST(Sensor, NoiseHasItsVariance) {
  SensorSpec sensor;
  sensor.read_noise = 12;
  sensor.dark_current = 20e3;
  const double n = kWindow.width * kWindow.height;
  const double expected = 400 + 20, variance = expected + 144;
  const Moments m = moments(one(flux_of(400, sensor), sensor, 1e-3).electrons);
  EXPECT_TRUE(test::within_standard_errors(m.mean, expected, std::sqrt(variance / n), 4));
  EXPECT_TRUE(test::within_standard_errors(m.variance, variance, variance * std::sqrt(2 / n), 4));
  sensor.shot_noise = false;
  const Moments read = moments(one(flux_of(400, sensor), sensor, 1e-3).electrons);
  EXPECT_TRUE(test::within_standard_errors(read.variance, 144, 144 * std::sqrt(2 / n), 4));
  sensor.read_noise = 0;
  EXPECT_EQ(moments(one(flux_of(400, sensor), sensor, 1e-3).electrons).variance, 0);
}

TEST(Sensor, NoiseBelongsToThePixel) {
  SensorSpec sensor;
  sensor.read_noise = 3;
  const Image flux = flux_of(100, sensor);
  const SensorFrame a = one(flux, sensor, 1e-3), b = one(flux, sensor, 1e-3, true, 0, 3);
  EXPECT_EQ(a.electrons.pixels, b.electrons.pixels);
  EXPECT_EQ(a.numbers, b.numbers);
  EXPECT_NE(a.numbers, one(flux, sensor, 1e-3, true, 1).numbers);
  sensor.noise_seed = 2;
  EXPECT_NE(a.numbers, one(flux, sensor, 1e-3).numbers);
  sensor.noise_seed = 1;
  // Another window of the same sensor sees the same pixels.
  const Image part(8, 8, flux.pixels[0]);
  const SensorFrame c =
      expose({{&part, 650e-9}}, {10, 9, 8, 8}, kWidth, sensor, {1e-3, true, 0}, {});
  EXPECT_EQ(c.electrons.at(2, 1), a.electrons.at(7, 7));
}

TEST(Sensor, ADarkFrameHasNoiseOfItsOwn) {
  // Without light both see the same; what they scatter by must not cancel when one is subtracted.
  SensorSpec sensor = quiet();
  sensor.read_noise = 10;
  sensor.full_well = 1e6;
  const Image black(kWindow.width, kWindow.height);
  const SensorFrame light = one(black, sensor, 1e-3), dark = one(black, sensor, 1e-3, false);
  double squares = 0;
  for (std::size_t i = 0; i < light.electrons.pixels.size(); ++i)
    squares += std::pow(static_cast<double>(light.electrons.pixels[i]) -
                            static_cast<double>(dark.electrons.pixels[i]),
                        2);
  // A sum of n squared deviates of variance 2 * 10^2 scatters by sqrt(2 / n) of itself.
  const auto n = static_cast<double>(light.electrons.pixels.size());
  EXPECT_TRUE(test::within_standard_errors(squares / n, 200, 200 * std::sqrt(2 / n), 4));
}

TEST(Sensor, DemosaicedPixelsAreMeansOfSoMany) {
  const auto colours = demosaic(Image(6, 6, 1), MosaicPattern::rggb, {0, 0, 6, 6});
  // Red at even columns and rows: itself; green there of 4, blue of 4; red at green pixels of 2.
  EXPECT_EQ(colours[0].counts.at(2, 2), 1);
  EXPECT_EQ(colours[1].counts.at(2, 2), 4);
  EXPECT_EQ(colours[2].counts.at(2, 2), 4);
  EXPECT_EQ(colours[0].counts.at(3, 2), 2);
  EXPECT_EQ(colours[0].counts.at(3, 3), 4);
  EXPECT_EQ(colours[2].counts.at(0, 0), 1) << "the corner has one blue neighbour";
}

TEST(Sensor, DefectsStayWhereTheyAre) {
  SensorSpec sensor = quiet();
  sensor.hot_pixels = 0.1;
  sensor.hot_current = 5e5;
  sensor.dead_pixels = 0.05;
  const SensorFrame dark = one(flux_of(100, sensor), sensor, 1e-3, false);
  const SensorFrame lit = one(flux_of(100, sensor), sensor, 1e-3, true, 1);
  double hot = 0, dead = 0;
  for (std::size_t i = 0; i < lit.electrons.pixels.size(); ++i) {
    const float e = lit.electrons.pixels[i];
    hot += e > 400 ? 1 : 0;
    dead += e == 0 ? 1 : 0;
    EXPECT_EQ(dark.electrons.pixels[i] > 400, e > 400);
  }
  const double n = static_cast<double>(lit.electrons.pixels.size());
  EXPECT_TRUE(test::within_standard_errors(hot, 0.1 * n, std::sqrt(0.09 * n), 4));
  EXPECT_TRUE(test::within_standard_errors(dead, 0.05 * n, std::sqrt(0.0475 * n), 4));
}

TEST(Sensor, AutomaticExposureFillsTheWell) {
  const SensorSpec sensor = quiet();
  Image flux = flux_of(100, sensor);
  flux.at(1, 1) *= 4;
  const SensorFrame frame = one(flux, sensor, 0);
  // One bright pixel is less than 0.1 % of them.
  EXPECT_TRUE(relative(frame.electrons.at(0, 0), 19000, 1e-6));
  EXPECT_EQ(frame.saturated, 1u);
}

// R G / G B, counted on the whole sensor.
TEST(Sensor, MosaicAndItsColours) {
  EXPECT_EQ(mosaic_colour(MosaicPattern::rggb, 0, 0), 0);
  EXPECT_EQ(mosaic_colour(MosaicPattern::rggb, 1, 0), 1);
  EXPECT_EQ(mosaic_colour(MosaicPattern::rggb, 0, 1), 1);
  EXPECT_EQ(mosaic_colour(MosaicPattern::rggb, 1, 1), 2);
  EXPECT_EQ(mosaic_colour(MosaicPattern::gbrg, 1, 0), 2);
  EXPECT_EQ(mosaic_colour(MosaicPattern::grbg, 1, 0), 0);
  EXPECT_EQ(mosaic_colour(MosaicPattern::bggr, 0, 0), 2);
  SensorSpec sensor = quiet();
  sensor.mosaic = MosaicPattern::bggr;
  const Image red = flux_of(300, sensor), green = flux_of(200, sensor), blue = flux_of(100, sensor);
  const SensorFrame frame = expose({{&red, 650e-9}, {&green, 650e-9}, {&blue, 650e-9}}, kWindow,
                                   kWidth, sensor, {1e-3, true, 0}, {});
  // The window begins in column 5, row 3: odd and odd, red.
  EXPECT_TRUE(relative(frame.electrons.at(0, 0), 300, 1e-6));
  EXPECT_TRUE(relative(frame.electrons.at(1, 0), 200, 1e-6));
  EXPECT_TRUE(relative(frame.electrons.at(1, 1), 100, 1e-6));
  const auto colours = demosaic(frame.electrons, sensor.mosaic, kWindow);
  for (int row = 0; row < kWindow.height; ++row)
    for (int column = 0; column < kWindow.width; ++column) {
      ASSERT_TRUE(relative(colours[0].values.at(column, row), 300, 1e-6));
      ASSERT_TRUE(relative(colours[1].values.at(column, row), 200, 1e-6));
      ASSERT_TRUE(relative(colours[2].values.at(column, row), 100, 1e-6));
    }
}

TEST(Sensor, RefusesWhatIsImpossible) {
  const Image flux(kWindow.width, kWindow.height, 1e-12F);
  SensorSpec sensor;
  sensor.full_well = 0;
  EXPECT_THROW(one(flux, sensor, 1e-3), InputError);
  sensor = {};
  sensor.black_level = 20000;
  EXPECT_THROW(one(flux, sensor, 1e-3), InputError);
  sensor = {};
  EXPECT_THROW(expose({{&flux, 0}}, kWindow, kWidth, sensor, {}, {}), InputError);
  sensor.mosaic = MosaicPattern::rggb;
  EXPECT_THROW(one(flux, sensor, 1e-3), InputError);
  Image bad = flux;
  bad.at(2, 2) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(one(bad, {}, 1e-3), InputError);
}

}  // namespace
}  // namespace plenoflame::sensor_test
