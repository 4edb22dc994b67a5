#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "commands/command.h"
#include "plenoflame/base/setting_names.h"

namespace plenoflame::cli {

/// The files that a command names as its inputs. If it names one file with a table of the command's
/// settings, these become its options, and the inputs are those of the table. Options of the
/// command line win. Call it while the argument is evaluated.
/// @param argument the positional one, "SCENES", whose key is "scenes" @param given receives the
/// settings that are used
/// @throws InputError with line and column; FileError; UsageError for such a file beside others
std::vector<std::string> inputs_or_settings(CLI::App& command, const std::string& argument,
                                            const std::vector<std::string>& files,
                                            std::vector<FileOption>& given);

/// The name of the table of a command's settings: "reconstruction".
std::string table_of(const CLI::App& command);

/// Adds the argument of a command that names one input, or several, or a file with such a table.
/// @param names how messages of the request name settings: as keys, if a file gives them
template <class Inputs>
void add_inputs(CLI::App& command, std::vector<FileOption>& given, const std::string& argument,
                Inputs& inputs, const std::string& help, SettingNames* names = nullptr) {
  const auto take = [&command, &given, argument, &inputs, names](const Inputs& files) {
    if constexpr (std::is_same_v<Inputs, std::string>)
      inputs = inputs_or_settings(command, argument, {files}, given).front();
    else
      inputs = inputs_or_settings(command, argument, files, given);
    if (names && !given.empty()) *names = {};
  };
  command
      .add_option_function<Inputs>(argument, take,
                                   help + "; or a file with a table [" + table_of(command) + "]")
      ->required();
}

/// Says where in a file the setting is that a message begins with. @throws InputError; it returns
/// if there is none
void throw_at_key(const std::vector<FileOption>& settings, const std::string& message);

}  // namespace plenoflame::cli
