#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>

#include "commands/commands.h"
#include "commands/scene_input.h"
#include "medium_loader.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/render/compiled_camera.h"
#include "progress_bar.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

struct CompileArguments {
  std::string scene, output, camera, window, error, region, margin, samples, seed;
  std::vector<std::string> set;
  int threads = 0, level = 0;
  bool json = false, quiet = false;
};

CompileSettings checked(const CompileArguments& arguments) {
  CompileSettings settings;
  if (!arguments.error.empty()) {
    settings.error = quantity_option("--error", arguments.error, Dimension::none);
    if (!(settings.error > 0 && settings.error < 1))
      throw UsageError("--error must be a share above 0 % and below 100 %, e.g. 0.2%, not '" +
                       arguments.error + "'");
  }
  if (!arguments.window.empty()) settings.window = window_option("--window", arguments.window);
  if (!arguments.region.empty()) settings.region = box_option("--region", arguments.region);
  if (!arguments.margin.empty()) {
    settings.margin = quantity_option("--margin", arguments.margin, Dimension::length);
    if (!(settings.margin >= 0)) throw UsageError("--margin must be a length of at least 0");
  }
  if (!arguments.samples.empty())
    settings.samples = whole_number_option("--samples", arguments.samples, 2, 1 << 16);
  if (!arguments.seed.empty())
    settings.seed = whole_number_option<std::uint64_t>("--seed", arguments.seed, 0);
  settings.level = arguments.level;
  return settings;
}

int run_compile(const CompileArguments& arguments, const std::stop_token& stop) {
  check_ending("-o", arguments.output, {".bundle"});
  const CompileSettings settings = checked(arguments);
  check_is_scene(arguments.scene);
  check_writable(arguments.output);
  const SceneDocument document =
      read_camera_scene(arguments.scene, arguments.set, arguments.camera);
  ProgressBar bar(arguments.quiet);
  Execution execution;
  execution.threads = arguments.threads;
  execution.stop = stop;
  bar.connect(execution);
  // With a region no flame is needed, and without one its lack is the error.
  const CompiledScene scene = compile(document.scene, medium_loader(), execution,
                                      document.positions, {}, {IssueCode::no_flame});
  const auto start = std::chrono::steady_clock::now();
  const CompiledCamera camera = compile_camera(scene, settings, execution);
  write_bundle(arguments.output, camera);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  bar.finish();
  const double lit = camera.lit_pixels(), nodes = static_cast<double>(camera.nodes);
  Report report;
  report.add("pixels", fmt::format("{:.0f} that see the region", lit), "pixels", lit);
  report.add("rays",
             fmt::format("{:.4g}, {:.3g} a pixel in two sets", nodes, lit > 0 ? nodes / lit : 0.0),
             "rays", nodes);
  report.add("bundles", fmt::format("{} rays a pixel and microlens", camera.samples), "samples",
             camera.samples);
  report.add_json("level", camera.level);
  std::error_code error;
  const auto size = static_cast<double>(std::filesystem::file_size(arguments.output, error));
  report.add("size", fmt::format("{:.4g} MB", 1e-6 * size), "size", size);
  report.add("time", fmt::format("{:.3g} s", seconds), "seconds", seconds);
  report.add("written", arguments.output, "output", arguments.output);
  if (arguments.json || !arguments.quiet) report.print(arguments.json);
  return kSuccess;
}

}  // namespace

void register_compile(const Registry& registry) {
  auto arguments = std::make_shared<CompileArguments>();
  CLI::App& command =
      add_command(registry, "compile", "Find a camera's rays once, for pictures of many flames",
                  "plenoflame compile examples/lenslets-30.toml --margin 5mm -o lenslets.bundle");
  command.add_option("SCENE", arguments->scene, "Scene file (.toml)")->required();
  add_set_option(command, arguments->set);
  add_camera_option(command, arguments->camera);
  command
      .add_option("-o,--output", arguments->output,
                  "The compiled camera, for --compiled of other commands")
      ->check(written())
      ->required()
      ->option_text("FILE.bundle");
  command
      .add_option("--error", arguments->error,
                  "Relative RMSE over lit pixels, for a layered flame; smoother flames have a "
                  "smaller error (0.5%)")
      ->option_text("SHARE");
  command
      .add_option("--window", arguments->window,
                  "Only W x H pixels of the sensor from column X, row Y: X,Y,W,H")
      ->option_text("X,Y,W,H");
  command
      .add_option("--region", arguments->region,
                  "Box of all flames, two corners, e.g. \"0.9m,-5cm,-5cm:1.1m,5cm,5cm\" (around "
                  "the flames of the scene)")
      ->option_text("X,Y,Z:X,Y,Z");
  command
      .add_option("--margin", arguments->margin,
                  "Room for larger flames on all sides of the region (0)")
      ->option_text("LENGTH");
  command
      .add_option("--samples", arguments->samples,
                  "Rays to choose from, per pixel and microlens (as --error needs)")
      ->option_text("N");
  command
      .add_option(
          "--level", arguments->level,
          "Rays to keep per pixel, from level 1 (10 rays) to 7 (500 rays) (as --error needs)")
      ->check(CLI::Range(1, kCompileLevels))
      ->option_text("N");
  command.add_option("--seed", arguments->seed, "Seed of the rays (1)")->option_text("N");
  command.add_option("--threads", arguments->threads, "Worker threads; 0: one per processor (0)")
      ->check(CLI::Range(0, 1024))
      ->option_text("N");
  command.add_flag("--quiet", arguments->quiet, "No progress and no notes; warnings remain");
  command.add_flag("--json", arguments->json, "Print the figures as JSON");
  on_chosen(command, registry,
            [arguments](const std::stop_token& stop) { return run_compile(*arguments, stop); });
}

}  // namespace plenoflame::cli
