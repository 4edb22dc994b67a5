#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "plenoflame/base/error.h"
#include "settings.h"

namespace plenoflame::cli {

/// Adds the settings of a request as options, as their rows describe them.
/// @param request must live as long as the command
template <class Request>
void add_settings(CLI::App& command, Request& request) {
  for (const SettingRow<Request>& row : setting_rows<Request>()) {
    const std::string help = facts_of(row).help, name = kOptionNames(row.name);
    if (const auto* flag = std::get_if<bool Request::*>(&row.field)) {
      command.add_flag(name, request.**flag, help);
      continue;
    }
    const auto set = [&request, &row](const std::string& text) {
      try {
        set_row(row, kOptionNames, text, request);
      } catch (const UsageError& error) {
        throw CLI::ValidationError(error.what());  // with the hint to the help
      }
    };
    const auto* list = std::get_if<std::vector<std::string> Request::*>(&row.field);
    const auto set_all = [&request, &row, set](const std::vector<std::string>& texts) {
      if (const auto* places = std::get_if<std::vector<Vec3> Request::*>(&row.field))
        (request.**places).clear();
      for (const std::string& text : texts) set(text);
    };
    CLI::Option* const option =
        list ? command.add_option(name, request.**list, help)
                   ->allow_extra_args(row.form.ends_with("..."))
        : row.is_repeated()
            ? command.add_option_function<std::vector<std::string>>(name, set_all, help)
                  ->allow_extra_args(false)
            : command.add_option_function<std::string>(name, set, help);
    option->option_text(std::string(row.form))->required(row.required);
  }
}

}  // namespace plenoflame::cli
