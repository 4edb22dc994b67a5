#include "plenoflame/base/units.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

#include "base/dimension_name.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// Converts a number with this unit to SI. The power of ten is applied to the decimal text before
/// it is rounded to a double. The values "0.1 mm", "100 um" and "1e-4 m" are therefore the same
/// double.
struct Unit {
  std::string_view name;
  int power_of_ten = 0;
  double multiply = 1, divide = 1, add = 0;  ///< after the power of ten
  bool readable = true;                      ///< format_quantity may choose it
};

constexpr double kPi = std::numbers::pi;
constexpr Unit kNone[] = {{"", 0}, {"%", -2, 1, 1, 0, false}};
constexpr Unit kLength[] = {{"m", 0},
                            {"mm", -3},
                            {"um", -6},
                            {"nm", -9},
                            {"cm", -2, 1, 1, 0, false},
                            {"km", 3, 1, 1, 0, false}};
constexpr Unit kTemperature[] = {{"K", 0}, {"degC", 0, 1, 1, 273.15, false}};
constexpr Unit kAbsorption[] = {{"1/m", 0}, {"1/mm", 3}, {"1/cm", 2, 1, 1, 0, false}};
constexpr Unit kAngle[] = {
    {"rad", 0, 1, 1, 0, false}, {"deg", 0, kPi, 180, 0, false}, {"mrad", -3, 1, 1, 0, false}};
constexpr Unit kFlux[] = {{"W", 0}, {"mW", -3}, {"uW", -6}, {"nW", -9}, {"pW", -12}, {"fW", -15}};
constexpr Unit kTime[] = {{"s", 0},
                          {"ms", -3},
                          {"us", -6},
                          {"ns", -9},
                          {"min", 0, 60, 1, 0, false},
                          {"h", 0, 3600, 1, 0, false}};
constexpr Unit kRadiance[] = {
    {"W/(m^2 sr)", 0}, {"mW/(m^2 sr)", -3}, {"kW/(m^2 sr)", 3}, {"W/(cm^2 sr)", 4, 1, 1, 0, false}};
constexpr Unit kSpectralRadiance[] = {
    {"W/(m^3 sr)", 0, 1, 1, 0, false}, {"W/(m^2 sr nm)", 9}, {"W/(m^2 sr um)", 6}};
constexpr Unit kIrradiance[] = {
    {"W/m^2", 0}, {"mW/m^2", -3}, {"kW/m^2", 3}, {"W/cm^2", 4, 1, 1, 0, false}};
constexpr Unit kFrequency[] = {{"Hz", 0}, {"kHz", 3}, {"MHz", 6}};

std::span<const Unit> units(Dimension dimension) {
  switch (dimension) {
    case Dimension::none:
      return kNone;
    case Dimension::length:
      return kLength;
    case Dimension::temperature:
      return kTemperature;
    case Dimension::absorption:
      return kAbsorption;
    case Dimension::angle:
      return kAngle;
    case Dimension::flux:
      return kFlux;
    case Dimension::time:
      return kTime;
    case Dimension::radiance:
      return kRadiance;
    case Dimension::spectral_radiance:
      return kSpectralRadiance;
    case Dimension::irradiance:
      return kIrradiance;
    case Dimension::frequency:
      return kFrequency;
  }
  return kNone;
}

}  // namespace

std::string_view dimension_name(Dimension dimension) {
  switch (dimension) {
    case Dimension::none:
      return "number";
    case Dimension::length:
      return "length";
    case Dimension::temperature:
      return "temperature";
    case Dimension::absorption:
      return "absorption coefficient";
    case Dimension::angle:
      return "angle";
    case Dimension::flux:
      return "radiant flux";
    case Dimension::time:
      return "time";
    case Dimension::radiance:
      return "radiance";
    case Dimension::spectral_radiance:
      return "spectral radiance";
    case Dimension::irradiance:
      return "irradiance";
    case Dimension::frequency:
      return "frequency";
  }
  return "number";
}

namespace {

std::string unit_list(Dimension dimension) {
  std::string list;
  for (const Unit& unit : units(dimension)) {
    if (unit.name.empty()) continue;
    if (!list.empty()) list += ", ";
    list += unit.name;
  }
  return list;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Text as it may stand in a one-line message.
std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text.substr(0, 40)) {
    const auto code = static_cast<unsigned char>(c);
    result += code < 0x20 || code == 0x7f ? '?' : c;
  }
  return result + (text.size() > 40 ? "...\"" : "\"");
}

