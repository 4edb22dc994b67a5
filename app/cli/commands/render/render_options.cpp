#include "commands/render/render_options.h"
#include "commands/add_option.h"

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
  add_option(command, "-o,--output", options.output, "FILE",
             "Light field (.exr); without it, the file of --resume, or SCENE's name. Several "
             "cameras get one file each: OUT-NAME.exr")
      ->check(written())
      ->check([](const std::string& file) {
        return file.empty() ? std::string("the name of the file is empty") : std::string();
      });
  add_cameras_option(command, options.cameras);
  auto* const frames = add_option(command, "--frames", arguments.frames, "A:B[:STEP]",
                                  "Frames A to B, one file each: OUT.0007.exr; with --resume "
                                  "OUT.exr, finished frames are skipped");
  add_option(command, "--time", arguments.time, "TIME",
             "Time from the first frame to the exposure, e.g. 2.5ms; without --time and --frames, "
             "the first frame")
      ->excludes(frames);
  add_option(command, "--samples", arguments.samples, "N",
             "Rays per pixel and microlens (forward: energy bundles, default 1e6); an upper limit "
             "with --target-error or --time-limit");
  add_option(
      command, "--target-error", arguments.target_error, "SHARE",
      "Stop when the relative RMSE over lit pixels is below this (95 % confidence), e.g. 1%");
  add_option(command, "--time-limit", arguments.time_limit, "TIME",
             "Stop after this time, e.g. 60s, 5min");
  add_option(
      command, "--estimator", arguments.estimator, "NAME",
      "backward: from the sensor (quasi-Monte Carlo); forward: energy bundles from the flame, slow")
      ->check(one_of({"backward", "forward"}));
  add_threads_option(command, options.threads);
  add_option(command, "--seed", arguments.seed, "N", "Seed of the random numbers");
  add_option(command, "--window", arguments.window, "X,Y,W,H",
             "Render only W x H pixels of the sensor from column X, row Y: X,Y,W,H");
  add_part_option(command, arguments.part,
                  "Render only part K of N, into OUT-part-K-of-N.exr; 'plenoflame merge' joins "
                  "them to exactly the whole picture");
  add_option(command, "--checkpoint", arguments.checkpoint, "TIME",
             "Save the state of the run to OUT.exr.state at least this often, e.g. 5min (60s)");
  add_option(command, "--resume", options.resume, "FILE",
             "Continue the stopped run of this light field (.exr), or extend a complete one")
      ->check(continued());
  add_option(command, "--stats", options.stats, "FILE",
             "Write times, rays, error and skipped work to this file (.json)")
      ->check(written());
  add_option(command, "--compression", options.compression, "NAME",
             "Lossless compression: rle (quick), zip (some percent smaller), piz or none (rle)")
      ->check(one_of({"none", "rle", "zip", "piz"}));
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
  add_option(command, "--f-numbers", arguments.f_numbers, "LIST",
             "With --white: f-numbers such as 4,5.6,8, one file each (OUT-f4.exr)");
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
