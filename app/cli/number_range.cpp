#include "number_range.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <functional>
#include <string>

namespace plenoflame::cli {
namespace {

/// @param what condition, after "a number " @return a message; empty: the number fulfils it
CLI::Validator number_that(const std::string& what, const std::function<bool(double)>& fits) {
  const auto check = [what, fits](const std::string& text) -> std::string {
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    const bool number = error == std::errc() && stop == end && std::isfinite(value);
    return number && fits(value) ? "" : fmt::format("{} is not a number {}", text, what);
  };
  return CLI::Validator(check, "");
}

}  // namespace

CLI::Validator number_between(double low, double high) {
  return number_that(fmt::format("from {} to {}", low, high),
                     [=](double value) { return value >= low && value <= high; });
}

CLI::Validator number_above(double low) {
  return number_that(fmt::format("above {}", low), [=](double value) { return value > low; });
}

CLI::Validator number_from(double low) {
  return number_that(fmt::format("of at least {}", low),
                     [=](double value) { return value >= low; });
}

}  // namespace plenoflame::cli
