#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/moment_options.h"
#include "commands/render/bench_report.h"
#include "commands/render/estimator_name.h"
#include "commands/scene_input.h"
#include "file_set.h"
#include "medium_loader.h"
#include "options.h"
#include "outputs.h"
#include "peak_memory.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/printable.h"
#include "plenoflame/image/atomic_file.h"
#include "progress_bar.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

constexpr int kForwardReplicates = 4;

struct Arguments {
  std::string scene, camera, output, window, cache, compare;
  std::vector<std::string> set;
  MomentChoice moment;
  std::string samples = "4,16,64,256", bundles = "1e5,4e5,1.6e6", estimators = "backward,forward";
  std::string reference_samples;
  int repeat = 3, threads = 0;
  bool json = false, quiet = false;
};

std::vector<std::string> parts_of(const std::string& list) {
  std::vector<std::string> parts;
  std::istringstream stream(list);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

/// Ascending whole numbers from a list such as "4,16" or "1e5,1e6".
std::vector<int> counts_option(const std::string& option, const std::string& text, int least) {
  std::vector<int> counts;
  const auto refuse = [&](const std::string& wanted) {
    throw UsageError(option + ": " + wanted + ", not '" + text + "'");
  };
  for (const std::string& part : parts_of(text)) {
    double value = 0;
    const char* const end = part.data() + part.size();
    const auto read = std::from_chars(part.data(), end, value);
    if (read.ec != std::errc() || read.ptr != end || !(value >= least && value <= 1 << 30) ||
        value != std::floor(value))
      refuse("whole numbers from " + std::to_string(least) + " to 1073741824, separated by commas");
    if (!counts.empty() && value <= counts.back()) refuse("each number larger than the one before");
    counts.push_back(static_cast<int>(value));
  }
  if (counts.empty()) throw UsageError(option + " is empty");
  return counts;
}

/// The folder of references unless --cache names one (XDG Base Directory Specification).
std::string default_cache() {
  // Nothing in this process changes the environment.
  const char* const xdg = std::getenv("XDG_CACHE_HOME");  // NOLINT(concurrency-mt-unsafe)
  if (xdg && std::filesystem::path(xdg).is_absolute()) return std::string(xdg) + "/plenoflame";
  const char* const home = std::getenv("HOME");  // NOLINT(concurrency-mt-unsafe)
  if (home && *home) return std::string(home) + "/.cache/plenoflame";
  return "";
}

/// Checked options of a run.
struct Plan {
  std::vector<int> samples, bundles;
  bool backward = false, forward = false;
  std::string base;  ///< of the output files; empty: none
  ReferenceSettings reference;
};

Plan plan_of(const Arguments& arguments) {
  Plan plan;
  plan.samples = counts_option("--samples", arguments.samples, 2);
  plan.bundles = counts_option("--bundles", arguments.bundles, kForwardReplicates);
  for (const std::string& name : parts_of(arguments.estimators)) {
    if (name != "backward" && name != "forward")
      throw UsageError("--estimators: backward, forward, or both separated by a comma, not '" +
                       arguments.estimators + "'");
    (name == "backward" ? plan.backward : plan.forward) = true;
  }
  if (!plan.backward && !plan.forward) throw UsageError("--estimators is empty");
  if (!arguments.window.empty())
    plan.reference.window = window_option("--window", arguments.window);
  const int largest = plan.backward ? plan.samples.back() : 64;
  plan.reference.samples =
      arguments.reference_samples.empty()
          ? std::min(largest, 1 << 26) * 16
          : counts_option("--reference-samples", arguments.reference_samples, 4).back();
  plan.reference.cache = arguments.cache.empty() ? default_cache() : arguments.cache;
  std::filesystem::path base = arguments.output;
  if (base.extension() == ".json" || base.extension() == ".csv" || base.extension() == ".svg" ||
      base.extension() == ".png")
    base.replace_extension();
  plan.base = base.string();
  if (!plan.base.empty())
    for (const char* extension : {".json", ".csv", ".svg", ".png"})
      check_writable(plan.base + extension);
  if (!arguments.cache.empty()) {
    std::error_code error;
    std::filesystem::create_directories(arguments.cache, error);
    if (error)
      throw FileError("--cache: cannot make folder '" + arguments.cache + "': " + error.message());
  }
  return plan;
}

/// The command that repeats what was measured; where results go is left out.
std::string command_of(const Arguments& a) {
  std::string text = "plenoflame bench " + a.scene + " --estimators " + a.estimators +
                     " --samples " + a.samples + " --bundles " + a.bundles + " --repeat " +
                     std::to_string(a.repeat);
  if (!a.camera.empty()) text += " --camera " + a.camera;
  for (const std::string& value : a.set) text += " --set '" + value + "'";
  if (!a.window.empty()) text += " --window " + a.window;
  if (a.threads > 0) text += " --threads " + std::to_string(a.threads);
  if (!a.reference_samples.empty()) text += " --reference-samples " + a.reference_samples;
  return text;
}

std::vector<BenchmarkPoint> measure(const Plan& plan, int repeat, const CompiledScene& compiled,
                                    const BenchmarkReference& reference, const Execution& execution,
                                    ProgressBar& bar) {
  std::vector<BenchmarkPoint> points;
  const std::size_t all =
      (plan.backward ? plan.samples.size() : 0) + (plan.forward ? plan.bundles.size() : 0);
  const auto add = [&](Estimator estimator, const std::vector<int>& counts) {
    for (const int count : counts) {
      RenderSettings settings;
      settings.estimator = estimator;
      settings.samples = count;
      settings.seed = compiled.scene.render.seed;
      if (estimator == Estimator::forward) settings.replicates = kForwardReplicates;
      bar.begin(fmt::format("{} of {}, {} {}", points.size() + 1, all, name_of(estimator), count));
      reset_peak_memory();
      points.push_back(benchmark_point(compiled, settings, repeat, reference, execution));
      points.back().peak_memory = peak_memory();
    }
  };
  if (plan.backward) add(Estimator::backward, plan.samples);
  if (plan.forward) add(Estimator::forward, plan.bundles);
  return points;
}

int run_bench(const Arguments& arguments, const std::stop_token& stop) {
  Plan plan = plan_of(arguments);
  nlohmann::ordered_json old;
  if (!arguments.compare.empty()) {
    if (!plan.base.empty())
      check_not_overwritten("--output", plan.base + ".json", arguments.compare);
    old = read_bench_json(arguments.compare);
  }
  ProgressBar bar(arguments.quiet);
  Execution execution;
  execution.threads = arguments.threads;
  bar.connect(execution);
  const SceneDocument document = at_moment(
      read_camera_scene(arguments.scene, arguments.set, arguments.camera), arguments.moment);
  const SensorSpec& sensor = document.scene.camera.sensor;
  PixelWindow& window = plan.reference.window;
  if (window.x > sensor.columns - window.width || window.y > sensor.rows - window.height)
    throw UsageError("--window reaches beyond the sensor of " + std::to_string(sensor.columns) +
                     " x " + std::to_string(sensor.rows) + " pixels");
  plan.reference.seed = document.scene.render.seed;
  const CompiledScene compiled = compile(document, medium_loader(), execution);
  if (!compiled.medium && !compiled.surfaces)
    throw InputError(arguments.scene +
                     " has no flame and no surface: there is no error to measure");

  BenchResult result;
  {
    execution.stop = stop;
    bar.begin("reference");
    result.reference = benchmark_reference(compiled, plan.reference, execution);
    result.points = measure(plan, arguments.repeat, compiled, result.reference, execution, bar);
  }
  bar.finish();
  for (const BenchmarkPoint& point : result.points)
    if (point.relative_rmse < 2 * result.reference.relative_error) {
      execution.warn(
          "the error of the reference is not small against the smallest measured error; give more "
          "--reference-samples");
      break;
    }
  result.scene = arguments.scene;
  result.command = command_of(arguments);
  result.scene_text = result.reference.light_field.scene_text;
  result.window = result.reference.light_field.window;
  result.repeat = arguments.repeat;
  result.threads = execution.thread_count();
  const nlohmann::ordered_json json = bench_json(result);
  const std::string text =
      json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
  if (!plan.base.empty()) {
    FileSet files;
    files.write(plan.base + ".json", [&](const std::string& name) { write_file(name, text); });
    files.write(plan.base + ".csv",
                [&](const std::string& name) { write_file(name, bench_csv(json)); });
    files.write(plan.base, [&](const std::string& name) { write_bench_plots(name, json); });
    files.commit();
  }
  if (arguments.json) {
    std::cout << text;
    if (!arguments.compare.empty()) std::cerr << printable(bench_comparison(json, old), true);
    return kSuccess;
  }
  std::cout << printable(bench_table(json, output_columns()), true);
  if (!arguments.compare.empty())
    std::cout << "\nagainst " << printable(arguments.compare) << ":\n"
              << fitting(printable(bench_comparison(json, old), true));
  return kSuccess;
}

}  // namespace

