#include "help_formatter.h"

#include <sstream>

namespace plenoflame::cli {
namespace {

constexpr std::size_t kWidth = 96;
constexpr std::size_t kColumn = 26;

std::string entry(const std::string& name, const std::string& description) {
  std::string text = "  " + name;
  std::size_t used = text.size();
  if (used + 2 > kColumn) {
    text += '\n';
    used = 0;
  }
  text.append(kColumn - used, ' ');
  used = kColumn;
  std::istringstream words(description);
  bool first = true;
  for (std::string word; words >> word; first = false) {
    if (!first && used + 1 + word.size() > kWidth) {
      text += '\n';
      text.append(kColumn, ' ');
      used = kColumn;
    } else if (!first) {
      text += ' ';
      ++used;
    }
    text += word;
    used += word.size();
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
  if (!is_positional) name += make_option_opts(option);
  return entry(name, make_option_desc(option));
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  if (!option->get_option_text().empty()) return " " + option->get_option_text();
  return option->get_expected_max() == 0 ? "" : " VALUE";
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  return entry(command->get_name(), command->get_description());
}

}  // namespace plenoflame::cli