/// A decimal number taken apart: sign, mantissa as written, exponent.
struct Decimal {
  bool negative = false;
  std::string_view mantissa;  ///< digits with at most one point
  int exponent = 0;
};

/// Takes a decimal number off the front of `text`; nothing when there is none.
std::optional<Decimal> take_decimal(std::string_view& text) {
  std::string_view rest = text;
  Decimal number;
  if (!rest.empty() && (rest[0] == '+' || rest[0] == '-')) {
    number.negative = rest[0] == '-';
    rest.remove_prefix(1);
  }
  std::size_t end = 0, digits = 0, points = 0;
  while (end < rest.size() && (is_digit(rest[end]) || (rest[end] == '.' && points == 0))) {
    ++(rest[end] == '.' ? points : digits);
    ++end;
  }
  if (digits == 0) return std::nullopt;
  number.mantissa = rest.substr(0, end);
  rest.remove_prefix(end);
  // An "e" belongs to the number only when digits follow.
  if (!rest.empty() && (rest[0] == 'e' || rest[0] == 'E')) {
    std::size_t first = 1;
    const bool minus = rest.size() > 1 && rest[1] == '-';
    if (rest.size() > 1 && (rest[1] == '-' || rest[1] == '+')) ++first;
    std::size_t last = first;
    int exponent = 0;
    while (last < rest.size() && is_digit(rest[last]))
      exponent = std::min(100000, 10 * exponent + (rest[last++] - '0'));
    if (last > first) {
      number.exponent = minus ? -exponent : exponent;
      rest.remove_prefix(last);
    }
  }
  text = rest;
  return number;
}

/// The double nearest to the decimal; nothing when it is out of a double's range.
std::optional<double> to_double(const Decimal& number, int power_of_ten) {
  std::string text(number.mantissa);
  text += 'e' + std::to_string(number.exponent + power_of_ten);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number.negative ? -value : value;
}

const Unit* find_unit(std::string_view name, Dimension dimension) {
  // The micro sign and the Greek letter mu, as UTF-8, both mean "u".
  std::string ascii;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const std::string_view two = name.substr(i, 2);
    if (two == "\xC2\xB5" || two == "\xCE\xBC") {
      ascii += 'u';
      ++i;
    } else {
      ascii += name[i];
    }
  }
  for (const Unit& unit : units(dimension))
    if (unit.name == ascii) return &unit;
  return nullptr;
}

[[noreturn]] void fail(std::string_view text, Dimension dimension, const std::string& why) {
  const std::string name(dimension_name(dimension));
  const bool vowel = std::string_view("aeiou").find(name.front()) != std::string_view::npos;
  throw InputError(in_quotes(text) + (vowel ? " is not an " : " is not a ") + name + ": " + why);
}

/// A decimal comma, "2,534 mm". @param rest from the comma on
[[noreturn]] void fail_at_comma(std::string_view text, std::string_view rest, Dimension dimension) {
  std::string with_point(text);
  with_point[static_cast<std::size_t>(rest.data() - text.data())] = '.';
  fail(text, dimension, "decimals follow a point, not a comma: " + in_quotes(with_point));
}

/// Writes the shortest digits of the value with a moved decimal point. In binary, value * 10^-shift
/// does not exist exactly, so the power of ten is applied to the text.
std::string decimal_text(double value, int shift) {
  std::array<char, 40> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::scientific)
                       .ptr;
  std::string_view text(buffer.data(), static_cast<std::size_t>(end - buffer.data()));
  const bool negative = text.front() == '-';
  if (negative) text.remove_prefix(1);
  const std::size_t e = text.find('e');
  std::string digits(text.substr(0, e));
  std::erase(digits, '.');
  std::string_view exponent_text = text.substr(e + 1);
  if (exponent_text.front() == '+') exponent_text.remove_prefix(1);
  int exponent = 0;
  std::from_chars(exponent_text.data(), exponent_text.data() + exponent_text.size(), exponent);
  exponent -= shift;
  std::string result(negative ? "-" : "");
  if (value == 0) {
    result += '0';
  } else if (exponent < -4 || exponent > 6) {
    result += digits[0];
    if (digits.size() > 1) result.append(".").append(digits, 1);
    result.append("e").append(std::to_string(exponent));
  } else if (exponent < 0) {
    result.append("0.").append(static_cast<std::size_t>(-exponent - 1), '0').append(digits);
  } else {
    const auto whole = static_cast<std::size_t>(exponent + 1);
    if (digits.size() <= whole) {
      result.append(digits).append(whole - digits.size(), '0');
    } else {
      result.append(digits, 0, whole).append(".").append(digits, whole);
    }
  }
  return result;
}

