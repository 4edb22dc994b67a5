#include "scene/files/time_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/image/text_file.h"
#include "scene/schema/nearest.h"

namespace plenoflame {
namespace {

struct Cell {
  std::string_view text;
  int column = 1;  ///< in its line, of its first character
};

struct Column {
  std::string name;
  Dimension dimension = Dimension::none;
  std::string unit;
};

constexpr std::string_view kBlank = " \t\r";

Cell trimmed(std::string_view line, std::size_t begin, std::size_t end) {
  const std::string_view part = line.substr(begin, end - begin);
  const auto first = part.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {{}, static_cast<int>(begin) + 1};
  const auto last = part.find_last_not_of(kBlank);
  return {part.substr(first, last - first + 1), static_cast<int>(begin + first) + 1};
}

std::vector<Cell> cells_of(std::string_view line, char separator) {
  std::vector<Cell> cells;
  for (std::size_t at = 0;;) {
    const std::size_t end = std::min(line.find(separator, at), line.size());
    cells.push_back(trimmed(line, at, end));
    if (end == line.size()) return cells;
    at = end + 1;
  }
}

char separator_of(std::string_view line) {
  for (const char c : {';', '\t'})
    if (line.find(c) != std::string_view::npos) return c;
  return ',';
}

/// The dimension of a column of this name; nothing for a name that no column has.
std::optional<Dimension> dimension_of(std::string_view name) {
  if (name == "time") return Dimension::time;
  if (name == "x" || name == "y" || name == "z") return Dimension::length;
  if (name == "scale" || name == "brightness") return Dimension::none;
  return std::nullopt;
}

/// "x [mm]", "x (mm)", "x_mm" -> x and mm.
Column split(std::string_view text) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const auto begin = text.find(open);
    if (begin == std::string_view::npos || text.back() != close) continue;
    return {std::string(trimmed(text, 0, begin).text), Dimension::none,
            std::string(trimmed(text, begin + 1, text.size() - 1).text)};
  }
  const auto underscore = text.rfind('_');
  if (underscore == std::string_view::npos) return {std::string(text), Dimension::none, ""};
  return {std::string(text.substr(0, underscore)), Dimension::none,
          std::string(text.substr(underscore + 1))};
}

Column read_column(const Cell& cell, const SourcePosition& here) {
  Column column = cell.text.empty() ? Column{} : split(cell.text);
  std::transform(column.name.begin(), column.name.end(), column.name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::optional<Dimension> known = dimension_of(column.name);
  if (!known)
    throw InputError(here, "unknown column " + quote_for_message(std::string(cell.text)) +
                               "; a table has a header with time [ms] and any of x [mm], y [mm], "
                               "z [mm], scale, brightness");
  column.dimension = *known;
  const auto units = accepted_units(column.dimension);
  std::string list;
  for (const std::string& unit : units) list.append(list.empty() ? "" : ", ").append(unit);
  if (column.dimension == Dimension::none) {
    if (column.unit == "1") column.unit.clear();
    if (!column.unit.empty())
      throw InputError(here, "column " + quote_for_message(column.name) + " is a pure number");
  } else if (std::find(units.begin(), units.end(), column.unit) == units.end()) {
    throw InputError(
        here,
        column.unit.empty()
            ? fmt::format("column {} needs a unit ({}), such as \"{} [{}]\"",
                          quote_for_message(column.name), list, column.name, units[1])
            : fmt::format("column {} has the unit {}; it must be one of {}",
                          quote_for_message(column.name), quote_for_message(column.unit), list));
  }
  return column;
}

std::vector<Column> read_header(const std::vector<Cell>& cells, SourcePosition here) {
  std::vector<Column> columns;
  const int line = here.line;
  for (const Cell& cell : cells) {
    here = {here.file, line, cell.column};
    Column column = read_column(cell, here);
    for (const Column& other : columns)
      if (other.name == column.name)
        throw InputError(here, "column " + quote_for_message(column.name) + " is there twice");
    columns.push_back(std::move(column));
  }
  here.column = 0;
  if (columns.front().name != "time")
    throw InputError(here, "the first column must be the time, such as \"time [ms]\"");
  if (columns.size() < 2)
    throw InputError(
        here,
        "the time is the only column; add any of x [mm], y [mm], z [mm], scale and brightness");
  return columns;
}

double read_number(const Cell& cell, const Column& column, const SourcePosition& here) {
  double plain = 0;
  const char* const end = cell.text.data() + cell.text.size();
  const auto [stop, error] = std::from_chars(cell.text.data(), end, plain);
  if (error != std::errc() || stop != end || !std::isfinite(plain))
    throw InputError(here,
                     fmt::format("{} is {}; it must be a finite number", column.name,
                                 cell.text.empty() ? std::string("missing")
                                                   : quote_for_message(std::string(cell.text))));
  // By the decimal text, so that 0.1 ms is the same number as in a scene file.
  const double value =
      parse_quantity(fmt::format("{}{}{}", cell.text, column.unit.empty() ? "" : " ", column.unit),
                     column.dimension);
  if (column.name == "scale" && !(value > 0 && value <= 1e9))
    throw InputError(here, fmt::format("scale is {:g}; above 0 and at most 1e9 is allowed", value));
  if (column.name == "brightness" && !(value >= 0 && value <= 1e12))
    throw InputError(here, fmt::format("brightness is {:g}; 0 to 1e12 is allowed", value));
  if (column.dimension == Dimension::length && !(std::fabs(value) <= 1e6))
    throw InputError(
        here, fmt::format("{} is {:g} m; -1000 km to 1000 km is allowed", column.name, value));
  return value;
}

}  // namespace

