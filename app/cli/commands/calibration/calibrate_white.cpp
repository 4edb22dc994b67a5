#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "commands/add_option.h"
#include "commands/calibration/calibrate.h"
#include "commands/calibration/calibration_options.h"
#include "commands/calibration/white_picture.h"
#include "commands/scene_input.h"
#include "commands/setting_options.h"
#include "file_set.h"
#include "messages.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/png_file.h"
#include "run.h"
#include "terminal.h"
#include "white_calibration.h"

namespace plenoflame::cli {
namespace {

struct WhiteArguments : CalibrationArguments {
  WhiteRequest request;
  std::string output, centres, radii, picture;
};

void check_outputs_of(const WhiteArguments& a) {
  if (!a.output.empty() && a.camera.empty() && a.request.pixel_pitch.empty())
    throw UsageError(
        "-o: the array's lengths take the size of a pixel: give "
        "--camera or --pixel-pitch");
  if (a.output.empty() && a.centres.empty() && a.radii.empty() && a.picture.empty() && !a.json)
    warn("nothing is written: -o, --centres, --radii and --picture name files");
  for (const std::string* file : {&a.output, &a.centres, &a.radii, &a.picture})
    if (!file->empty()) check_writable(*file);
}

int run_white(WhiteArguments& a, const Execution& execution) {
  check_outputs_of(a);
  a.request.files = a.files;
  std::optional<SceneDocument> camera;
  if (!a.camera.empty()) camera = read_scene_of_camera(a.camera, a.set, a.which);
  const WhiteSeen seen = [&](const Image& white) -> std::string {
    if (a.picture.empty()) return "";
    write_png(a.picture, white_picture(white, nullptr));
    return "; the picture as it was seen is in " + a.picture;
  };
  WhiteCalibration found = calibrate_white(a.request, camera ? &*camera : nullptr, execution, seen);
  if (!a.radii.empty() && found.radii.empty())
    throw UsageError(
        "--radii: give white pictures at two f-numbers or more "
        "(4=FILE 8=FILE)");
  if (!a.picture.empty() && found.white.empty()) throw UsageError("--picture: centres have none");
  FileSet files;
  const auto write_text = [&](const std::string& path, const std::string& text) {
    if (!path.empty()) files.write(path, [&](const std::string& name) { write_file(name, text); });
  };
  write_text(a.output, found.camera);
  write_text(a.centres, found.centres);
  write_text(a.radii, found.radii);
  if (!a.picture.empty())
    files.write(a.picture, [&](const std::string& name) {
      write_png(name, white_picture(found.white, &found.lattice));
    });
  files.commit();
  if (!a.output.empty()) found.report.add("camera", a.output, "output", a.output);
  print(found.report, a.json);
  return kSuccess;
}

}  // namespace

void add_calibrate_white(CLI::App& calibrate, const Registry& registry) {
  auto a = std::make_shared<WhiteArguments>();
  CLI::App& command = *calibrate.add_subcommand(
      "white", "The microlens array from white pictures: lattice, centres, types");
  command.footer(
      "Example:\n"
      "  plenoflame calibrate white white.tif --camera nominal.toml "
      "-o camera.toml\n"
      "  plenoflame calibrate white 4=w4.png 8=w8.png --centres "
      "centres.csv --picture seen.png");
  command
      .add_option("WHITE", a->request.white,
                  "White pictures, averaged. N=FILE: one at f/N. Or centres "
                  "that another program "
                  "found: a .csv of column,row, pixel (0, 0) having its centre "
                  "at 0.5, 0.5")
      ->required();
  add_camera_options(command, *a, "Scene file with what is known of the camera", false);
  add_option(command, "-o,--output", a->output, "FILE.toml",
             "Scene file with the array; without --camera its keys alone")
      ->check(written({".toml"}));
  add_option(command, "--centres", a->centres, "FILE", "Table of all micro-images (.csv)")
      ->check(written());
  add_option(command, "--radii", a->radii, "FILE",
             "Table of the micro-images' radii at each f-number (.csv), for calibrate geometry")
      ->check(written());
  add_option(command, "--picture", a->picture, "FILE",
             "Parts of the white picture with what was found in it (.png)")
      ->check(written({".png"}));
  add_settings<WhiteRequest>(command, a->request);
  finish_calibration(command, registry, a, CalibrationInput::pictures,
                     [a](const Execution& execution) { return run_white(*a, execution); });
}

}  // namespace plenoflame::cli
