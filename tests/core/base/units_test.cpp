#include "plenoflame/base/units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::units_test {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

std::string message_of(const std::string& text, Dimension dimension) {
  try {
    parse_quantity(text, dimension);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// The reference is the compiler's own conversion of the decimal in SI: the nearest double.
TEST(ParseQuantity, IsTheNearestDoubleOfTheDecimalInSi) {
  EXPECT_EQ(parse_quantity("0.1 mm", Dimension::length), 0.0001);
  EXPECT_EQ(parse_quantity("100 um", Dimension::length), 0.0001);
  EXPECT_EQ(parse_quantity("0.2534 mm", Dimension::length), 0.0002534);
  EXPECT_EQ(parse_quantity("304.0987mm", Dimension::length), 0.3040987);
  EXPECT_EQ(parse_quantity("  650 nm ", Dimension::length), 650e-9);
  EXPECT_EQ(parse_quantity("5.5 \xC2\xB5m", Dimension::length), 5.5e-6);
  EXPECT_EQ(parse_quantity("5.5 \xCE\xBCm", Dimension::length), 5.5e-6);
  EXPECT_EQ(parse_quantity("2.4 cm", Dimension::length), 0.024);
  EXPECT_EQ(parse_quantity("+1.5e-2 km", Dimension::length), 15.0);
  EXPECT_EQ(parse_quantity("-.5 m", Dimension::length), -0.5);
  EXPECT_EQ(parse_quantity("5. m", Dimension::length), 5.0);
  EXPECT_EQ(parse_quantity("1650 K", Dimension::temperature), 1650.0);
  EXPECT_EQ(parse_quantity("30 1/m", Dimension::absorption), 30.0);
  EXPECT_EQ(parse_quantity("0.3 1/cm", Dimension::absorption), 30.0);
  EXPECT_EQ(parse_quantity("0.03 1/mm", Dimension::absorption), 30.0);
  EXPECT_EQ(parse_quantity("5000 nW", Dimension::flux), 5e-6);
  EXPECT_EQ(parse_quantity("10 min", Dimension::time), 600.0);
  EXPECT_EQ(parse_quantity("1.5 h", Dimension::time), 5400.0);
  EXPECT_EQ(parse_quantity("60s", Dimension::time), 60.0);
  EXPECT_EQ(parse_quantity("2 W/(m^2 sr nm)", Dimension::spectral_radiance), 2e9);
  EXPECT_EQ(parse_quantity("3 W/(cm^2 sr)", Dimension::radiance), 3e4);
  EXPECT_EQ(parse_quantity("1.5", Dimension::none), 1.5);
  EXPECT_EQ(parse_quantity("1 %", Dimension::none), 0.01);
  EXPECT_EQ(parse_quantity("12.5%", Dimension::none), 0.125);
  EXPECT_EQ(parse_quantity("180 deg", Dimension::angle), std::numbers::pi);
  EXPECT_EQ(parse_quantity("90 deg", Dimension::angle), std::numbers::pi / 2);
  EXPECT_EQ(parse_quantity("2 mrad", Dimension::angle), 0.002);
  EXPECT_TRUE(test::relative(parse_quantity("25 degC", Dimension::temperature), 298.15, 1e-15));
  EXPECT_EQ(parse_quantity("inf", Dimension::length), kInf);
  EXPECT_EQ(parse_quantity("-inf m", Dimension::length), -kInf);
}

TEST(ParseQuantity, SaysWhatIsWrong) {
  EXPECT_EQ(message_of("0.1", Dimension::length),
            "\"0.1\" is not a length: its unit is missing (one of m, mm, um, nm, cm, km)");
  EXPECT_EQ(message_of("8", Dimension::absorption).find("\"8\" is not an absorption"), 0U);
  EXPECT_EQ(message_of("0.1 K", Dimension::length),
            "\"0.1 K\" is not a length: the unit \"K\" is not one of m, mm, um, nm, cm, km");
  EXPECT_EQ(message_of("nan mm", Dimension::length),
            "\"nan mm\" is not a length: it does not begin with a number");
  EXPECT_EQ(message_of("inf K", Dimension::temperature),
            "\"inf K\" is not a temperature: only a length can be infinite");
  EXPECT_EQ(message_of("1e400 m", Dimension::length),
            "\"1e400 m\" is not a length: it is out of the range of numbers");
  for (const char* bad :
       {"", " ", "mm", "-", "+", ".", "e5 m", "0x10 m", "1,5 mm", "1 2 m", "inff m", "1 M", "--1 m",
        "1e999999999999999999999 m", "1e308 km", "NaN", "\x01 m"})
    EXPECT_NE(message_of(bad, Dimension::length), "") << bad;
  for (const char* bad : {"1 mm", "inf", "nan", "1 %%"})
    EXPECT_NE(message_of(bad, Dimension::none), "") << bad;
  EXPECT_THROW(format_quantity(std::nan(""), Dimension::length), InputError);
}

TEST(FormatQuantity, ChoosesAReadableUnit) {
  EXPECT_EQ(format_quantity(0.0001, Dimension::length), "100 um");
  EXPECT_EQ(format_quantity(1.2, Dimension::length), "1.2 m");
  EXPECT_EQ(format_quantity(0.3040987, Dimension::length), "304.0987 mm");
  EXPECT_EQ(format_quantity(-0.029, Dimension::length), "-29 mm");
  EXPECT_EQ(format_quantity(650e-9, Dimension::length), "650 nm");
  EXPECT_EQ(format_quantity(1e-12, Dimension::length), "0.001 nm");
  EXPECT_EQ(format_quantity(0, Dimension::length), "0 m");
  EXPECT_EQ(format_quantity(kInf, Dimension::length), "inf");
  EXPECT_EQ(format_quantity(1650, Dimension::temperature), "1650 K");
  EXPECT_EQ(format_quantity(30, Dimension::absorption), "30 1/m");
  EXPECT_EQ(format_quantity(5e-6, Dimension::flux), "5 uW");
  EXPECT_EQ(format_quantity(std::numbers::pi / 2, Dimension::angle), "90 deg");
  EXPECT_EQ(format_quantity(1.59, Dimension::none), "1.59");
  EXPECT_EQ(format_quantity(1e22, Dimension::none), "1e22");
}

// Every double must come back bit for bit: random bit patterns and neighbours of round numbers.
TEST(FormatQuantity, RoundTripsBitForBit) {
  std::mt19937_64 random(20170301);
  const Dimension dimensions[] = {
      Dimension::none,  Dimension::length,   Dimension::temperature,
      Dimension::angle, Dimension::flux,     Dimension::absorption,
      Dimension::time,  Dimension::radiance, Dimension::spectral_radiance};
  const auto check = [](double value, Dimension dimension) {
    const double back = parse_quantity(format_quantity(value, dimension), dimension);
    ASSERT_EQ(std::memcmp(&back, &value, sizeof value), 0)
        << value << " became " << back << " through " << format_quantity(value, dimension);
  };
  for (const Dimension dimension : dimensions) {
    for (int i = 0; i < 3000; ++i) {
      const std::uint64_t bits = random();
      double value;
      std::memcpy(&value, &bits, sizeof value);
      // Beyond 1e290 the unit's power of ten may leave the range of the text's number; no such
      // quantity exists.
      if (!std::isfinite(value) || std::fabs(value) > 1e290 || std::fabs(value) < 1e-290) continue;
      check(value, dimension);
    }
    for (double round = 1e-12; round < 1e12; round *= 10)
      for (const double factor : {1.0, 1.5, 3.0, 7.3})
        for (const double towards : {-kInf, 0.0, kInf})
          check(std::nextafter(round * factor, towards), dimension);
    check(0.0, dimension);
    check(-0.0, dimension);
  }
  for (int degrees = -360; degrees <= 360; ++degrees) {
    if (degrees == 0) continue;
    const std::string text = std::to_string(degrees) + " deg";
    EXPECT_EQ(format_quantity(parse_quantity(text, Dimension::angle), Dimension::angle), text);
  }
}

TEST(Units, SiUnitComesFirst) {
  EXPECT_EQ(si_unit(Dimension::absorption), "1/m");
  EXPECT_EQ(si_unit(Dimension::none), "");
  EXPECT_EQ(accepted_units(Dimension::length).front(), "m");
  for (const Dimension dimension :
       {Dimension::length, Dimension::flux, Dimension::time, Dimension::absorption})
    for (const std::string& unit : accepted_units(dimension))
      EXPECT_GT(parse_quantity("1 " + unit, dimension), 0) << unit;
}

TEST(ParseQuantity, KnowsADecimalComma) {
  EXPECT_EQ(message_of("2,534 mm", Dimension::length),
            "\"2,534 mm\" is not a length: decimals follow a point, not a comma: \"2.534 mm\"");
  EXPECT_NE(message_of("1,5", Dimension::none).find("\"1.5\""), std::string::npos);
  EXPECT_EQ(message_of("2 mm, 5 mm", Dimension::length).find("point"), std::string::npos);
}

}  // namespace
}  // namespace plenoflame::units_test
