#include "options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <locale>
#include <numeric>
#include <sstream>
#include <system_error>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

namespace fs = std::filesystem;

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

bool is_digits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// The name without links, "." and ".."; also of a file that is not there yet, or of a link to one.
fs::path resolved(const std::string& path) {
  constexpr int kMostLinks = 40;  // as the system follows
  std::error_code ignored;
  fs::path target = fs::absolute(path, ignored);
  for (int links = 0; links < kMostLinks && fs::is_symlink(target, ignored); ++links)
    target = target.parent_path() / fs::read_symlink(target, ignored);
  fs::path name = fs::weakly_canonical(target, ignored);
  return name.has_filename() ? name : name.parent_path();
}

}  // namespace

double quantity_option(std::string_view option, const std::string& text, Dimension dimension) {
  try {
    return parse_quantity(text, dimension);
  } catch (const InputError& error) {
    throw UsageError(std::string(option) + ": " + error.what());
  }
}

double duration_option(std::string_view option, const std::string& text) {
  const std::size_t dash = text.find('-', 1);
  if (text.find(':') == std::string::npos &&
      (dash == std::string::npos || !is_digits(text.substr(0, dash)))) {
    const bool minutes =
        text.size() > 1 && text.back() == 'm' &&
        std::string_view("0123456789. ").find(text[text.size() - 2]) != std::string_view::npos;
    return quantity_option(option, minutes ? text + "in" : text, Dimension::time);
  }
  const auto fail = [&] {
    return UsageError(std::string(option) + ": '" + text +
                      "' is none of D-HH:MM:SS, HH:MM:SS, MM:SS, D-HH:MM and D-HH");
  };
  const bool days = dash != std::string::npos;
  std::vector<double> numbers;
  std::istringstream parts(days ? text.substr(dash + 1) : text);
  for (std::string part; std::getline(parts, part, ':');) {
    // Only the first may be any number: the days, or the part before the minutes.
    const bool any = !days && numbers.empty();
    if (!is_digits(part) || part.size() > (any ? 6U : 2U)) throw fail();
    numbers.push_back(std::stod(part));
    if (!any && numbers.back() >= (days && numbers.size() == 1 ? 24 : 60)) throw fail();
  }
  if (text.back() == ':' || numbers.size() > 3 || numbers.size() < (days ? 1U : 2U)) throw fail();
  double seconds = 0;
  if (days) {
    if (!is_digits(text.substr(0, dash)) || dash > 6) throw fail();
    numbers.resize(3);
    seconds = 86400 * std::stod(text.substr(0, dash));
  }
  double unit = 1;
  for (std::size_t i = numbers.size(); i-- > 0; unit *= 60) seconds += unit * numbers[i];
  return seconds;
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
  constexpr int kLargestSensor = 65536;
  if (std::max({x, y, width, height}) > kLargestSensor)
    throw UsageError(std::string(option) + ": a sensor has at most 65536 pixels per side; '" +
                     text + "' lies outside");
  return {x, y, width, height};
}

template <class Number>
Number whole_number_option(std::string_view option, const std::string& text, Number least,
                           Number greatest) {
  const char* const end = text.data() + text.size();
  Number value{};
  const auto plain = std::from_chars(text.data(), end, value);
  bool good = plain.ec == std::errc() && plain.ptr == end;
  if (!good) {
    double real = 0;
    const auto scientific = std::from_chars(text.data(), end, real);
    // Whole numbers below 2^53 are exact in a double.
    good = scientific.ec == std::errc() && scientific.ptr == end && real >= 0 &&
           real < 9007199254740992.0 && real == std::floor(real) &&
           real <= static_cast<double>(std::numeric_limits<Number>::max());
    if (good) value = static_cast<Number>(real);
  }
  if (!good || value < least || value > greatest)
    throw UsageError(std::string(option) + " takes a whole number from " + std::to_string(least) +
                     " to " + std::to_string(greatest) + ", not '" + text + "'");
  return value;
}
template int whole_number_option(std::string_view, const std::string&, int, int);
template std::uint64_t whole_number_option(std::string_view, const std::string&, std::uint64_t,
                                           std::uint64_t);

