#include "outputs.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/input_files.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWritten = "written";
constexpr const char* kContinued = "continued";

CLI::Validator mark(const char* name) {
  return {[](std::string&) { return std::string(); }, "", name};
}

bool is_marked(CLI::Option& option, const char* name) {
  try {
    option.get_validator(name);
    return true;
  } catch (const CLI::OptionNotFound&) {
    return false;
  }
}

/// The files that a scene names, without those of flames: `reconstruct` does not read them, and
/// other commands write none.
std::vector<std::string> files_of_scene(const std::string& path) {
  std::vector<std::string> files;
  try {
    Scene scene = read_scene_file(path).scene;
    scene.flames.clear();
    for (const InputFile& file : input_files(scene))
      files.push_back((fs::path(path).parent_path() / file.name).string());
  } catch (const Error&) {
    // The command itself says what is wrong with it.
  }
  return files;
}

/// The files that an option's values name: "a.tif", "650nm=a.tif", "camera.toml=poses.csv".
std::vector<std::string> files_of(const CLI::Option& option) {
  std::vector<std::string> files;
  std::error_code error;
  for (const std::string& value : option.results()) {
    const auto equals = std::min(value.find('='), value.size());
    for (const std::string& part :
         {value, value.substr(0, equals), value.substr(std::min(equals + 1, value.size()))})
      if (fs::is_regular_file(part, error) ||
          (option.get_positional() && fs::is_directory(part, error)))
        files.push_back(part);
  }
  return files;
}

struct Output {
  std::string option, path;
  CLI::Validator ending;
};

}  // namespace

CLI::Validator written(std::vector<std::string> endings) {
  const auto check = [endings = std::move(endings)](const std::string& name) {
    return endings.empty() ? std::string() : wrong_ending(name, endings);
  };
  return CLI::Validator(check, "", kWritten).active(false);  // check_outputs() asks it
}

bool is_output(CLI::Option& option) {
  return is_marked(option, kWritten);
}

CLI::Validator continued() {
  return mark(kContinued);
}

void check_outputs(CLI::App& app) {
  if (const std::vector<CLI::App*> chosen = app.get_subcommands(); !chosen.empty())
    return check_outputs(*chosen.front());
  std::vector<Output> outputs;
  std::vector<std::string> inputs;
  for (CLI::Option* const option : app.get_options({})) {
    if (is_output(*option)) {
      for (const std::string& path : option->results())
        if (!path.empty() || option->get_required())
          outputs.push_back({option->get_name(), path, *option->get_validator(kWritten)});
    } else if (!is_marked(*option, kContinued)) {
      for (const std::string& file : files_of(*option)) inputs.push_back(file);
    }
  }
  if (outputs.empty()) return;
  for (std::size_t i = 0, named = inputs.size(); i < named; ++i)
    if (inputs[i].ends_with(".toml"))
      for (const std::string& file : files_of_scene(inputs[i])) inputs.push_back(file);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto& [option, path, ending] = outputs[i];
    for (const std::string& input : inputs) check_not_overwritten(option, path, input);
    for (std::size_t k = 0; k < i; ++k)
      if (is_same_file(path, outputs[k].path))
        throw UsageError(option +
                         (option == outputs[k].option
                              ? " names the same file twice, '"
                              : " and " + outputs[k].option + " are the same file, '") +
                         path + "'; give each a name of its own");
  }
  for (auto& [option, path, ending] : outputs)
    if (const std::string wrong = ending.active(true)(path); !wrong.empty())
      throw UsageError(option + ": " + wrong);
}

}  // namespace plenoflame::cli
