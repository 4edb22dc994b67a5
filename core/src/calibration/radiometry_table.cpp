#include "plenoflame/calibration/radiometry_table.h"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <cmath>
#include <sstream>

#include "plenoflame/base/error.h"
#include "plenoflame/base/printable.h"
#include "plenoflame/image/text_file.h"

namespace plenoflame {
namespace {

SourcePosition position_in(const std::string& path, const toml::source_region& region) {
  return {path, static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

struct Range {
  double least, greatest;
};

double number_in(const toml::table& table, const char* key, double otherwise, Range range,
                 const std::string& path) {
  const toml::node* node = table.get(key);
  if (node == nullptr) {
    if (std::isfinite(otherwise)) return otherwise;
    throw InputError(position_in(path, table.source()), std::string(key) + " is missing");
  }
  const auto value = node->value<double>();
  if (!value || !(*value >= range.least && *value <= range.greatest))
    throw InputError(
        position_in(path, node->source()),
        fmt::format("{} must be a number from {:g} to {:g}", key, range.least, range.greatest));
  return *value;
}

bool flag_in(const toml::table& table, const char* key, const std::string& path) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return false;
  if (!node->is_boolean())
    throw InputError(position_in(path, node->source()), std::string(key) + " is true or false");
  return node->value_or(false);
}

}  // namespace

RadiometryTable read_radiometry(const std::string& path) {
  toml::table root;
  try {
    root = toml::parse(read_text_file(path), path);
  } catch (const toml::parse_error& error) {
    throw InputError(position_in(path, error.source()), printable(error.description()));
  }
  constexpr double kNeeded = std::numeric_limits<double>::quiet_NaN();
  constexpr Range kPixels{1, 65536}, kErrors{0, 10};
  // A count has some 1e-19 J for each electron, and a sensor bends by a share of its 65535 counts.
  constexpr Range kJoules{1e-30, 1}, kCurvatures{-0.1, 0.1};
  RadiometryTable table;
  table.columns = static_cast<int>(number_in(root, "columns", kNeeded, kPixels, path));
  table.rows = static_cast<int>(number_in(root, "rows", kNeeded, kPixels, path));
  const toml::array* channels = root["channels"].as_array();
  if (channels == nullptr || channels->empty())
    throw InputError(
        "'" + path +
        "' is no radiometric calibration: it has no [[channels]] (written by calibrate "
        "radiometry)");
  for (const toml::node& node : *channels) {
    const toml::table* entry = node.as_table();
    if (entry == nullptr)
      throw InputError(position_in(path, node.source()), "a channel is a table [[channels]]");
    ChannelScale scale;
    const auto name = (*entry)["name"].value<std::string>();
    if (!name) throw InputError(position_in(path, entry->source()), "a channel needs its name");
    scale.channel = *name;
    scale.joules_per_count = number_in(*entry, "joules_per_count", kNeeded, kJoules, path);
    scale.relative_error = number_in(*entry, "relative_error", 0, kErrors, path);
    scale.curvature = number_in(*entry, "curvature", 0, kCurvatures, path);
    scale.curvature_error = number_in(*entry, "curvature_error", 0, kErrors, path);
    scale.white = flag_in(*entry, "white", path);
    scale.flat = flag_in(*entry, "flat", path);
    table.channels.push_back(scale);
  }
  return table;
}

std::string radiometry_text(const RadiometryTable& table) {
  std::ostringstream out;
  out << "# The flux that a count stands for, from a radiometric calibration. Imports of pictures "
         "read it.\n"
      << fmt::format("columns = {}\nrows = {}\n", table.columns, table.rows);
  for (const ChannelScale& scale : table.channels) {
    std::string name;
    for (const char c : printable(scale.channel))
      name += (c == '"' || c == '\\' ? std::string("\\") : std::string()) + c;
    out << fmt::format(
        "\n[[channels]]\nname = \"{}\"\n"
        "joules_per_count = {:.9e}  # radiant energy on a pixel for a count above dark\n"
        "relative_error = {:.3e}  # standard error, common to all pixels\n"
        "curvature = {:.6e}  # a linear sensor would have counted c (1 + curvature c)\n"
        "curvature_error = {:.3e}\n"
        "white = {}  # evened out by a white picture\n"
        "flat = {}  # evened out by a flat field\n",
        name, scale.joules_per_count, scale.relative_error, scale.curvature, scale.curvature_error,
        scale.white, scale.flat);
  }
  return out.str();
}

const ChannelScale& scale_of(const RadiometryTable& table, const std::string& channel,
                             const std::string& path) {
  std::string names;
  for (const ChannelScale& scale : table.channels) {
    if (scale.channel == channel) return scale;
    names += (names.empty() ? "" : ", ") + scale.channel;
  }
  throw InputError("'" + path + "' has no scale of channel " + channel + "; it has " + names);
}

}  // namespace plenoflame
