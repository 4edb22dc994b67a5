#include "commands/render/render_options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "choice.h"
#include "commands/part_option.h"
#include "commands/scene_input.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/render/render_request.h"

namespace plenoflame::cli {
namespace {

bool has_extension(const std::string& path, const char* extension) {
  return std::filesystem::path(path).extension() == extension;
}

}  // namespace

void add_render_options(CLI::App& command, RenderArguments& arguments) {
  RenderOptions& options = arguments.options;
  command.add_option("SCENE", options.scene,
                     "Scene file (.toml); without it, --resume uses the scene of its run");
  add_set_option(command, options.set);
  command
      .add_option("-o,--output", options.output,
                  "Light field (.exr); without it, the file of --resume, or SCENE's name. Several "
                  "cameras get one file each: OUT-NAME.exr")
      ->check(written())
      ->check([](const std::string& file) {
        return file.empty() ? std::string("the name of the file is empty") : std::string();
      })
      ->option_text("FILE");
  add_cameras_option(command, options.cameras);
  auto* const frames = command
                           .add_option("--frames", arguments.frames,
                                       "Frames A to B, one file each: OUT.0007.exr; with --resume "
                                       "OUT.exr, finished frames are skipped")
                           ->option_text("A:B[:STEP]");
  command
      .add_option("--time", arguments.time,
                  "Time from the first frame to the exposure, e.g. 2.5ms; without --time and "
                  "--frames, the first frame")
      ->excludes(frames)
      ->option_text("TIME");
  command
      .add_option("--samples", arguments.samples,
                  "Rays per pixel and microlens (forward: energy bundles, default 1e6); an upper "
                  "limit with --target-error or --time-limit")
      ->option_text("N");
  command
      .add_option(
          "--target-error", arguments.target_error,
          "Stop when the relative RMSE over lit pixels is below this (95 % confidence), e.g. 1%")
      ->option_text("SHARE");
  command.add_option("--time-limit", arguments.time_limit, "Stop after this time, e.g. 60s, 5min")
      ->option_text("TIME");
  command
      .add_option("--estimator", arguments.estimator,
                  "backward: from the sensor (quasi-Monte Carlo); forward: energy bundles from the "
                  "flame, slow")
      ->check(one_of({"backward", "forward"}))
      ->option_text("NAME");
  command.add_option("--threads", options.threads, "Worker threads; 0: one per processor (0)")
      ->check(CLI::Range(0, 4096))
      ->option_text("N");
  command.add_option("--seed", arguments.seed, "Seed of the random numbers")->option_text("N");
  command
      .add_option("--window", arguments.window,
                  "Render only W x H pixels of the sensor from column X, row Y: X,Y,W,H")
      ->option_text("X,Y,W,H");
  add_part_option(command, arguments.part,
                  "Render only part K of N, into OUT-part-K-of-N.exr; 'plenoflame merge' joins "
                  "them to exactly the whole picture");
  command
      .add_option("--checkpoint", arguments.checkpoint,
                  "Save the state of the run to OUT.exr.state at least this often, e.g. 5min (60s)")
      ->option_text("TIME");
  command
      .add_option("--resume", options.resume,
                  "Continue the stopped run of this light field (.exr), or extend a complete one")
      ->check(continued())
      ->option_text("FILE");
  command
      .add_option("--stats", options.stats,
                  "Write times, rays, error and skipped work to this file (.json)")
      ->check(written())
      ->option_text("FILE");
  command
      .add_option(
          "--compression", options.compression,
          "Lossless compression: rle (quick), zip (some percent smaller), piz or none (rle)")
      ->check(one_of({"none", "rle", "zip", "piz"}))
      ->option_text("NAME");
  command.add_flag("--truth", options.truth,
                   "Add layers of ground truth along each pixel's chief ray: optical depth, "
                   "distances, temperature, solid surface");
  command.add_flag(
      "--no-skip{false}", options.skip,
      "Follow all rays and steps, also those that cannot change the picture (for comparison)");
  command.add_flag(
      "--no-control-variate{false}", options.control_variate,
      "Integrate every ray through a grid, without the table of radiance (for comparison)");
  command.add_flag("--white", options.white,
                   "White image: 1 W/(m^2 sr) from all directions in place of the flames");
  command
      .add_option("--f-numbers", arguments.f_numbers,
                  "With --white: f-numbers such as 4,5.6,8, one file each (OUT-f4.exr)")
      ->option_text("LIST");
  command.add_flag("--quiet", options.quiet, "No progress and no notes; warnings remain");
  command.add_flag("--json", options.json, "Print the figures as JSON");
}

namespace {

std::vector<double> f_number_list(const std::string& text) {
  std::vector<double> numbers;
  std::stringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const double number = quantity_option("--f-numbers", word, Dimension::none);
    if (!(number > 0) || !std::isfinite(number))
      throw UsageError("--f-numbers: '" + word + "' is not an f-number");
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace

RenderOptions checked_options(const RenderArguments& arguments) {
  RenderOptions options = arguments.options;
  if (options.scene.empty() && options.resume.empty())
    throw UsageError(
        "SCENE is required, unless --resume FILE is given (see plenoflame render --help)");
  if (options.scene.empty() && !options.set.empty())
    throw UsageError("--set needs SCENE: a resumed run keeps its scene");
  // A continued run writes to its own file.
  if (options.output.empty()) options.output = options.resume;
  options.output_given = !options.output.empty();
  if (!options.output_given)
    options.output = std::filesystem::path(options.scene).stem().string() + ".exr";
  if (!has_extension(options.output, ".exr"))
    throw UsageError("--output: '" + options.output +
                     "' must end in .exr; 'plenoflame develop' makes a picture of it");
  check_not_overwritten("--output", options.output, options.scene);  // a name that was not given
  if (!options.stats.empty()) check_not_overwritten("--stats", options.stats, options.output);
  if (!arguments.samples.empty())
    options.samples = whole_number_option("--samples", arguments.samples, 1, 1 << 30);
  if (!arguments.seed.empty())
    options.seed = whole_number_option<std::uint64_t>("--seed", arguments.seed, 0);
  if (!arguments.target_error.empty()) {
    const double target =
        quantity_option("--target-error", arguments.target_error, Dimension::none);
    if (!(target > 0 && target < 1))
      throw UsageError("--target-error must be a share above 0 % and below 100 %, e.g. 1%, not '" +
                       arguments.target_error + "'");
    options.target_error = target;
  }
  if (!arguments.time_limit.empty()) {
    const double limit = duration_option("--time-limit", arguments.time_limit);
    if (!(limit > 0))
      throw UsageError("--time-limit must be a time above 0 s, e.g. 60s, not '" +
                       arguments.time_limit + "'");
    options.time_limit = limit;
  }
  if (!arguments.checkpoint.empty()) {
    const double interval = duration_option("--checkpoint", arguments.checkpoint);
    if (!(interval > 0))
      throw UsageError("--checkpoint must be a time above 0 s, e.g. 5min, not '" +
                       arguments.checkpoint + "'");
    options.checkpoint = interval;
  }
  if (!arguments.estimator.empty())
    options.estimator = arguments.estimator == "forward" ? Estimator::forward : Estimator::backward;
  if (!arguments.window.empty()) options.window = window_option("--window", arguments.window);
  if (!arguments.part.empty()) options.part = part_option("--part", arguments.part);
  if (options.part && (options.target_error || options.time_limit))
    throw UsageError(
        "--part cannot be used with --target-error or --time-limit, which apply to the whole "
        "picture; give --samples");
  if (!arguments.f_numbers.empty()) {
    options.f_numbers = f_number_list(arguments.f_numbers);
    if (!options.white) throw UsageError("--f-numbers needs --white");
    if (!options.resume.empty())
      throw UsageError(
          "--f-numbers cannot be used with --resume, which continues one file at a time");
  }
  if (!arguments.frames.empty()) options.frames = frame_range_option("--frames", arguments.frames);
  if (!arguments.time.empty()) options.time = time_option("--time", arguments.time);
  if (options.frames || options.time) {
    const char* const name = options.frames ? "--frames" : "--time";
    if (options.white)
      throw UsageError(std::string(name) +
                       " cannot be used with --white, whose image has no flames");
    if (options.scene.empty()) throw UsageError(std::string(name) + " needs SCENE");
    if (options.frames && !options.resume.empty() && options.output != options.resume)
      throw UsageError("--frames: --resume must name the file of --output, without a frame number");
  }
  if (options.white && options.estimator == Estimator::forward)
    throw UsageError("--white needs the backward estimator: bundles have no place to start from");
  return options;
}

ExrCompression exr_compression(const std::string& name) {
  if (name == "none") return ExrCompression::none;
  if (name == "zip") return ExrCompression::zip;
  return name == "piz" ? ExrCompression::piz : ExrCompression::rle;
}

std::string state_path(const std::string& light_field) {
  return light_field + ".state";
}

void check_files(const RenderOptions& options) {
  check_writable(options.output);
  if (!options.stats.empty()) check_writable(options.stats);
}

void check_window(const RenderOptions& options, const SensorSpec& sensor) {
  if (!options.window) return;
  const PixelWindow& window = *options.window;
  if (window.x > sensor.columns - window.width || window.y > sensor.rows - window.height)
    throw UsageError("--window reaches beyond the sensor of " + std::to_string(sensor.columns) +
                     " x " + std::to_string(sensor.rows) + " pixels");
}

RenderSettings render_settings_of(const RenderOptions& options, const Scene& scene) {
  RenderSettings settings = render_settings(
      scene,
      {options.estimator, options.samples, options.target_error, options.time_limit, options.seed});
  if (options.window) settings.window = *options.window;
  if (options.part) settings.part = *options.part;
  settings.skip = options.skip;
  settings.control_variate = options.control_variate;
  return settings;
}

}  // namespace plenoflame::cli
