#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "board_calibration.h"
#include "commands/add_option.h"
#include "commands/calibration/calibrate.h"
#include "commands/calibration/calibration_options.h"
#include "commands/scene_input.h"
#include "commands/setting_options.h"
#include "file_set.h"
#include "outputs.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/png_file.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct BoardArguments : CalibrationArguments {
  BoardRequest request;
  std::string output, picture;
};

/// The pictures, as they were taken, with a cross at each corner that was found.
PngImage corner_picture(const Image& light, const BoardCorners& found) {
  PngImage picture;
  picture.width = light.width;
  picture.height = light.height;
  picture.channels = 3;
  picture.samples.assign(picture.sample_count(), 0);
  const double high = std::max(high_level(light), 1e-30);
  for (std::size_t i = 0; i < light.pixels.size(); ++i) {
    const double value = static_cast<double>(light.pixels[i]) / high;
    const int grey = static_cast<int>(230 * std::sqrt(std::clamp(value, 0.0, 1.0)) + 0.5);
    for (std::size_t c = 0; c < 3; ++c)
      picture.samples[3 * i + c] = static_cast<std::uint16_t>(std::isfinite(value) ? grey : 0);
  }
  for (const BoardCorner& corner : found.corners)
    for (int k = -3; k <= 3; ++k)
      for (const bool along : {false, true}) {
        const int x = static_cast<int>(corner.pixel.x) + (along ? k : 0),
                  y = static_cast<int>(corner.pixel.y) + (along ? 0 : k);
        if (x < 0 || y < 0 || x >= light.width || y >= light.height) continue;
        const auto at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(light.width) +
                             static_cast<std::size_t>(x));
        // The colour tells columns and rows that are even from the others.
        picture.samples[at] = 255;
        picture.samples[at + 1] = (corner.column + corner.row) % 2 == 0 ? 60 : 160;
        picture.samples[at + 2] = corner.row % 2 == 0 ? 0 : 90;
      }
  return picture;
}

int run_corners_of_boards(BoardArguments& a, const Execution& execution) {
  check_writable(a.output);
  if (!a.picture.empty()) check_writable(a.picture);
  a.request.files = a.files;
  const BoardCalibration found =
      calibrate_corners(a.request, read_camera_scene(a.camera, a.set, a.which), execution);
  FileSet files;
  files.write(a.output, [&](const std::string& name) { write_file(name, found.corners); });
  if (!a.picture.empty())
    files.write(a.picture, [&](const std::string& name) {
      write_png(name, corner_picture(found.light, found.found));
    });
  files.commit();
  print(found.report, a.json);
  return kSuccess;
}

}  // namespace

void add_calibrate_corners(CLI::App& calibrate, const Registry& registry) {
  auto a = std::make_shared<BoardArguments>();
  CLI::App& command = *calibrate.add_subcommand(
      "corners", "The corners of checkerboards, or dots, in the micro-images of raw pictures");
  command.footer(
      "Example:\n"
      "  plenoflame calibrate corners board-*.tif --camera camera.toml --board 9x6 --cell 5mm \\\n"
      "    --white white.tif -o corners.csv --picture seen.png");
  command
      .add_option("BOARD", a->request.boards,
                  "Raw pictures of one board, each in a pose of its own, counted from 0")
      ->required();
  add_camera_options(command, *a, "The camera, as found by calibrate white");
  add_option(command, "-o,--output", a->output, "FILE.csv", "Table for calibrate geometry (.csv)")
      ->check(written({".csv"}))
      ->required();
  add_option(command, "--picture", a->picture, "FILE",
             "The first board with what was found in it (.png)")
      ->check(written({".png"}));
  add_settings<BoardRequest>(command, a->request);
  finish_calibration(
      command, registry, a, CalibrationInput::pictures,
      [a](const Execution& execution) { return run_corners_of_boards(*a, execution); });
}

}  // namespace plenoflame::cli
