#include "commands/command.h"

#include <CLI/CLI.hpp>
#include <sstream>
#include <utility>

#include "build_information.h"
#include "plenoflame/base/error.h"

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

CLI::App& add_missing(CLI::App& parent, const std::string& name, const std::string& part,
                      const std::string& description) {
  CLI::App& command = *parent.add_subcommand(
      name, description + " (needs " + part + ", which this build was made without)");
  command.allow_extras();
  command.prefix_command();
  const std::string full =
      parent.get_name() == "plenoflame" ? name : parent.get_name() + " " + name;
  command.final_callback([full, part] { throw UsageError(missing_part(full, part)); });
  return command;
}

void on_chosen(CLI::App& command, const Registry& registry, PlainAction action) {
  command.final_callback(
      [&target = registry.action, action = std::move(action)] { target.plain = action; });
}

void on_chosen(CLI::App& command, const Registry& registry, StoppableAction action) {
  command.final_callback(
      [&target = registry.action, action = std::move(action)] { target.stoppable = action; });
}

}  // namespace plenoflame::cli
