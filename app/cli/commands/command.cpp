#include "commands/command.h"

#include <CLI/CLI.hpp>
#include <sstream>
#include <utility>

namespace plenoflame::cli {

CLI::App& add_command(const Registry& registry, const std::string& name,
                      const std::string& description, const std::string& example) {
  CLI::App& command = *registry.app.add_subcommand(name, description);
  std::istringstream lines(example);
  std::string footer = "Example:";
  for (std::string line; std::getline(lines, line);) footer += "\n  " + line;
  command.footer(footer);
  return command;
}

void on_chosen(CLI::App& command, const Registry& registry, Action action) {
  command.final_callback(
      [&target = registry.action, action = std::move(action)] { target = action; });
}

}  // namespace plenoflame::cli
