#include <CLI/CLI.hpp>
#include <memory>

#include "choice.h"
#include "commands/calibration/import_run.h"
#include "commands/commands.h"
#include "outputs.h"

namespace plenoflame::cli {

void register_import(const Registry& registry) {
  auto a = std::make_shared<ImportArguments>();
  CLI::App& command = add_command(
      registry, "import", "Make a light field of a real camera's pictures",
      "plenoflame import flame-*.tif --camera camera.toml --dark dark-*.tif -o flame.exr\n"
      "plenoflame import 650nm=a.png 700nm=b.png --camera camera.toml --unit W -o flame.exr");
  command
      .add_option(
          "RAW", a->raw,
          "Frames of one scene, which are averaged: .tif, .png, .pgm, .jpg, or numbers without "
          "header (--size). NAME=FILE: a frame of that channel")
      ->required();
  add_camera_options(command, *a, "Scene file with the camera and its channels");
  command.add_option("-o,--output", a->output, "Light field")
      ->check(written())
      ->required()
      ->option_text("FIELD.exr");
  command
      .add_option("--channel", a->channel, "Channel of a grey picture, where the file has several")
      ->option_text("NAME");
  command
      .add_option("--unit", a->unit,
                  "What pixels hold: e- (electrons), W, or DN, counts above dark (e-; with "
                  "--radiometry W)")
      ->check(one_of({"e-", "W", "DN"}))
      ->option_text("UNIT");
  const auto frames = [&](const char* name, std::vector<std::string>& to, const char* text) {
    command.add_option(name, to, text)->option_text("FILE ...");
  };
  frames("--dark", a->dark,
         "Dark frames of the same exposure; NAME=FILE: of that channel alone, as in the options "
         "below");
  frames("--flat", a->flat, "Flat field: the bare sensor, evenly lit");
  frames("--flat-dark", a->flat_dark, "Its dark frames (those of --dark)");
  frames("--white", a->white,
         "White picture through the whole camera: pixels become what the camera's model would have "
         "recorded");
  frames("--white-dark", a->white_dark, "Its dark frames (those of --dark)");
  command
      .add_option(
          "--defects", a->defects,
          "Defective pixels: a picture in which they are not 0, lines column,row (.csv), or "
          "'auto': those that shine in the dark frames")
      ->option_text("MAP");
  command.add_option("--gain", a->gain, "Electrons per count (of the camera's file)")
      ->option_text("NUMBER");
  command.add_option("--read-noise", a->read_noise, "Electrons (of the camera's file)")
      ->option_text("NUMBER");
  command
      .add_option("--black-level", a->black_level,
                  "Counts without light, where there is no dark frame (of the camera's file)")
      ->option_text("COUNTS");
  command
      .add_option("--exposure-time", a->exposure_time,
                  "Of a frame (of the camera's file); NAME=TIME: of that channel's; repeatable")
      ->option_text("TIME")
      ->allow_extra_args(false);
  command
      .add_option("--saturation", a->saturation,
                  "Counts from which on a pixel is full (full well, or the largest number)")
      ->option_text("COUNTS");
  command
      .add_option("--noise", a->noise,
                  "Errors from gain and read noise (sensor), from scatter against light in a "
                  "series (series), or from each pixel's scatter (pixel)")
      ->check(one_of({"sensor", "series", "pixel"}))
      ->option_text("SOURCE");
  command
      .add_option("--radiometry", a->radiometry,
                  "Energy of a count, from calibrate radiometry; repeatable for several channels")
      ->option_text("FILE.toml")
      ->allow_extra_args(false);
  command.add_option("--window", a->window, "Part of the sensor that the pictures hold (all)")
      ->option_text("X,Y,W,H");
  add_shared_options(command, *a, CalibrationInput::pictures);
  on_chosen(command, registry, [a] { return run_import(*a); });
}

}  // namespace plenoflame::cli
