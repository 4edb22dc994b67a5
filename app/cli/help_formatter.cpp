#include "help_formatter.h"

#include <algorithm>
#include <sstream>

namespace plenoflame::cli {
namespace {

constexpr std::size_t kWidth = 96;
constexpr std::size_t kColumn = 26;

/// Appends a line, broken between words, of which the first stands at column `begin`. Runs of
/// blanks stay as they are: columns of a list.
void append_wrapped(std::string& text, const std::string& line, std::size_t begin) {
  std::size_t used = begin, at = 0;
  while (at < line.size()) {
    const std::size_t word = line.find_first_not_of(' ', at);
    if (word == std::string::npos) break;
    const std::size_t end = std::min(line.find(' ', word), line.size());
    if (at > 0 && used + end - at > kWidth) {
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

std::string entry(const std::string& name, const std::string& description) {
  std::string text = "  " + name;
  std::size_t used = text.size();
  if (used + 2 > kColumn) {
    text += '\n';
    used = 0;
  }
  text.append(kColumn - used, ' ');
  used = kColumn;
  std::istringstream lines(description);
  std::size_t begin = kColumn;  // where the lines of a list begin
  for (std::string line; std::getline(lines, line); begin = kColumn + 2) {
    if (begin > kColumn) text.append("\n").append(begin, ' ');
    append_wrapped(text, line, begin);
  }
  text += '\n';
  return text;
}

}  // namespace

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  // "-o,--output FILE" reads better with a blank after the comma.
  std::string name = make_option_name(option, is_positional);
  for (std::size_t comma = name.find(','); comma != std::string::npos;
       comma = name.find(',', comma + 1))
    name.insert(comma + 1, " ");
  // A flag that sets a value is declared as "--no-skip{false}"; the value is not to be typed.
  for (std::size_t brace = name.find('{'); brace != std::string::npos; brace = name.find('{'))
    name.erase(brace, name.find('}', brace) + 1 - brace);
  if (!is_positional) name += make_option_opts(option);
  std::string description = make_option_desc(option);
  if (!option->get_default_str().empty()) description += " (" + option->get_default_str() + ")";
  return entry(name, description);
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  if (!option->get_option_text().empty()) return " " + option->get_option_text();
  return option->get_expected_max() == 0 ? "" : " VALUE";
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  return entry(command->get_name(), command->get_description());
}

}  // namespace plenoflame::cli
