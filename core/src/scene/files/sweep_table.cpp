#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "plenoflame/scene/sweep.h"
#include "scene/schema/nearest.h"

namespace plenoflame {
namespace {

struct TableCell {
  std::string text;
  int column = 1;  ///< in its line, of its first character
};

constexpr std::string_view kWhite = " \t\r";

std::string without_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(kWhite);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(kWhite) - first + 1));
}

/// The cells of a line; those in double quotes may hold separators, and "" for a quote (RFC 4180).
std::vector<TableCell> split_line(std::string_view line, char separator, SourcePosition here) {
  std::vector<TableCell> cells;
  for (std::size_t at = 0;;) {
    std::size_t begin = std::min(line.find_first_not_of(" \r", at), line.size());
    TableCell cell;
    cell.column = static_cast<int>(begin) + 1;
    if (begin < line.size() && line[begin] == '"') {
      for (++begin;; ++begin) {
        if (begin >= line.size()) {
          here.column = cell.column;
          throw InputError(here, "a quote is not closed on this line");
        }
        if (line[begin] == '"' && (begin + 1 >= line.size() || line[begin + 1] != '"')) break;
        if (line[begin] == '"') ++begin;
        cell.text += line[begin];
      }
      at = std::min(line.find(separator, begin), line.size());
      if (!without_blanks(line.substr(begin + 1, at - begin - 1)).empty()) {
        here.column = static_cast<int>(begin) + 2;
        throw InputError(here, "a separator must follow the closing quote");
      }
    } else {
      at = std::min(line.find(separator, begin), line.size());
      cell.text = without_blanks(line.substr(begin, at - begin));
    }
    cells.push_back(std::move(cell));
    if (at == line.size()) return cells;
    ++at;
  }
}

/// The separator of a header, whose keys hold none.
char header_separator(std::string_view line) {
  for (const char c : {';', '\t'})
    if (line.find(c) != std::string_view::npos) return c;
  return ',';
}

struct TableColumn {
  std::string key, unit;
};

/// "KEY [mm]" -> KEY and mm; the brackets of "flames[0]" follow without a blank.
TableColumn column_of(const TableCell& cell) {
  const auto open = cell.text.rfind(" [");
  if (open == std::string::npos || cell.text.back() != ']') return {cell.text, ""};
  return {
      without_blanks(std::string_view(cell.text).substr(0, open)),
      without_blanks(std::string_view(cell.text).substr(open + 2, cell.text.size() - open - 3))};
}

/// "1, 2" in mm -> "1 mm, 2 mm".
std::string with_unit(const std::string& text, const std::string& unit) {
  if (unit.empty()) return text;
  std::string all;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    all += fmt::format("{}{} {}", all.empty() ? "" : ", ",
                       without_blanks(std::string_view(text).substr(at, comma - at)), unit);
    at = comma + 1;
  }
  return all;
}

}  // namespace

std::vector<SweepRun> read_sweep_table(std::string_view text, const std::string& name) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a mark of UTF-8
  std::vector<TableColumn> columns;
  std::vector<SweepRun> runs;
  char separator = ',';
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto first = line.find_first_not_of(kWhite);
    if (first == std::string_view::npos || line[first] == '#') continue;
    if (columns.empty()) separator = header_separator(line);
    const std::vector<TableCell> cells = split_line(line, separator, {name, number});
    if (columns.empty()) {
      for (const TableCell& cell : cells) {
        const SourcePosition here{name, number, cell.column};
        if (cell.text.empty())
          throw InputError(here, "the header of a column is not a key of the scene");
        columns.push_back(column_of(cell));
        for (std::size_t i = 0; i + 1 < columns.size(); ++i)
          if (columns[i].key == columns.back().key)
            throw InputError(here, quote_for_message(columns.back().key) + " is there twice");
      }
      continue;
    }
    if (cells.size() != columns.size())
      throw InputError(
          SourcePosition{name, number},
          fmt::format("this row has {} cells, and the header has {}; a cell with commas stands in "
                      "double quotes",
                      cells.size(), columns.size()));
    SweepRun run;
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (!cells[i].text.empty())
        run.push_back({columns[i].key,
                       with_unit(cells[i].text, columns[i].unit),
                       {name, number, cells[i].column}});
    if (run.empty()) run.push_back({"", "", {name, number, 1}});
    if (runs.size() == static_cast<std::size_t>(kMostRuns))
      throw InputError(SourcePosition{name, number},
                       fmt::format("there are more than {} rows", kMostRuns));
    runs.push_back(std::move(run));
  }
  if (columns.empty())
    throw InputError(SourcePosition{name}, "the table has no header with keys of the scene");
  if (runs.empty())
    throw InputError(SourcePosition{name},
                     "the table has no rows below the header; each row is a run");
  return runs;
}

}  // namespace plenoflame
