#include "commands/settings_file.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <optional>

#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/settings_file.h"

namespace plenoflame::cli {
namespace {

namespace fs = std::filesystem;

/// The settings of a file; nothing: it is another kind of file.
std::optional<std::vector<FileSetting>> settings_in(const std::string& file,
                                                    const std::string& table) {
  std::error_code ignored;
  if (!file.ends_with(".toml") || !fs::is_regular_file(file, ignored)) return std::nullopt;
  std::optional<std::vector<FileSetting>> settings = read_settings(file, table);
  constexpr std::array kTables{"reconstruction", "operator", "sweep", "import"};
  for (const char* other : kTables)
    if (!settings && other != table && read_settings(file, other))
      throw InputError(SourcePosition{file},
                       "a table [" + table + "] is needed here, not [" + other + "]");
  return settings;
}

/// The options of a command by their keys: --absorption-error is absorption_error.
std::map<std::string, CLI::Option*> options_by_key(CLI::App& command) {
  std::map<std::string, CLI::Option*> options;
  for (CLI::Option* option : command.get_options({})) {
    if (option == command.get_help_ptr()) continue;
    std::string key = option->get_lnames().empty() ? CLI::detail::to_lower(option->get_name())
                                                   : option->get_lnames().front();
    std::ranges::replace(key, '-', '_');
    options.emplace(std::move(key), option);
  }
  return options;
}

/// Gives an option the values of a setting, and evaluates it. @throws InputError, UsageError
void set_option(CLI::Option& option, const FileSetting& setting,
                const std::vector<std::string>& values) {
  option.clear();
  if (option.get_items_expected_max() == 0 && values != std::vector<std::string>{"true"} &&
      values != std::vector<std::string>{"false"})
    throw InputError(setting.position,
                     setting.key + ": true or false, not '" + CLI::detail::join(values, ",") + "'");
  if (option.get_items_expected_max() > 1)
    option.add_result(values);
  else
    option.add_result(CLI::detail::join(values, ","));
  try {
    option.run_callback();
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
}

bool takes_files(const CLI::Option& option) {
  const std::string form = option.get_option_text();
  const auto dot = form.find('.');
  return form.starts_with("FILE") || form == "DIR" ||
         (dot != std::string::npos && dot + 1 < form.size() &&
          std::islower(static_cast<unsigned char>(form[dot + 1])) != 0);
}

/// Gives the value of an option, FILE or LABEL=FILE, with the name of the file from the folder of
/// the settings.
std::string in_folder(const fs::path& folder, CLI::Option& option, const std::string& value) {
  std::error_code error;
  if (value.empty() || (value == "auto" && option.get_option_text().ends_with("|auto")))
    return value;
  const auto equals = value.find('=');
  if (equals == std::string::npos || is_output(option) || fs::exists(folder / value, error))
    return (folder / value).string();
  return value.substr(0, equals + 1) + (folder / value.substr(equals + 1)).string();
}

/// The setting with all names of its option, one of which a message about it begins with:
/// "--absorption-error", "-o", "absorption_error".
FileOption file_option(const CLI::Option& option, const FileSetting& setting) {
  FileOption given{setting.position, setting.key, {setting.key}};
  for (const std::string& name : option.get_lnames()) given.names.push_back("--" + name);
  for (const std::string& name : option.get_snames()) given.names.push_back("-" + name);
  return given;
}

}  // namespace

std::string table_of(const CLI::App& command) {
  return command.get_name() == "reconstruct" ? "reconstruction" : command.get_name();
}

std::vector<std::string> inputs_or_settings(CLI::App& command, const std::string& argument,
                                            const std::vector<std::string>& files,
                                            std::vector<FileOption>& given) {
  const std::string table = table_of(command);
  std::optional<std::vector<FileSetting>> settings;
  for (const std::string& file : files)
    if ((settings = settings_in(file, table))) break;
  if (!settings) return files;
  if (files.size() > 1)
    throw UsageError("of [" + table + "] one file is given, without further files");
  const fs::path folder = fs::path(files.front()).parent_path();
  const std::map<std::string, CLI::Option*> options = options_by_key(command);
  CLI::Option* const named = command.get_option(argument);
  named->clear();
  for (const FileSetting& setting : *settings) {
    const auto found = options.find(setting.key);
    if (found == options.end()) {
      std::vector<std::string> keys;
      for (const auto& [key, option] : options) keys.push_back(key);
      const std::string nearest = nearest_name(setting.key, keys);
      throw InputError(setting.position,
                       "unknown key \"" + setting.key + "\" of [" + table + "]" +
                           (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
    }
    CLI::Option& option = *found->second;
    std::vector<std::string> values = setting.values;
    if (&option == named || takes_files(option))
      for (std::string& path : values) path = in_folder(folder, option, path);
    if (&option == named &&
        values.size() > static_cast<std::size_t>(named->get_items_expected_max()))
      throw InputError(setting.position, setting.key + ": one, not several");
    if (&option == named)
      named->add_result(values);
    else if (option.count() == 0) {
      given.push_back(file_option(option, setting));
      set_option(option, setting, values);
    }
  }
  if (named->count() == 0)
    throw InputError(SourcePosition{files.front()},
                     "[" + table + "] has no key \"" + CLI::detail::to_lower(argument) + "\"");
  return named->results();
}

void throw_at_key(const std::vector<FileOption>& settings, const std::string& message) {
  for (const FileOption& setting : settings)
    for (const std::string& name : setting.names) {
      if (!message.starts_with(name)) continue;
      const std::string rest = message.substr(name.size());
      if (rest.empty() || (std::isalnum(static_cast<unsigned char>(rest[0])) == 0 &&
                           rest[0] != '-' && rest[0] != '_'))
        throw InputError(setting.position, setting.key + rest);
    }
}

}  // namespace plenoflame::cli