TimeTable::TimeTable(const std::string& path) {
  const std::string text = read_text_file(path);
  std::vector<Column> columns;
  char separator = ',';
  int number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line(text.data() + at, end - at);
    at = end + 1;
    ++number;
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(kBlank) == std::string_view::npos) continue;
    const SourcePosition here{path, number};
    if (columns.empty()) {
      separator = separator_of(line);
      columns = read_header(cells_of(line, separator), here);
      continue;
    }
    const std::vector<Cell> cells = cells_of(line, separator);
    if (cells.size() != columns.size())
      throw InputError(here, fmt::format("the row has {} cells, and the header {}", cells.size(),
                                         columns.size()));
    std::vector<double> row;
    for (std::size_t i = 0; i < cells.size(); ++i)
      row.push_back(read_number(cells[i], columns[i], {path, number, cells[i].column}));
    if (!times_.empty() && !(row.front() > times_.back()))
      throw InputError(SourcePosition{path, number, cells.front().column},
                       fmt::format("the times must increase, but {} follows {}",
                                   readable_quantity(row.front(), Dimension::time),
                                   readable_quantity(times_.back(), Dimension::time)));
    times_.push_back(row.front());
    values_.emplace_back(row.begin() + 1, row.end());
  }
  if (columns.empty())
    throw InputError(SourcePosition{path},
                     "the table is empty; its first line names the columns, such as \"time [ms], x "
                     "[mm], brightness\"");
  if (times_.empty()) throw InputError(SourcePosition{path}, "the table has no rows");
  for (std::size_t i = 1; i < columns.size(); ++i) columns_.push_back(columns[i].name);
}

FlameSpec TimeTable::at(double time, FlameSpec flame) const {
  const auto above = std::upper_bound(times_.begin(), times_.end(), time);
  std::size_t before =
      above == times_.begin() ? 0 : static_cast<std::size_t>(above - times_.begin()) - 1;
  const std::size_t after = std::min(before + 1, times_.size() - 1);
  double share = 0;
  if (after > before && time > times_[before])
    share = std::min(1.0, (time - times_[before]) / (times_[after] - times_[before]));
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const double a = values_[before][c], b = values_[after][c];
    const double value = a == b ? a : (1 - share) * a + share * b;
    if (columns_[c] == "x") flame.position.x = value;
    if (columns_[c] == "y") flame.position.y = value;
    if (columns_[c] == "z") flame.position.z = value;
    if (columns_[c] == "scale") flame.scale = value;
    if (columns_[c] == "brightness") flame.brightness = value;
  }
  return flame;
}

}  // namespace plenoflame
