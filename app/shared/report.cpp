#include "report.h"

#include <algorithm>
#include <iostream>

#include "plenoflame/base/printable.h"
#include "terminal.h"

namespace plenoflame {

void Report::add(const std::string& label, const std::string& text, const std::string& key,
                 nlohmann::json value) {
  add_text(label, text);
  add_json(key, std::move(value));
}

void Report::add_text(const std::string& label, const std::string& text) {
  lines_.emplace_back(label, text);
}

void Report::add_all(const Report& other) {
  lines_.insert(lines_.end(), other.lines_.begin(), other.lines_.end());
  json_.update(other.json_);
}

void Report::add_json(const std::string& key, nlohmann::json value) {
  json_[key] = std::move(value);
}

std::string Report::json_text() const {
  // File names need not be UTF-8: what is not is replaced, not thrown about.
  return printable(json_.dump(2, ' ', false, nlohmann::json::error_handler_t::replace), true) +
         '\n';
}

void Report::print(bool as_json) const {
  if (as_json) {
    std::cout << json_text();
    return;
  }
  std::vector<std::pair<std::string, std::string>> lines;
  std::size_t width = 0;
  for (const auto& [label, text] : lines_) {
    lines.emplace_back(printable(label), printable(text));
    width = std::max(width, lines.back().first.size());
  }
  const std::size_t columns = output_columns();
  const std::size_t begin = width + 2 <= columns / 2 ? width + 2 : 4;
  for (const auto& [label, text] : lines) {
    std::string line = label + ':' + std::string(width - label.size() + 1, ' ');
    if (columns > 0)
      append_wrapped(line, text, line.size(), begin, columns);
    else
      line += text;
    std::cout << line << '\n';
  }
}

}  // namespace plenoflame
