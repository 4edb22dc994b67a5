#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <mutex>
#include <set>
#include <system_error>

#include "choice.h"
#include "commands/commands.h"
#include "commands/part_option.h"
#include "commands/scene_input.h"
#include "commands/sweep_plan.h"
#include "commands/sweep_run.h"
#include "commands/sweep_set.h"
#include "messages.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "progress_bar.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

namespace fs = std::filesystem;

/// Makes the folder with its sweep.json, or makes sure that the one there is of the same sweep.
void open_set(const SweepPlan& plan) {
  std::error_code error;
  const bool there = fs::exists(plan.folder + "/sweep.json", error);
  if (there) {
    const std::string other = plan_difference(read_plan(plan.folder), plan.text);
    if (!other.empty())
      throw InputError(
          fmt::format("'{}' holds a sweep that differs in {}; ask for the same to go "
                      "on with it, or choose another folder",
                      plan.folder, other));
  } else if (fs::exists(plan.folder, error) && !fs::is_empty(plan.folder, error)) {
    throw InputError("'" + plan.folder +
                     "' has files in it that are no sweep; choose another folder");
  }
  for (const std::string& folder : {plan.folder, plan.folder + "/runs"}) {
    fs::create_directory(folder, error);
    if (error) throw FileError("cannot make the folder '" + folder + "': " + error.message());
  }
  if (!there) write_file(plan.folder + "/sweep.json", plan.text.dump(2) + "\n");
}

int run_sweep(const SweepArguments& arguments, const std::stop_token& stop) {
  const bool quiet = arguments.render.options.quiet;
  ProgressBar bar(quiet);
  Execution execution;
  execution.threads = arguments.render.options.threads;
  execution.stop = stop;
  bar.connect(execution);
  const SweepPlan plan = plan_sweep(arguments, execution);
  std::vector<int> mine, left;
  for (int run = 0; run < static_cast<int>(plan.runs.size()); ++run)
    if (plan.is_mine(run)) mine.push_back(run);
  const bool pack = plan.packs() && plan.part.is_whole();
  std::error_code error;
  const bool packed = pack && fs::exists(plan.folder + "/set.h5", error);
  if (!packed || !fs::exists(plan.folder + "/sweep.json", error)) open_set(plan);
  if (packed) {
    const std::string other = plan_difference(read_plan(plan.folder), plan.text);
    if (!other.empty())
      throw InputError(fmt::format("'{}' holds a sweep that differs in {}; choose another folder",
                                   plan.folder, other));
  }
  for (const int run : mine)
    if (!packed && !run_is_done(plan.folder, run)) left.push_back(run);
  // Each thread makes pictures of its own; those that are left over share one.
  const int threads = execution.thread_count();
  const int workers = std::max(1, std::min(threads, static_cast<int>(left.size())));
  std::vector<SweepWorker> kept(static_cast<std::size_t>(workers));
  std::mutex arrays, telling;
  std::set<std::string> said;
  std::size_t done = 0;
  Execution sharing = execution;
  sharing.threads = workers;
  try {
    parallel_for(sharing, left.size(), [&](std::size_t i, int worker) {
      Execution one;
      one.threads = std::max(1, threads / workers);
      one.stop = stop;
      one.message = [&](Severity severity, const std::string& text) {
        const std::lock_guard lock(telling);
        if (said.insert(text).second) execution.message(severity, text);
      };
      make_run(plan, left[i], kept[static_cast<std::size_t>(worker)], arrays, one);
      const std::lock_guard lock(telling);
      ++done;
      Progress progress;
      progress.fraction = static_cast<double>(done) / static_cast<double>(left.size());
      if (execution.progress) execution.progress(progress);
    });
  } catch (const Cancelled&) {
    // Runs that are done stay, as below.
  }
  bar.finish();
  if (stop.stop_requested() && done < left.size()) {
    say(fmt::format("stopped; {} of {} runs are in {}; the same command goes on",
                    mine.size() - left.size() + done, mine.size(), plan.folder));
    return kFailure;
  }
  if (!packed) finish_set(plan.folder, plan.text, mine, pack, stop);
  const auto tests = std::count_if(
      mine.begin(), mine.end(), [&](int run) { return plan.test[static_cast<std::size_t>(run)]; });
  Report report;
  report.add(
      "runs",
      fmt::format("{}, of which {} were there before", mine.size(), mine.size() - left.size()),
      "runs", mine.size());
  report.add_json("before", mine.size() - left.size());
  report.add("for testing", fmt::format("{}", tests), "test_runs", tests);
  report.add("written", plan.folder, "output", plan.folder);
  if (arguments.render.options.json || !quiet) report.print(arguments.render.options.json);
  return kSuccess;
}

}  // namespace