/// Degrees with as few digits as give the same double back; empty when none do.
std::string degrees_text(double value) {
  for (int precision = 1; precision <= 17; ++precision) {
    std::array<char, 40> buffer;
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value / kPi * 180,
                                   std::chars_format::general, precision)
                         .ptr;
    double degrees = 0;
    std::from_chars(buffer.data(), end, degrees);
    std::string text = decimal_text(degrees, 0) + " deg";
    if (std::isfinite(degrees) && parse_quantity(text, Dimension::angle) == value) return text;
  }
  return {};
}

}  // namespace

std::string_view si_unit(Dimension dimension) {
  return units(dimension).front().name;
}

std::vector<std::string> accepted_units(Dimension dimension) {
  std::vector<std::string> names;
  for (const Unit& unit : units(dimension))
    if (!unit.name.empty()) names.emplace_back(unit.name);
  return names;
}

double parse_quantity(std::string_view text, Dimension dimension) {
  const std::string_view whole = trim(text);
  if (whole.empty()) fail(text, dimension, "it is empty");
  std::string_view rest = whole;
  const auto number = take_decimal(rest);
  if (!number) {
    bool negative = false;
    if (rest[0] == '+' || rest[0] == '-') {
      negative = rest[0] == '-';
      rest.remove_prefix(1);
    }
    if (rest.substr(0, 3) == "inf") {
      const std::string_view unit = trim(rest.substr(3));
      if (unit.empty() || find_unit(unit, dimension)) {
        if (dimension != Dimension::length) fail(text, dimension, "only a length can be infinite");
        const double infinity = std::numeric_limits<double>::infinity();
        return negative ? -infinity : infinity;
      }
    }
    fail(text, dimension, "it does not begin with a number");
  }
  const std::string_view name = trim(rest);
  if (name.size() > 1 && name[0] == ',' && is_digit(name[1])) fail_at_comma(text, name, dimension);
  if (name.empty() && dimension != Dimension::none)
    fail(text, dimension, "its unit is missing (one of " + unit_list(dimension) + ")");
  const Unit* unit = find_unit(name, dimension);
  if (!unit && dimension == Dimension::none)
    fail(text, dimension, "it is a pure number, which takes no unit but %");
  if (!unit)
    fail(text, dimension, "the unit " + in_quotes(name) + " is not one of " + unit_list(dimension));
  const auto value = to_double(*number, unit->power_of_ten);
  double si = value ? *value * unit->multiply / unit->divide : 0;
  if (unit->add != 0) si += unit->add;  // not always: -0 + 0 would lose the sign
  if (!value || !std::isfinite(si)) fail(text, dimension, "it is out of the range of numbers");
  return si;
}

std::string format_quantity(double value, Dimension dimension) {
  if (std::isnan(value))
    throw InputError("a " + std::string(dimension_name(dimension)) + " is not a number (NaN)");
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  if (dimension == Dimension::none) return decimal_text(value, 0);
  const Unit* best = &units(dimension).front();
  if (value != 0) {
    if (dimension == Dimension::angle) {
      const std::string degrees = degrees_text(value);
      if (!degrees.empty()) return degrees;
    }
    // The largest unit in which the number is at least 1, or the smallest one there is.
    const double size = std::fabs(value);
    const Unit* smallest = nullptr;
    const Unit* fitting = nullptr;
    for (const Unit& unit : units(dimension)) {
      if (!unit.readable) continue;
      if (!smallest || unit.power_of_ten < smallest->power_of_ten) smallest = &unit;
      if (size >= std::pow(10.0, unit.power_of_ten) &&
          (!fitting || unit.power_of_ten > fitting->power_of_ten))
        fitting = &unit;
    }
    if (fitting)
      best = fitting;
    else if (smallest)
      best = smallest;
  }
  return decimal_text(value, best->power_of_ten) + " " + std::string(best->name);
}

std::string readable_quantity(double value, Dimension dimension, int digits) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return format_quantity(value, dimension);
  std::array<char, 40> buffer;
  const auto rounded = [&](double exact) {
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), exact,
                                   std::chars_format::scientific, digits - 1)
                         .ptr;
    double result = 0;
    std::from_chars(buffer.data(), end, result);
    return result;
  };
  if (dimension == Dimension::angle) return decimal_text(rounded(value / kPi * 180), 0) + " deg";
  return format_quantity(rounded(value), dimension);
}

}  // namespace plenoflame
