#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands/add_option.h"
#include "commands/calibration/calibration_options.h"
#include "commands/commands.h"
#include "commands/moment_options.h"
#include "commands/scene_input.h"
#include "commands/setting_options.h"
#include "commands/settings_file.h"
#include "file_set.h"
#include "messages.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "raw_pictures.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct ImportArguments : CalibrationArguments {
  RawPicturesRequest pictures;
  std::string output, interval;
};

/// Each file as a moment of its own. @param interval [s] between moments
int import_series(ImportArguments& arguments, const SceneDocument& camera, double interval,
                  const Execution& execution) {
  const std::vector<std::string> moments = files_of(arguments.pictures.raw);
  FileSet files;
  nlohmann::json list;
  for (std::size_t k = 0; k < moments.size(); ++k) {
    arguments.pictures.raw = {moments[k]};
    RawPictures found = import_pictures(arguments.pictures, camera, execution);
    const double time = static_cast<double>(k) * interval;
    found.light_field.numbers["import.time"] = time;
    const std::string name = with_frame(arguments.output, static_cast<int>(k));
    files.write(name, [&](const std::string& to) { write_light_field(to, found.light_field); });
    list.push_back({{"light_field", name}, {"time_s", time}});
  }
  files.commit();
  Report report;
  report.add("light fields",
             fmt::format("{}, {} to {}", moments.size(), with_frame(arguments.output, 0),
                         with_frame(arguments.output, static_cast<int>(moments.size()) - 1)),
             "light_fields", list);
  print(report, arguments.json);
  return kSuccess;
}

int run_import(ImportArguments& arguments) {
  check_writable(arguments.output);
  arguments.pictures.files = arguments.files;
  static_cast<void>(arguments.files.layout());  // bad use is found before bad files
  const SceneDocument camera =
      read_scene_of_camera(arguments.camera, arguments.set, arguments.which);
  Execution execution;
  execution.threads = arguments.threads;
  execution.message = [](Severity, const std::string& text) { warn(text); };
  if (!arguments.interval.empty()) {
    const double interval = quantity_option("--interval", arguments.interval, Dimension::time);
    if (!(interval > 0)) throw UsageError("--interval: above 0");
    return import_series(arguments, camera, interval, execution);
  }
  const RawPictures found = import_pictures(arguments.pictures, camera, execution);
  write_light_field(arguments.output, found.light_field);
  Report report;
  report.add("light field", arguments.output, "light_field", arguments.output);
  report.add_all(found.report);
  print(report, arguments.json);
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
  add_inputs(command, registry.action.file, "RAW", a->pictures.raw,
             "Frames of one scene, which are averaged, or their folder: .tif, .png, .pgm, .jpg, "
             "numbers without header (--size), arrays in .h5 or .mat (FILE:ARRAY; "
             "three grey frames are HxWx1x3), Lytro's .lfp, "
             ".lfr and .raw (not tried on a real file). NAME=FILE: a frame of that channel",
             &a->files.names);
  add_camera_options(command, *a, "Scene file with the camera and its channels");
  add_option(command, "-o,--output", a->output, "FIELD.exr", "Light field")
      ->check(written({".exr"}))
      ->required();
  add_option(command, "--interval", a->interval, "TIME",
             "Time between files that are moments: FIELD.0000.exr and so on, one for each file");
  add_settings<RawPicturesRequest>(command, a->pictures);
  add_shared_options(command, *a, CalibrationInput::pictures);
  on_chosen(command, registry, [a] { return run_import(*a); });
}

}  // namespace plenoflame::cli
