#include "commands/reconstruct/reconstruct_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "choice.h"
#include "commands/reconstruct/unknowns_options.h"
#include "commands/scene_input.h"
#include "number_range.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame::cli {
namespace {

void add_problem_options(CLI::App& command, ReconstructArguments& arguments) {
  command
      .add_option("--find", arguments.find,
                  "emission; temperature, with known absorption; both: temperature and absorption, "
                  "from two channels (emission)")
      ->check(one_of({"emission", "temperature", "both"}))
      ->option_text("WHAT");
  add_unknowns_options(command, arguments.unknowns);
  command
      .add_option("--channel", arguments.channel,
                  "Channel that is reconstructed; for both, two or more with commas between (the "
                  "pictures' first)")
      ->option_text("NAME");
  command
      .add_option("--absorption-error", arguments.absorption_error,
                  "Relative standard deviation of --absorption, alike everywhere: 0.1 for 10 % (0)")
      ->check(number_between(0.0, 1.0))
      ->option_text("SHARE");
  command
      .add_option("--absorption-ratios", arguments.ratio,
                  "For both: absorption of the further channels over that of the first (soot: "
                  "inverse to the wavelengths)")
      ->option_text("R[,R]");
  command
      .add_option(
          "--noise", arguments.noise,
          "Standard deviation added to each pixel's own, as a share of the largest value (0)")
      ->check(number_between(0.0, 1.0))
      ->option_text("SHARE");
  command
      .add_option("--support", arguments.support,
                  "Nothing is where this file's first grid is 0 (.vdb)")
      ->option_text("FILE.vdb");
  command.add_flag("--all-voxels", arguments.all, "Solve also for places behind dark pixels");
}

void add_solver_options(CLI::App& command, ReconstructArguments& arguments) {
  command
      .add_option("--solver", arguments.solver,
                  "With a penalty: fista, nnls (few unknowns), cgls or lsqr. Without, stopped by "
                  "the noise: sirt, sart, mlem, osem, mart (fista)")
      ->check(one_of(reconstruction_solvers()))
      ->option_text("NAME");
  command
      .add_option("--smoothing", arguments.smoothing,
                  "Weight of the penalty along each axis of the unknowns, e.g. 3,1,1 where depth "
                  "is x (1,1,1)")
      ->option_text("A[,B,C]");
  command
      .add_option("--strength", arguments.strength,
                  "Of the penalty; 0: none; without it, by cross-validation")
      ->check(number_between(0.0, 1e12))
      ->option_text("NUMBER");
  command.add_option("--iterations", arguments.iterations, "At most, of the last solution (300)")
      ->option_text("N");
  command.add_option("--subsets", arguments.subsets, "Of the rows, for sart and osem (4)")
      ->option_text("N");
  command
      .add_option("--relaxation", arguments.relaxation,
                  "Of sirt (1.9), sart (1) and mart (0.05): above 0, below 2, for mart up to 1")
      ->check(number_between(0.0, 2.0))
      ->option_text("NUMBER");
  command
      .add_option("--prior", arguments.prior,
                  "The penalty pulls towards the emission of this earlier result")
      ->option_text("FILE.vdb");
  command.add_option("--start", arguments.start, "Begin with this earlier result")
      ->option_text("FILE.vdb");
  command
      .add_option("--resume", arguments.resume,
                  "Go on from this result of the same command that was stopped, with its strength")
      ->check(continued())
      ->option_text("FILE.vdb");
}

void add_numbers(CLI::App& command, ReconstructArguments& arguments) {
  command.add_option("--rays", arguments.rays, "Rays per pixel and microlens that covers it (64)")
      ->option_text("N");
  add_rows_options(command, arguments.bin, arguments.cells);
  command.add_option("--draws", arguments.draws, "Draws for the standard deviations; 0: none (30)")
      ->option_text("N");
  command
      .add_option("--probes", arguments.probes, "Random vectors for what is resolved; 0: none (16)")
      ->option_text("N");
  command
      .add_option("--spread", arguments.spreads,
                  "Tell how wide a point at this place becomes; repeatable")
      ->option_text("X,Y,Z");
  command
      .add_option("--refine", arguments.refine,
                  "Correct what the pictures say is wrong: exposure, pose (place and turn about "
                  "the line of sight), focus, axis (of rings)")
      ->option_text("WHAT[,...]");
  command
      .add_option("--refined", arguments.refined_scenes, "Scenes with the refined cameras (.toml)")
      ->check(written())
      ->option_text("FILE.toml ...");
  command.add_option("--memory", arguments.memory, "Most memory of the matrix [MB] (2000)")
      ->option_text("N");
  command
      .add_option("--form", arguments.form,
                  "Kept in memory: matrix; rays, followed in each iteration; drawn: nothing, each "
                  "iteration draws the rays again; auto: the first that fits (auto)")
      ->check(one_of({"auto", "matrix", "rays", "drawn"}))
      ->option_text("FORM");
}

}  // namespace