std::array<int, 2> pair_option(std::string_view option, const std::string& text,
                               std::string_view form, char separator) {
  std::array<int, 2> values{};
  const char* const end = text.data() + text.size();
  const auto [middle, first] = std::from_chars(text.data(), end, values[0]);
  if (first == std::errc{} && middle != end && *middle == separator) {
    const auto [stop, second] = std::from_chars(middle + 1, end, values[1]);
    if (second == std::errc{} && stop == end) return values;
  }
  throw UsageError(std::string(option) + ": '" + text + "' is not of the form " +
                   std::string(form) + ": two whole numbers");
}

std::array<double, 3> point_option(std::string_view option, const std::string& text) {
  const std::size_t first = text.find(',');
  const std::size_t second = first == std::string::npos ? first : text.find(',', first + 1);
  if (second == std::string::npos)
    throw UsageError(std::string(option) + ": '" + text +
                     "' is not of the form X,Y,Z: three lengths");
  const auto part = [&](std::size_t begin, std::size_t end) {
    return quantity_option(option, text.substr(begin, end - begin), Dimension::length);
  };
  return {part(0, first), part(first + 1, second), part(second + 1, text.size())};
}

Box box_option(std::string_view option, const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos)
    throw UsageError(std::string(option) +
                     " must be two corners of a box, 'X,Y,Z:X,Y,Z' with units, not '" + text + "'");
  const auto a = point_option(option, text.substr(0, colon));
  const auto b = point_option(option, text.substr(colon + 1));
  const Box box{{std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2])},
                {std::max(a[0], b[0]), std::max(a[1], b[1]), std::max(a[2], b[2])}};
  if (box.lower.x == box.upper.x || box.lower.y == box.upper.y || box.lower.z == box.upper.z)
    throw UsageError(std::string(option) + ": the box '" + text + "' has no volume");
  return box;
}

std::string wrong_ending(const std::string& output, const std::vector<std::string>& endings) {
  std::string list;
  for (const std::string& ending : endings) {
    if (output.ends_with(ending)) return "";
    list += (list.empty() ? "" : ending == endings.back() ? " or " : ", ") + ending;
  }
  return "'" + output + "' must end in " + list;
}

void check_ending(std::string_view option, const std::string& output,
                  const std::vector<std::string>& endings) {
  if (const std::string wrong = wrong_ending(output, endings); !wrong.empty())
    throw UsageError(std::string(option) + ": " + wrong);
}

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  // Devices such as /dev/null lose nothing.
  if (fs::exists(a, ignored) && !fs::is_regular_file(a, ignored) && !fs::is_directory(a, ignored))
    return false;
  return resolved(a) == resolved(b) || fs::equivalent(a, b, ignored);
}

void check_not_overwritten(std::string_view option, const std::string& output,
                           const std::string& input) {
  if (is_same_file(output, input))
    throw UsageError(std::string(option) + ": '" + output +
                     "' is a file that this command reads; give another name");
}

double number_option(std::string_view option, const std::string& text, double least,
                     double greatest) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc() && stop == end && value >= least && value <= greatest) return value;
  std::ostringstream message;
  message.imbue(std::locale::classic());
  message << option << ": " << text << " is not a number from " << least << " to " << greatest;
  throw UsageError(message.str());
}

void check_choice(std::string_view option, const std::string& text,
                  const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) {
    if (word == text) return;
    if (!word.empty()) list.append(list.empty() ? "" : ", ").append(word);
  }
  const std::string nearest = nearest_name(text, words);
  throw UsageError(std::string(option) + ": '" + text + "' is not one of " + list +
                   (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
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

}  // namespace plenoflame
