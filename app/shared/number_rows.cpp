#include "number_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "plenoflame/image/text_file.h"

namespace plenoflame {
namespace {

constexpr std::string_view kBlank = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// The fields between the commas of a line; `numbers`: all are numbers, `words`: none is one.
struct Cells {
  std::vector<double> values;
  bool numbers = true, words = true;
};

Cells cells_of(std::string_view line) {
  Cells cells;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t comma = std::min(line.find(',', at), line.size());
    const std::string_view word = trimmed(line.substr(at, comma - at));
    at = comma + 1;
    double value = 0;
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    const bool number = error == std::errc() && stop == end && std::isfinite(value);
    cells.numbers = cells.numbers && number;
    cells.words = cells.words && !word.empty() && stop == word.data();
    cells.values.push_back(value);
  }
  return cells;
}

}  // namespace

int NumberRow::whole(std::size_t column) const {
  const double value = values[column];
  if (value != std::floor(value) || std::fabs(value) > 1e8)
    throw InputError(at, fmt::format("{:g} is not a whole number", value));
  return static_cast<int>(value);
}

std::vector<NumberRow> read_number_rows(const std::string& path,
                                        std::initializer_list<std::size_t> counts,
                                        std::string_view what) {
  const std::string text = read_text_file(path);
  std::string_view rest = text;
  std::vector<NumberRow> rows;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    Cells cells = cells_of(line);
    const std::size_t count = cells.values.size();
    const bool wanted =
        rows.empty() ? std::ranges::count(counts, count) > 0 : rows.front().values.size() == count;
    if (cells.numbers && wanted)
      rows.push_back({{path, number}, std::move(cells.values)});
    else if (number > 1 || !cells.words)
      throw InputError(SourcePosition{path, number}, "this is not " + std::string(what));
  }
  if (rows.empty())
    throw InputError(SourcePosition{path}, "no line of the file is " + std::string(what));
  return rows;
}

}  // namespace plenoflame
