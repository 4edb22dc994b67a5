#include <charconv>
#include <cmath>

#include "optics/shape_kernel.h"
#include "plenoflame/base/error.h"
#include "plenoflame/optics/surface_shape.h"

namespace plenoflame {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

/// The decimal text times 10^power, rounded once.
double scaled(std::string_view digits, int power, std::string_view whole) {
  double value = 0;
  const auto exponent = digits.find_first_of("eE");
  int shift = power;
  if (exponent != std::string_view::npos) {
    std::string_view after = digits.substr(exponent + 1);
    if (after.starts_with('+')) after.remove_prefix(1);
    int given = 0;
    const auto [at, error] = std::from_chars(after.data(), after.data() + after.size(), given);
    if (error != std::errc() || at != after.data() + after.size() || std::abs(given) > 400)
      throw InputError("\"" + std::string(whole) + "\" is not an aspheric term");
    shift += given;
  }
  const std::string text = std::string(digits.substr(0, exponent)) + "e" + std::to_string(shift);
  const auto [at, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || at != text.data() + text.size() || !std::isfinite(value))
    throw InputError("\"" + std::string(whole) + "\" is not an aspheric term");
  return value;
}

double parse_term(std::string_view term, int power) {
  const auto blank = term.find(' ');
  const std::string_view digits = term.substr(0, blank);
  const std::string_view unit =
      blank == std::string_view::npos ? std::string_view() : trimmed(term.substr(blank));
  const std::string n = std::to_string(power);
  if (unit == "1/m^" + n) return scaled(digits, 0, term);
  if (unit == "1/mm^" + n) return scaled(digits, 3 * power, term);
  if (unit.empty() && scaled(digits, 0, term) == 0) return 0;
  throw InputError("aspheric term \"" + std::string(term) + "\" needs the unit 1/mm^" + n +
                   " or 1/m^" + n + ": it is the coefficient of h^" + std::to_string(power + 1));
}

}  // namespace

std::vector<double> parse_aspheric(std::string_view text) {
  std::vector<double> terms;
  text = trimmed(text);
  while (!text.empty()) {
    const auto comma = text.find(',');
    if (terms.size() == kAsphericTerms)
      throw InputError("a surface has at most 7 aspheric terms, of h^4 to h^16");
    terms.push_back(
        parse_term(trimmed(text.substr(0, comma)), 3 + 2 * static_cast<int>(terms.size())));
    if (comma == std::string_view::npos) break;
    text = trimmed(text.substr(comma + 1));
    if (text.empty()) throw InputError("an aspheric term is missing after the last comma");
  }
  while (!terms.empty() && terms.back() == 0) terms.pop_back();
  return terms;
}

std::string format_aspheric(const std::vector<double>& terms) {
  std::string text;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    char digits[40];
    const auto end = std::to_chars(digits, digits + sizeof digits, terms[i]).ptr;
    text.append(i > 0 ? ", " : "").append(digits, end);
    text.append(" 1/m^").append(std::to_string(3 + 2 * i));
  }
  return text;
}

}  // namespace plenoflame
