#include "commands/calibration/calibration_options.h"
#include "commands/add_option.h"

#include <CLI/CLI.hpp>
#include <utility>

#include "commands/scene_input.h"
#include "commands/setting_options.h"
#include "messages.h"

namespace plenoflame::cli {

void add_camera_options(CLI::App& command, CalibrationArguments& arguments, const std::string& text,
                        bool required) {
  add_option(command, "--camera", arguments.camera, "CAMERA.toml", text)->required(required);
  add_option(command, "--which", arguments.which, "NAME",
             "Which of the file's cameras, where it has several");
}

void add_shared_options(CLI::App& command, CalibrationArguments& arguments,
                        CalibrationInput input) {
  if (input == CalibrationInput::pictures) add_settings<RawFileOptions>(command, arguments.files);
  add_set_option(command, arguments.set);
  if (input == CalibrationInput::pictures) add_threads_option(command, arguments.threads);
  command.add_flag("--json", arguments.json, "Print the figures as JSON");
}

void finish_calibration(CLI::App& command, const Registry& registry,
                        const std::shared_ptr<CalibrationArguments>& arguments,
                        CalibrationInput input, CalibrationAction action) {
  add_shared_options(command, *arguments, input);
  on_chosen(command, registry,
            [arguments, action = std::move(action)](const std::stop_token& stop) {
              static_cast<void>(arguments->files.layout());  // bad use is found before bad files
              Execution execution;
              execution.threads = arguments->threads;
              execution.stop = stop;
              execution.message = [](Severity, const std::string& text) { warn(text); };
              return action(execution);
            });
}

}  // namespace plenoflame::cli