void register_sweep(const Registry& registry) {
  const auto arguments = std::make_shared<SweepArguments>();
  CLI::App& command = add_command(
      registry, "sweep", "Render many runs of a scene, each with values of its own: a data set",
      "plenoflame sweep examples/lenslets-30.toml --table runs.csv -o set");
  RenderArguments& render = arguments->render;
  RenderOptions& options = render.options;
  command.add_option("SCENE", options.scene, "Scene file (.toml)")->required();
  command
      .add_option("--table", arguments->table,
                  "Table of the runs (.csv): a header of keys of the scene, as --set has them, a "
                  "run in each row")
      ->option_text("FILE");
  command
      .add_option("--random", arguments->random,
                  "Rules by which values are drawn at random (.toml): [[random]] tables")
      ->option_text("FILE");
  command.add_option("--runs", arguments->runs, "How many runs are drawn")->option_text("N");
  command
      .add_option("-o,--output", arguments->output,
                  "Folder of the set; one that was begun is gone on with")
      ->required()
      ->option_text("DIR");
  add_set_option(command, options.set);
  add_cameras_option(command, options.cameras);
  command
      .add_option("--format", arguments->format,
                  "exr: a light field for each picture; hdf5: one file set.h5 (exr)")
      ->check(one_of({"exr", "hdf5"}))
      ->option_text("NAME");
  command
      .add_option("--lattice", arguments->lattice,
                  "Keep the truth, temperature, absorption and emission lines, on a lattice of so "
                  "many cells along x, y and z")
      ->option_text("NX,NY,NZ");
  command
      .add_option("--region", arguments->region,
                  "Box of the lattice, two corners with units (around the flames of the scene, or "
                  "the region of --compiled)")
      ->option_text("X,Y,Z:X,Y,Z");
  command
      .add_option("--test-share", arguments->test_share,
                  "Share of the runs that are for testing, chosen at random, e.g. 20% (0)")
      ->option_text("SHARE");
  command
      .add_option("--seed", arguments->seed,
                  "Seed of the sweep: what a run is depends on it and the run's number alone (1)")
      ->option_text("N");
  add_part_option(command, arguments->part,
                  "Make only part K of N, in DIR-part-K-of-N: 'plenoflame merge' makes the set of "
                  "all, bit by bit");
  command.add_option("--samples", render.samples, "Rays per pixel and microlens")->option_text("N");
  command
      .add_option("--target-error", render.target_error,
                  "Render each picture until its relative RMSE is below this, e.g. 1%")
      ->option_text("SHARE");
  command.add_option("--window", render.window, "Only W x H pixels from column X, row Y")
      ->option_text("X,Y,W,H");
  command
      .add_option("--compiled", options.compiled,
                  "Render by the rays of a camera that `plenoflame compile` has found")
      ->option_text("FILE.bundle");
  command.add_flag("--truth", options.truth, "Layers of ground truth of each pixel, as of render");
  command.add_option("--threads", options.threads, "Worker threads; 0: one per processor (0)")
      ->check(CLI::Range(0, 4096))
      ->option_text("N");
  command.add_flag("--quiet", options.quiet, "No progress and no notes; warnings remain");
  command.add_flag("--json", options.json, "Print the figures as JSON");
  on_chosen(command, registry,
            [arguments](const std::stop_token& stop) { return run_sweep(*arguments, stop); });
}

}  // namespace plenoflame::cli
