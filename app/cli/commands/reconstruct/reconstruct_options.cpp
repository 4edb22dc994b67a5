#include "commands/reconstruct/reconstruct_options.h"
#include "commands/add_option.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "commands/scene_input.h"
#include "commands/setting_options.h"
#include "commands/settings_file.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame::cli {

void add_reconstruct_options(CLI::App& command, ReconstructArguments& arguments,
                             std::vector<FileOption>& file) {
  arguments.unknowns.names = kOptionNames;
  add_inputs(command, file, "SCENES", arguments.scenes,
             "Scene files (.toml), one for each camera, or one with several",
             &arguments.unknowns.names);
  add_set_option(command, arguments.set);
  add_cameras_option(command, arguments.cameras);
  add_option(command, "--images", arguments.images, "FILE.exr ...",
             "Light fields of render, or electrons of develop, in the order of the cameras; for a "
             "series all frames of the first camera, then of the second, ...")
      ->required();
  add_option(command, "-o,--output", arguments.output, "FILE.vdb",
             "Grids of temperature, emission and deviations; of a series FILE-0001.vdb, ...")
      ->check(written({".vdb"}))
      ->required();
  add_settings<UnknownsRequest>(command, arguments.unknowns);
  add_settings<ReconstructRequest>(command, arguments);
  command.get_option("--resume")->check(continued());
  add_option(command, "--refined", arguments.refined_scenes, "FILE.toml ...",
             "Scenes with the refined cameras (.toml)")
      ->check(written({".toml"}));
  add_option(command, "--residual", arguments.residuals, "FILE.exr ...",
             "Residual of each picture, and the light that the flame explains, as layers")
      ->check(written());
  add_option(command, "--report", arguments.reports, "FILE",
             "Report with the history: .json, .txt, or .html with pictures and plots; repeatable")
      ->check(written({".json", ".txt", ".html"}));
  add_threads_option(command, arguments.threads);
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
  if (!arguments.residuals.empty() && arguments.channels.size() > 1)
    throw UsageError("--residual is for a single channel; --report FILE.html shows those of all");
  if (!arguments.refined_scenes.empty() && arguments.refine.empty() && !arguments.refine_axis)
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
  outputs.insert(outputs.end(), arguments.refined_scenes.begin(), arguments.refined_scenes.end());
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
