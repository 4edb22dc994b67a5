#include "terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <sstream>
#include <utility>
#include <vector>

#include "plenoflame/base/printable.h"

namespace plenoflame {

std::size_t output_columns() {
  if (isatty(STDOUT_FILENO) != 1) return 0;
  winsize size{};
  // A terminal of unknown width has 0 columns: it may stand between mpirun and a file.
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

void append_wrapped(std::string& text, const std::string& line, std::size_t used, std::size_t begin,
                    std::size_t width) {
  std::size_t at = 0;
  while (at < line.size()) {
    const std::size_t word = line.find_first_not_of(' ', at);
    if (word == std::string::npos) break;
    const std::size_t end = std::min(line.find(' ', word), line.size());
    if (at > 0 && used + end - at > width) {
      text.append("\n").append(begin, ' ');
      used = begin;
    } else {
      text.append(line, at, word - at);
      used += word - at;
    }
    text.append(line, word, end - word);
    used += end - word;
    at = end;
  }
}

std::string fitting(const std::string& text) {
  const std::size_t columns = output_columns();
  if (columns == 0) return text;
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line); result += '\n')
    append_wrapped(result, line, 0, 4, columns);
  return result;
}

void print(const Report& report, bool as_json) {
  if (as_json) {
    std::cout << report.json_text();
    return;
  }
  std::vector<std::pair<std::string, std::string>> lines;
  std::size_t width = 0;
  for (const auto& [label, text] : report.lines()) {
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
