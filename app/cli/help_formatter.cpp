#include "help_formatter.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "terminal.h"

namespace plenoflame::cli {
namespace {

constexpr std::size_t kNarrowest = 48, kWidest = 96;
constexpr std::size_t kColumn = 26;

/// The columns that the text may take: those of the terminal, up to kWidest; where it goes
/// elsewhere those that COLUMNS says, or 80.
std::size_t text_width() {
  std::size_t columns = output_columns();
  if (columns == 0) {
    // Nothing in this process changes the environment.
    const char* const wanted = std::getenv("COLUMNS");  // NOLINT(concurrency-mt-unsafe)
    columns = wanted ? std::strtoul(wanted, nullptr, 10) : 0;
    if (columns == 0) columns = 80;
  }
  return std::clamp(columns, kNarrowest, kWidest);
}

/// A line of a command, broken with backslashes between words where it is too wide.
std::string wrapped_command(const std::string& line) {
  const std::size_t width = text_width();
  std::string result, word;
  std::size_t used = 2;
  char quote = 0;
  const auto take = [&] {
    if (used > 2 && used + word.size() + 3 > width) {
      result += " \\\n      ";
      used = 6;
    } else if (used > 2) {
      result += ' ';
      ++used;
    }
    result += word;
    used += word.size();
    word.clear();
  };
  for (const char c : line.substr(std::min<std::size_t>(2, line.size()))) {
    if (quote == 0 && c == ' ')
      take();
    else
      word += c;
    if (c == quote)
      quote = 0;
    else if (quote == 0 && (c == '\'' || c == '"'))
      quote = c;
  }
  take();
  return "  " + result;
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
    append_wrapped(text, line, begin, begin, text_width());
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

std::string HelpFormatter::make_description(const CLI::App* command) const {
  std::string text;
  append_wrapped(text, command->get_description(), 0, 0, text_width());
  return text + '\n';
}

std::string HelpFormatter::make_usage(const CLI::App* command, std::string name) const {
  std::string text = CLI::Formatter::make_usage(command, std::move(name)), wrapped;
  text.pop_back();  // the line's end
  append_wrapped(wrapped, text, 0, 7, text_width());
  return wrapped + '\n';
}

std::string HelpFormatter::make_footer(const CLI::App* command) const {
  std::string text;
  std::istringstream lines(CLI::Formatter::make_footer(command));
  for (std::string line; std::getline(lines, line);)
    text += (line.starts_with("  ") ? wrapped_command(line) : line) + '\n';
  return text;
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  return entry(command->get_name(), command->get_description());
}

}  // namespace plenoflame::cli
