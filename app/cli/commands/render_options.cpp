#include "commands/render_options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/light_field.h"

namespace plenoflame::cli {
namespace {

bool has_extension(const std::string& path, const char* extension) {
  return std::filesystem::path(path).extension() == extension;
}

}  // namespace

void add_render_options(CLI::App& command, RenderArguments& arguments) {
  RenderOptions& options = arguments.options;
  command.add_option("SCENE", options.scene, "Scene file (.toml)")->required();
  command
      .add_option(
          "-o,--output", options.output,
          "Light field to write (.exr); without it, that of --resume, or SCENE's name in the "
          "current folder")
      ->check([](const std::string& file) {
        return file.empty() ? std::string("the name of the file is empty") : std::string();
      })
      ->option_text("FILE");
  command
      .add_option("--samples", arguments.samples,
                  "Rays per pixel and microlens (forward: energy bundles in total, 1e6 unless "
                  "given); with --target-error or --time-limit, at most so many")
      ->option_text("N");
  command
      .add_option("--target-error", arguments.target_error,
                  "Stop when the relative RMSE over lit pixels is below this with 95 % confidence, "
                  "e.g. 1%")
      ->option_text("SHARE");
  command
      .add_option("--time-limit", arguments.time_limit,
                  "Stop after this time, with unit, e.g. 60s, 5min")
      ->option_text("TIME");
  command
      .add_option("--estimator", arguments.estimator,
                  "backward: from the sensor (quasi-Monte Carlo); forward: energy bundles from the "
                  "flame, slow")
      ->check(CLI::IsMember({"backward", "forward"}))
      ->option_text("NAME");
  command.add_option("--threads", options.threads, "Worker threads; 0: one per processor (0)")
      ->check(CLI::Range(0, 4096))
      ->option_text("N");
  command
      .add_option("--seed", arguments.seed,
                  "Seed of the random numbers: the same gives the "
                  "same image, for any number of threads")
      ->option_text("N");
  command
      .add_option("--window", arguments.window,
                  "Render only W x H pixels of the sensor from column X, row Y: X,Y,W,H")
      ->option_text("X,Y,W,H");
  command
      .add_option("--resume", options.resume,
                  "Go on with the run that was to write this light field (.exr) and was "
                  "stopped; its state is beside it in FILE.state")
      ->option_text("FILE");
  command
      .add_option("--stats", options.stats,
                  "Write times, rays, error and what was skipped to this file (.json)")
      ->option_text("FILE");
  command.add_flag("--truth", options.truth,
                   "Add layers of ground truth along each pixel's chief ray: optical depth, mean "
                   "distance and temperature of what is seen, first and last place with "
                   "absorption, solid surface "
                   "and its distance");
  command.add_flag("--no-skip{false}", options.skip,
                   "Do all work, also what the scene does not need (for comparison)");
  command.add_flag(
      "--no-control-variate{false}", options.control_variate,
      "Integrate every ray through a grid, instead of correcting a table of radiance by "
      "some of them (for comparison)");
  command.add_flag("--white", options.white,
                   "A white image: 1 W/(m^2 sr) from everywhere in place of the flames");
  command.add_option("--f-numbers", arguments.f_numbers,
                     "With --white: apertures such as 4,5.6,8, each written to a file of its own "
                     "(OUT-f4.exr); the stop is narrowed");
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
  // A run that goes on ends where it began.
  if (options.output.empty()) options.output = options.resume;
  if (options.output.empty())
    options.output = std::filesystem::path(options.scene).stem().string() + ".exr";
  if (!has_extension(options.output, ".exr"))
    throw UsageError("--output: '" + options.output +
                     "' must end in .exr; 'plenoflame develop' makes a picture of it");
  check_not_overwritten("--output", options.output, options.scene);
  if (!options.stats.empty()) {
    check_not_overwritten("--stats", options.stats, options.scene);
    check_not_overwritten("--stats", options.stats, options.output);
  }
  if (!arguments.samples.empty())
    options.samples = whole_number_option("--samples", arguments.samples, 1, 1 << 30);
  if (!arguments.seed.empty())
    options.seed = whole_number_option<std::uint64_t>("--seed", arguments.seed, 0);
  if (!arguments.target_error.empty()) {
    const double target =
        quantity_option("--target-error", arguments.target_error, Dimension::none);
    if (!(target > 0 && target < 1))
      throw UsageError("--target-error: a share above 0 % and below 100 %, e.g. 1%, not '" +
                       arguments.target_error + "'");
    options.target_error = target;
  }
  if (!arguments.time_limit.empty()) {
    const double limit = quantity_option("--time-limit", arguments.time_limit, Dimension::time);
    if (!(limit > 0))
      throw UsageError("--time-limit: a time above 0 s, e.g. 60s, not '" + arguments.time_limit +
                       "'");
    options.time_limit = limit;
  }
  if (!arguments.estimator.empty())
    options.estimator = arguments.estimator == "forward" ? Estimator::forward : Estimator::backward;
  if (!arguments.window.empty()) options.window = window_option("--window", arguments.window);
  if (!arguments.f_numbers.empty()) {
    options.f_numbers = f_number_list(arguments.f_numbers);
    if (!options.white) throw UsageError("--f-numbers: only white images are taken at several");
    if (!options.resume.empty())
      throw UsageError("--f-numbers: a stopped run is resumed one file at a time");
  }
  if (options.white && options.estimator == Estimator::forward)
    throw UsageError(
        "--white: light from everywhere has no place to start bundles from; use the "
        "backward estimator");
  return options;
}

std::string state_path(const std::string& light_field) {
  return light_field + ".state";
}

void check_files(const RenderOptions& options) {
  check_writable(options.output);
  if (!options.stats.empty()) check_writable(options.stats);
  if (!options.resume.empty() && !std::filesystem::exists(state_path(options.resume)))
    throw FileError(state_path(options.resume) +
                    ": no such file; only a run that was stopped leaves one, and only while the "
                    "light field stands beside it");
}

void check_window(const RenderOptions& options, const SensorSpec& sensor) {
  if (!options.window) return;
  const PixelWindow& window = *options.window;
  if (window.x > sensor.columns - window.width || window.y > sensor.rows - window.height)
    throw UsageError("--window reaches beyond the sensor of " + std::to_string(sensor.columns) +
                     " x " + std::to_string(sensor.rows) + " pixels");
}

}  // namespace plenoflame::cli