void register_bench(const Registry& registry) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_command(registry, "bench", "Measure error against run time",
                                  "plenoflame bench examples/lenslets-30.toml -o lenslets");
  Arguments& a = *arguments;
  command.add_option("SCENE", a.scene, "Scene file (.toml)")->required();
  add_set_option(command, a.set);
  add_camera_option(command, a.camera);
  add_moment_options(command, a.moment);
  add_option(command, "-o,--output", a.output, "NAME",
             "Write NAME.json, NAME.csv, and the plot as NAME.svg and NAME.png")
      ->check(written());
  add_option(command, "--window", a.window, "X,Y,W,H",
             "Measure only W x H pixels from column X, row Y: X,Y,W,H");
  add_option(command, "--estimators", a.estimators, "LIST",
             "backward, forward (the paper's method), or both (backward,forward)");
  add_option(command, "--samples", a.samples, "LIST",
             "Backward: rays per pixel and microlens (4,16,64,256)");
  add_option(command, "--bundles", a.bundles, "LIST",
             "Forward: energy bundles in total (1e5,4e5,1.6e6)");
  add_option(command, "--repeat", a.repeat, "N",
             "Runs of each measurement, with different seeds (3)")
      ->check(CLI::Range(1, 1000));
  add_threads_option(command, a.threads);
  add_option(command, "--reference-samples", a.reference_samples, "N",
             "Rays per pixel and microlens of the reference (16 times the largest of --samples)");
  add_option(command, "--cache", a.cache, "DIR",
             "Folder of the reference (plenoflame in the user's cache folder)");
  add_option(command, "--compare", a.compare, "FILE", "Earlier run to compare with (.json)");
  command.add_flag("--quiet", a.quiet, "No progress and no notes; warnings remain");
  command.add_flag("--json", a.json, "Print the figures as JSON");
  on_chosen(command, registry,
            [arguments](const std::stop_token& stop) { return run_bench(*arguments, stop); });
}

}  // namespace plenoflame::cli
