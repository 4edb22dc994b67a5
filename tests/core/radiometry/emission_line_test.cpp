#include "plenoflame/radiometry/emission_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::emission_line_test {
namespace {

using test::relative;
using test::within;

TEST(EmissionLine, NarrowLinesTakeTheResponseWhereTheyAre) {
  const EmissionLine ch = EmissionLine::named("ch");
  EXPECT_TRUE(relative(ch.wavelength(), 431.54e-9, 1e-12));
  EXPECT_EQ(ch.seen_by(std::nullopt), 1);
  EXPECT_EQ(ch.seen_by(SpectralResponse::band(430e-9, 10e-9)), 1);
  EXPECT_EQ(ch.seen_by(SpectralResponse::band(650e-9, 10e-9)), 0);
  const SpectralResponse slope = SpectralResponse::curve({{400e-9, 0.2}, {500e-9, 0.8}});
  EXPECT_TRUE(relative(ch.seen_by(slope), 0.2 + 0.6 * 0.3154, 1e-9));
}

// A band that ends between the sodium lines sees the stronger one alone.
TEST(EmissionLine, SodiumHasTwoComponents) {
  const EmissionLine sodium = EmissionLine::named("na_d");
  EXPECT_TRUE(relative(sodium.seen_by(SpectralResponse::band(584.5e-9, 10e-9)), 2.0 / 3, 1e-12));
  EXPECT_TRUE(relative(sodium.seen_by(SpectralResponse::band(594.5e-9, 10e-9)), 1.0 / 3, 1e-12));
  EXPECT_EQ(sodium.seen_by(SpectralResponse::band(590e-9, 10e-9)), 1);
  // The mean of the lines in air, plus the refraction of air, by 1.5 pm.
  EXPECT_TRUE(relative(sodium.wavelength(), (2 * 588.995e-9 + 589.5924e-9) / 3 * 1.000277, 2.5e-6));
}

// Share of a Gaussian that a band cuts out, by the error function; a band that ends in the middle
// of the line sees half of it. Fails when the profile is taken for a width of one deviation.
TEST(EmissionLine, WideLinesAreAveraged) {
  const double centre = 516.66e-9, width = 3e-9;
  const EmissionLine line = EmissionLine::at(centre, width);
  const double deviation = width / (2 * std::sqrt(2 * std::log(2.0)));
  for (const double low : {-4e-9, -1e-9, 0.0, 0.7e-9})
    for (const double band : {0.5e-9, 2e-9, 20e-9}) {
      const double root = std::sqrt(2.0) * deviation;
      const double expected = 0.5 * (std::erf((low + band) / root) - std::erf(low / root));
      const double seen = line.seen_by(SpectralResponse::band(centre + low + 0.5 * band, band));
      EXPECT_TRUE(within(seen, expected, 1e-12, 1)) << low << " " << band;
    }
  EXPECT_TRUE(relative(line.seen_by(SpectralResponse::band(centre, 100e-9)), 1, 1e-12));
  // A Gaussian filter of the same width in the middle of it: the product has 1 / sqrt 2.
  EXPECT_TRUE(
      relative(line.seen_by(SpectralResponse::gaussian(centre, width)), std::sqrt(0.5), 2e-4));
}

TEST(EmissionLine, Refusals) {
  EXPECT_THROW(EmissionLine::at(0), InputError);
  EXPECT_THROW(EmissionLine::at(500e-9, -1e-9), InputError);
  EXPECT_THROW(EmissionLine::at(500e-9, 200e-9), InputError);
  try {
    EmissionLine::named("xy");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("ch, c2_474, c2_517"), std::string::npos);
  }
  for (const NamedLine& line : named_lines())
    EXPECT_GT(EmissionLine::named(line.name).wavelength(), 300e-9);
}

TEST(EmissionLine, Units) {
  EXPECT_EQ(emission_unit("W/m^3", 5e-7), 1);
  EXPECT_EQ(emission_unit("w/cm^3", 5e-7), 1e6);
  EXPECT_TRUE(relative(*emission_unit("W/(m^3 sr)", 5e-7), 12.566370614359172, 1e-15));
  // N_A h c = 0.119626565638697 J m/mol, a product of exact constants: photons of 500 nm.
  EXPECT_TRUE(relative(*emission_unit("mol/(m^3 s)", 5e-7), 239253.131277394, 1e-12));
  EXPECT_TRUE(relative(*emission_unit("1/(cm^3 s)", 5e-7), 3.9728917e-13, 1e-7));
  EXPECT_FALSE(emission_unit("W/m^2", 5e-7).has_value());
  EXPECT_FALSE(emission_unit("", 5e-7).has_value());
}

}  // namespace
}  // namespace plenoflame::emission_line_test
