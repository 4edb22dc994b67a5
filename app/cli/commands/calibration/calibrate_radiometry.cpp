#include <CLI/CLI.hpp>
#include <memory>

#include "commands/add_option.h"
#include "commands/calibration/calibrate.h"
#include "commands/calibration/calibration_options.h"
#include "commands/scene_input.h"
#include "commands/setting_options.h"
#include "outputs.h"
#include "plenoflame/image/atomic_file.h"
#include "radiometry_calibration.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct RadiometryArguments : CalibrationArguments {
  RadiometryRequest request;
  std::string output;
};

int run_radiometry(RadiometryArguments& arguments, const Execution& execution) {
  check_writable(arguments.output);
  arguments.request.files = arguments.files;
  const SceneDocument camera =
      read_scene_of_camera(arguments.camera, arguments.set, arguments.which);
  RadiometryCalibration found = calibrate_radiometry(arguments.request, camera, execution);
  write_file(arguments.output, radiometry_text(found.table));
  found.report.add("written", arguments.output, "output", arguments.output);
  print(found.report, arguments.json);
  return kSuccess;
}

}  // namespace

void add_calibrate_radiometry(CLI::App& calibrate, const Registry& registry) {
  auto a = std::make_shared<RadiometryArguments>();
  CLI::App& command = *calibrate.add_subcommand(
      "radiometry", "What a count stands for, from pictures of a blackbody");
  command.footer(
      "Example:\n"
      "  plenoflame calibrate radiometry \"1500 K=a.tif\" \"1700 "
      "K=b.tif\" --dark d.tif\n"
      "    --camera camera.toml --temperature-error \"2 K\" -o "
      "radiometry.toml");
  command
      .add_option("SOURCE", a->request.sources,
                  "TEMPERATURE=FILE, or TEMPERATURE@TIME=FILE with an exposure "
                  "of its own: pictures of "
                  "a blackbody; files of the same label are averaged")
      ->required();
  add_camera_options(command, *a, "Scene file with the camera and its channels");
  add_option(command, "-o,--output", a->output, "FILE.toml", "For import --radiometry")
      ->check(written({".toml"}))
      ->required();
  add_settings<RadiometryRequest>(command, a->request);
  finish_calibration(command, registry, a, CalibrationInput::pictures,
                     [a](const Execution& execution) { return run_radiometry(*a, execution); });
}

}  // namespace plenoflame::cli
