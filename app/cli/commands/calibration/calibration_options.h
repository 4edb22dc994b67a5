#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "commands/command.h"
#include "plenoflame/base/execution.h"
#include "raw_files.h"

namespace plenoflame::cli {

/// The arguments that all commands about a real camera have.
struct CalibrationArguments {
  std::string camera, which;
  std::vector<std::string> set;
  RawFileOptions files;
  int threads = 0;
  bool json = false;
};

/// --camera and --which. @param text help of --camera
void add_camera_options(CLI::App& command, CalibrationArguments& arguments, const std::string& text,
                        bool required = true);

enum class CalibrationInput { pictures, tables };

/// The end of a command's options: of pictures how raw files are read, and threads; --set, --json.
void add_shared_options(CLI::App& command, CalibrationArguments& arguments, CalibrationInput input);

using CalibrationAction = std::function<int(const Execution& execution)>;

/// The same, and the command's `action` with the requested threads. Signals end it.
void finish_calibration(CLI::App& command, const Registry& registry,
                        const std::shared_ptr<CalibrationArguments>& arguments,
                        CalibrationInput input, CalibrationAction action);

}  // namespace plenoflame::cli
