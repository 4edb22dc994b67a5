#include <CLI/CLI.hpp>
#include <memory>

#include "commands/calibration/calibration_options.h"
#include "commands/commands.h"
#include "commands/reconstruct/setting_options.h"
#include "commands/scene_input.h"
#include "messages.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/image/atomic_file.h"
#include "raw_pictures.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

struct ImportArguments : CalibrationArguments {
  RawPicturesRequest pictures;
  std::string output;
};

int run_import(ImportArguments& arguments) {
  check_ending("-o", arguments.output, {".exr"});
  check_writable(arguments.output);
  arguments.pictures.files = arguments.files;
  static_cast<void>(arguments.files.layout());  // bad use is found before bad files
  const SceneDocument camera =
      read_scene_of_camera(arguments.camera, arguments.set, arguments.which);
  Execution execution;
  execution.threads = arguments.threads;
  execution.message = [](Severity, const std::string& text) { warn(text); };
  const RawPictures found = import_pictures(arguments.pictures, camera, execution);
  write_light_field(arguments.output, found.light_field);
  Report report;
  report.add("light field", arguments.output, "light_field", arguments.output);
  report.add_all(found.report);
  report.print(arguments.json);
  return kSuccess;
}

}  // namespace

void register_import(const Registry& registry) {
  auto a = std::make_shared<ImportArguments>();
  CLI::App& command =
      add_command(registry, "import", "Make a light field of a real camera's pictures",
                  "plenoflame import flame-*.tif --camera camera.toml --dark dark-*.tif -o "
                  "flame.exr\n"
                  "plenoflame import 650nm=a.png 700nm=b.png --camera camera.toml --unit W "
                  "-o flame.exr");
  command
      .add_option("RAW", a->pictures.raw,
                  "Frames of one scene, which are averaged: .tif, .png, .pgm, "
                  ".jpg, or numbers without "
                  "header (--size). NAME=FILE: a frame of that channel")
      ->required();
  add_camera_options(command, *a, "Scene file with the camera and its channels");
  command.add_option("-o,--output", a->output, "Light field")
      ->check(written())
      ->required()
      ->option_text("FIELD.exr");
  add_settings<RawPicturesRequest>(command, a->pictures);
  add_shared_options(command, *a, CalibrationInput::pictures);
  on_chosen(command, registry, [a] { return run_import(*a); });
}

}  // namespace plenoflame::cli