void add_reconstruct_options(CLI::App& command, ReconstructArguments& arguments) {
  command
      .add_option("SCENES", arguments.scenes,
                  "Scene files (.toml), one for each camera, or one with several")
      ->required();
  add_set_option(command, arguments.set);
  add_cameras_option(command, arguments.cameras);
  command
      .add_option("--images", arguments.images,
                  "Light fields of render, or electrons of develop, in the order of the cameras; "
                  "for a series all frames of the first camera, then of the second, ...")
      ->required()
      ->option_text("FILE.exr ...");
  command
      .add_option("-o,--output", arguments.output,
                  "Grids of temperature, emission and deviations; of a series FILE-0001.vdb, ...")
      ->check(written())
      ->required()
      ->option_text("FILE.vdb");
  add_problem_options(command, arguments);
  add_solver_options(command, arguments);
  add_numbers(command, arguments);
  command
      .add_option("--residual", arguments.residuals,
                  "Residual of each picture, and the light that the flame explains, as layers")
      ->check(written())
      ->option_text("FILE.exr ...");
  command
      .add_option(
          "--report", arguments.reports,
          "Report with the history: .json, .txt, or .html with pictures and plots; repeatable")
      ->check(written())
      ->option_text("FILE");
  command.add_flag("--truth", arguments.truth, "Compare with the first scene's flames");
  command.add_option("--threads", arguments.threads, "Worker threads; 0: one per processor (0)")
      ->check(CLI::Range(0, 1024))
      ->option_text("N");
  command.add_option("--seed", arguments.seed, "Seed of the rays (default: the scene's + 1000)")
      ->option_text("N");
  command.add_flag("--quiet", arguments.quiet, "No progress on the terminal");
  command.add_flag("--json", arguments.json, "Print the figures as JSON");
}

std::size_t frame_count(const ReconstructArguments& arguments, std::size_t cameras) {
  const std::size_t images = arguments.images.size();
  if (images == 0 || images % cameras != 0)
    throw UsageError(
        fmt::format("{} cameras but {} pictures: each camera needs one of its own, or "
                    "of a series equally many",
                    cameras, images));
  return images / cameras;
}

std::string frame_name(const std::string& path, std::size_t frame, std::size_t frames) {
  if (frames == 1) return path;
  const std::filesystem::path whole(path);
  return (whole.parent_path() /
          (whole.stem().string() + fmt::format("-{:04}", frame + 1) + whole.extension().string()))
      .string();
}

void check_reconstruct_files(const ReconstructArguments& arguments, std::size_t frames) {
  if (!arguments.residuals.empty() && arguments.residuals.size() != arguments.images.size())
    throw UsageError("--residual: one file for each picture");
  if (!arguments.residuals.empty() && arguments.channels().size() > 1)
    throw UsageError("--residual is for a single channel; --report FILE.html shows those of all");
  if (!arguments.output.ends_with(".vdb"))
    throw UsageError("-o: '" + arguments.output + "' must end in .vdb");
  if (!arguments.refined_scenes.empty() && arguments.refine.empty())
    throw UsageError("--refined writes what --refine corrects: give that, too");
  if (!arguments.refined_scenes.empty() &&
      arguments.refined_scenes.size() != arguments.scenes.size())
    throw UsageError(fmt::format("--refined: {} files for {} scenes",
                                 arguments.refined_scenes.size(), arguments.scenes.size()));
  std::vector<std::string> scenes = arguments.scenes;
  std::ranges::sort(scenes);
  if (const auto twice = std::ranges::adjacent_find(scenes);
      twice != scenes.end() && !arguments.refined_scenes.empty())
    throw UsageError("--refined: " + *twice + " is given twice");
  std::vector<std::string> outputs = arguments.residuals;
  for (const std::string& scene : arguments.refined_scenes) {
    if (!scene.ends_with(".toml")) throw UsageError("--refined: '" + scene + "' must end in .toml");
    outputs.push_back(scene);
  }
  for (const std::string& report : arguments.reports)
    if (!report.ends_with(".json") && !report.ends_with(".txt") && !report.ends_with(".html"))
      throw UsageError("--report: '" + report + "' must end in .json, .txt or .html");
  for (std::size_t f = 0; f < frames; ++f) {
    outputs.push_back(frame_name(arguments.output, f, frames));
    for (const std::string& report : arguments.reports)
      outputs.push_back(frame_name(report, f, frames));
  }
  const std::string earlier[] = {arguments.support, arguments.prior, arguments.start};
  for (const std::string& output : outputs) {
    // The names of a series were not given.
    for (const std::string& input : arguments.images)
      check_not_overwritten("an output", output, input);
    for (const std::string& input : earlier)
      if (!input.empty()) check_not_overwritten("an output", output, input);
    check_writable(output);
  }
}

}  // namespace plenoflame::cli
