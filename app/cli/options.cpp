#include "options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <system_error>

#include "plenoflame/base/error.h"

namespace plenoflame::cli {
namespace {

std::string four_digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// Least number of characters to insert, remove, replace or swap with their neighbour.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last, row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = last;
    last = row;
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row.back();
}

}  // namespace

double quantity_option(std::string_view option, const std::string& text, Dimension dimension) {
  try {
    return parse_quantity(text, dimension);
  } catch (const InputError& error) {
    throw UsageError(std::string(option) + ": " + error.what());
  }
}

PixelWindow window_option(std::string_view option, const std::string& text) {
  std::array<int, 4> numbers{};
  const char* at = text.data();
  const char* const end = at + text.size();
  bool good = true;
  for (std::size_t i = 0; i < numbers.size() && good; ++i) {
    const auto [after, error] = std::from_chars(at, end, numbers[i]);
    good = error == std::errc() && (i == 3 ? after == end : after != end && *after == ',');
    at = after + 1;
  }
  const auto [x, y, width, height] = numbers;
  if (!good)
    throw UsageError(std::string(option) + " takes four whole numbers X,Y,W,H (first column and " +
                     "row, width and height in pixels), not '" + text + "'");
  if (x < 0 || y < 0 || width < 1 || height < 1)
    throw UsageError(std::string(option) + ": X and Y start at 0, W and H at 1, not '" + text +
                     "'");
  return {x, y, width, height};
}

void check_not_overwritten(std::string_view option, const std::string& output,
                           const std::string& input) {
  std::error_code ignored;
  if (output == input || std::filesystem::equivalent(output, input, ignored))
    throw UsageError(std::string(option) + ": '" + output +
                     "' is a file that this command reads; give another name");
}

std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(1, name.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance >= least) continue;
    least = distance;
    nearest = candidate;
  }
  return nearest;
}

std::string readable(double value, Dimension dimension) {
  return readable_quantity(value, dimension);
}

std::string readable_percent(double share) {
  return four_digits(100 * share) + " %";
}

std::string readable_number(double value) {
  return four_digits(value);
}

}  // namespace plenoflame::cli
