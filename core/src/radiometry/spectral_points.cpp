// Reading curves over wavelength.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/image/text_file.h"
#include "plenoflame/radiometry/filter_points.h"

namespace plenoflame {
namespace {

constexpr double kFirstAllowed = 10e-9, kLastAllowed = 1e-3;  // [m]

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

bool to_number(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

/// The fault of one more point; empty: it has none.
std::string trouble(const std::vector<SpectralPoint>& before, const SpectralPoint& point) {
  if (!(point.wavelength >= kFirstAllowed && point.wavelength <= kLastAllowed))
    return fmt::format("the wavelength {} is not between 10 nm and 1 mm",
                       readable_quantity(point.wavelength, Dimension::length));
  if (!before.empty() && !(point.wavelength > before.back().wavelength))
    return fmt::format("the wavelengths must ascend, and {} follows {}",
                       readable_quantity(point.wavelength, Dimension::length, 6),
                       readable_quantity(before.back().wavelength, Dimension::length, 6));
  if (!(point.value >= 0))
    return fmt::format("the value {:g} at {} is negative", point.value,
                       readable_quantity(point.wavelength, Dimension::length));
  return {};
}

std::string trouble_as_a_whole(const std::vector<SpectralPoint>& points) {
  if (points.size() < 2) return "a curve needs at least two points";
  if (is_opaque(points)) return "a curve needs a value above 0";
  return {};
}

/// A unit of length in a header such as "wavelength [nm]"; 0: none.
double unit_in(std::string_view header) {
  const std::string_view column = header.substr(0, header.find_first_of(",;\t"));
  const auto ends_word = [&](std::size_t at) {
    return at >= column.size() || !std::isalpha(static_cast<unsigned char>(column[at]));
  };
  for (const auto& [name, metres] : {std::pair<std::string_view, double>{"nm", 1e-9},
                                     {"um", 1e-6},
                                     {"\xc2\xb5m", 1e-6},
                                     {"\xce\xbcm", 1e-6},
                                     {"mm", 1e-3},
                                     {"m", 1}}) {
    for (std::size_t at = column.find(name); at != std::string_view::npos;
         at = column.find(name, at + 1)) {
      // A unit of its own: not the end of a word, nor behind a letter of another alphabet (micro).
      const auto before = static_cast<unsigned char>(at > 0 ? column[at - 1] : ' ');
      const bool begins = !std::isalpha(before) && before < 0x80;
      if (begins && ends_word(at + name.size())) return metres;
    }
  }
  return 0;
}

std::string_view name_of(double metres) {
  return metres == 1e-9 ? "nm" : metres == 1e-6 ? "um" : metres == 1e-3 ? "mm" : "m";
}

/// The unit in which numbers of this size are wavelengths of near ultraviolet to near infrared.
double likely_unit(double number) {
  for (const double unit : {1e-9, 1e-6, 1.0})
    if (number * unit >= 150e-9 && number * unit <= 3e-6) return unit;
  return 0;
}

}  // namespace

bool is_opaque(const std::vector<SpectralPoint>& points) {
  return std::none_of(points.begin(), points.end(), [](const auto& p) { return p.value > 0; });
}

namespace {

/// Each point by itself, and after those before it.
std::vector<SpectralPoint> parse_points(std::string_view text) {
  std::vector<SpectralPoint> points;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const std::string_view item = trimmed(text.substr(at, comma - at));
    at = comma + 1;
    if (item.empty() && comma == text.size() && !points.empty()) break;
    const auto blank = item.find_last_of(" \t");
    SpectralPoint point;
    if (blank == std::string_view::npos || !to_number(item.substr(blank + 1), point.value))
      throw InputError(fmt::format(
          "\"{}\" is not a point of a curve; write a wavelength with its unit and a value, like "
          "\"450 nm 0.2\"",
          item));
    point.wavelength = parse_quantity(trimmed(item.substr(0, blank)), Dimension::length);
    if (const std::string wrong = trouble(points, point); !wrong.empty()) throw InputError(wrong);
    points.push_back(point);
  }
  return points;
}

}  // namespace

std::vector<SpectralPoint> parse_spectral_points(std::string_view text) {
  std::vector<SpectralPoint> points = parse_points(text);
  if (const std::string wrong = trouble_as_a_whole(points); !wrong.empty()) throw InputError(wrong);
  return points;
}

std::vector<SpectralPoint> parse_filter_points(std::string_view text) {
  std::vector<SpectralPoint> points = parse_points(text);
  for (const SpectralPoint& point : points)
    if (point.value > 1) throw InputError("a filter lets at most everything through, 1");
  if (points.size() < 2) throw InputError(trouble_as_a_whole(points));
  return points;
}

std::string format_spectral_points(const std::vector<SpectralPoint>& points) {
  std::string text;
  for (const SpectralPoint& point : points)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ",
                        format_quantity(point.wavelength, Dimension::length), point.value);
  return text;
}

std::vector<SpectralPoint> read_spectral_csv(const std::string& path) {
  const std::string text = read_text_file(path);
  std::vector<SpectralPoint> points;
  double unit = 1e-9;
  bool stated = false;
  int number = 0;
  // Spreadsheets begin UTF-8 files with a mark.
  for (std::size_t at = text.starts_with("\xef\xbb\xbf") ? 3 : 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line(text.data() + at, end - at);
    at = end + 1;
    ++number;
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    const SourcePosition here{path, number};
    const auto comma = line.find_first_of(",;\t");
    double wavelength = 0;
    SpectralPoint point;
    const bool good = comma != std::string_view::npos &&
                      to_number(trimmed(line.substr(0, comma)), wavelength) &&
                      to_number(trimmed(line.substr(comma + 1)), point.value);
    if (!good && points.empty() && !stated) {
      if (const double found = unit_in(line); found > 0) unit = found;
      stated = true;
      continue;
    }
    if (!good)
      throw InputError(here, "this is not a point of a curve: two numbers, wavelength and value");
    // By the decimal text, so that 645 nm is 645 nm.
    point.wavelength = parse_quantity(
        fmt::format("{} {}", trimmed(line.substr(0, comma)), name_of(unit)), Dimension::length);
    const double likely = likely_unit(wavelength);
    if (!(point.wavelength >= 100e-9 && point.wavelength <= 100e-6) && likely > 0 && likely != unit)
      throw InputError(
          here, fmt::format("the wavelength {:g} is in {}, it seems, and not in {}; name the unit "
                            "in the header, like \"wavelength_{},response\"",
                            wavelength, name_of(likely), name_of(unit), name_of(likely)));
    if (const std::string wrong = trouble(points, point); !wrong.empty())
      throw InputError(here, wrong);
    points.push_back(point);
  }
  if (const std::string wrong = trouble_as_a_whole(points); !wrong.empty())
    throw InputError(SourcePosition{path}, wrong);
  return points;
}

}  // namespace plenoflame
