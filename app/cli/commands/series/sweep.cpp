#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <system_error>

#include "commands/commands.h"
#include "commands/series/sweep_plan.h"
#include "commands/series/sweep_ranks.h"
#include "commands/series/sweep_set.h"
#include "messages.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/image/atomic_file.h"
#include "progress_bar.h"
#include "ranks.h"
#include "run.h"
#include "terminal.h"

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
          fmt::format("'{}' holds a sweep that differs in {}; use the same options to continue it, "
                      "or choose another folder",
                      plan.folder, other));
  } else if (fs::exists(plan.folder, error) && !fs::is_empty(plan.folder, error)) {
    throw InputError("'" + plan.folder +
                     "' is not empty and holds no sweep; choose another folder");
  }
  for (const std::string& folder : {plan.folder, plan.folder + "/runs"}) {
    fs::create_directory(folder, error);
    if (error) throw FileError("cannot make the folder '" + folder + "': " + error.message());
  }
  if (!there) write_file(plan.folder + "/sweep.json", plan.text.dump(2) + "\n");
}

int run_sweep(const SweepArguments& arguments, JobCommunicator* ranks,
              const std::stop_token& stop) {
  const bool quiet = arguments.render.options.quiet;
  ProgressBar bar(quiet);
  Execution execution;
  execution.threads = arguments.render.options.threads;
  if (ranks && execution.threads == 0) execution.threads = default_threads(*ranks);
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
  std::size_t done = 0;
  // For example a full disk: after making room, the user repeats the command.
  const auto fail_with_rest = [&](const FileError& failure) {
    const auto there = std::count_if(
        mine.begin(), mine.end(), [&](int run) { return packed || run_is_done(plan.folder, run); });
    throw FileError(fmt::format("{} ({} of {} runs are in {}; the same command continues)",
                                failure.what(), there, mine.size(), plan.folder));
  };
  try {
    share_runs(
        plan, left, ranks,
        [&](int) {
          Progress progress;
          progress.fraction = static_cast<double>(++done) / static_cast<double>(left.size());
          if (execution.progress) execution.progress(progress);
        },
        execution);
  } catch (const Cancelled&) {
    // Runs that are done stay, as below.
  } catch (const FileError& failure) {
    fail_with_rest(failure);
  }
  bar.finish();
  if (stop.stop_requested() && done < left.size()) {
    say(fmt::format("stopped; {} of {} runs are in {}; the same command continues",
                    mine.size() - left.size() + done, mine.size(), plan.folder));
    return kFailure;
  }
  std::vector<int> beyond;
  try {
    if (!packed) beyond = finish_set(plan.folder, plan.text, mine, pack, stop);
  } catch (const FileError& failure) {
    fail_with_rest(failure);
  }
  if (const std::string warning = beyond_lattice_warning(beyond); !warning.empty()) warn(warning);
  const auto tests = std::count_if(
      mine.begin(), mine.end(), [&](int run) { return plan.test[static_cast<std::size_t>(run)]; });
  Report report;
  report.add(
      "runs",
      fmt::format("{}, of which {} were there before", mine.size(), mine.size() - left.size()),
      "runs", mine.size());
  report.add_json("before", mine.size() - left.size());
  report.add("for testing", fmt::format("{}", tests), "test_runs", tests);
  report.add_json("beyond_lattice", beyond);
  report.add("written", plan.folder, "output", plan.folder);
  if (arguments.render.options.json || !quiet) print(report, arguments.render.options.json);
  return kSuccess;
}

}  // namespace

void register_sweep(const Registry& registry) {
  const auto arguments = std::make_shared<SweepArguments>();
  CLI::App& command = add_command(
      registry, "sweep", "Render a data set: many runs of a scene with different values",
      "plenoflame sweep examples/lenslets-30.toml --table runs.csv -o set");
  add_sweep_options(command, *arguments, registry.action.file);
  on_chosen(command, registry, [arguments, ranks = registry.ranks](const std::stop_token& stop) {
    return run_sweep(*arguments, ranks, stop);
  });
}

}  // namespace plenoflame::cli
