#include "plenoflame/render/render.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>

#include "commands/commands.h"
#include "commands/render_options.h"
#include "commands/scene_input.h"
#include "interrupt.h"
#include "medium_loader.h"
#include "peak_memory.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/film/checkpoint.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/media/uniform_medium.h"
#include "plenoflame/optics/first_order.h"
#include "plenoflame/render/describe.h"
#include "plenoflame/render/ground_truth.h"
#include "plenoflame/scene/input_files.h"
#include "plenoflame/scene/scene_file.h"
#include "progress_bar.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

RenderSettings settings_of(const RenderOptions& options, const Scene& scene) {
  RenderSettings settings;
  settings.estimator = options.estimator.value_or(scene.render.estimator);
  settings.target_error = options.target_error.value_or(0);
  settings.time_limit = options.time_limit.value_or(0);
  // With a target or a time limit the scene's number of samples is no limit.
  const bool open_ended = options.target_error || options.time_limit;
  settings.samples = options.samples.value_or(open_ended ? kMostSamples : scene.render.samples);
  if (settings.estimator == Estimator::forward) {
    // A scene that is made for the other estimator says nothing about how many bundles are needed.
    const bool scene_says = scene.render.estimator == Estimator::forward &&
                            scene.render.samples != RenderSpec{}.samples;
    if (!options.samples && !scene_says) settings.samples = kForwardSamples;
    if (!options.samples && open_ended) settings.samples = kMostBundles;
    settings.replicates = std::min(kForwardReplicates, settings.samples);
  }
  // One sample alone tells nothing of its error.
  settings.replicates = std::clamp(settings.samples, 1, settings.replicates);
  settings.seed = options.seed.value_or(scene.render.seed);
  if (options.window) settings.window = *options.window;
  settings.skip = options.skip;
  settings.control_variate = options.control_variate;
  return settings;
}

/// Everything that was left out, with the figures that there are.
void add_skipped(const RenderStatistics& s, Report& report) {
  const auto add = [&](double part, double whole, const std::string& what, const char* key) {
    if (part > 0) report.add_text("skipped", fmt::format("{:.4g} of {:.4g} {}", part, whole, what));
    if (key) report.add_json(key, part);
  };
  add(s.lenses_skipped, s.lenses, "microlenses: their beams miss the flame", "lenses_skipped");
  add(s.pixels_skipped, s.pixels_skipped + s.pairs, "pixels: their beams miss the flame",
      "pixels_skipped");
  add(s.pairs_skipped, s.pairs_skipped + s.pairs + s.pairs_left_to_chance,
      "pixels of the other microlenses: their beams miss the flame", "pairs_skipped");
  add(s.tiles_skipped, s.tiles, "tiles: no beam meets the flame", "tiles_skipped");
  add(s.medium.skipped_empty, s.medium.skipped_empty + s.medium.cells, "steps: empty bricks",
      nullptr);
  add(s.medium.skipped_constant, s.medium.skipped_constant + s.medium.cells,
      "steps: constant bricks, in closed form", nullptr);
  add(s.medium.opaque_tails, s.medium.rays, "rays cut where the flame is opaque", nullptr);
  for (const std::string& text : s.left_out) report.add_text("left out", text);
  report.add_json("left_out", s.left_out);
}

Report report_of(const RenderStatistics& s, double compile_seconds) {
  Report report;
  const auto number = [](double value) {
    char text[64];
    std::snprintf(text, sizeof text, "%.4g", value);
    return std::string(text);
  };
  const auto share = [&](double part, double whole) {
    return whole > 0 ? number(100 * part / whole) + " %" : std::string("none");
  };
  report.add("complete", s.complete ? "yes" : "no, stopped early", "complete", s.complete);
  report.add("flux", number(s.flux) + " W over the image", "flux", s.flux);
  if (s.relative_error >= 0)
    report.add("error",
               number(100 * s.relative_error) + " % relative RMSE over lit pixels, below " +
                   number(100 * s.relative_error_bound) + " % with " +
                   number(100 * kErrorConfidence) + " % confidence",
               "relative_error", s.relative_error);
  if (std::isfinite(s.relative_error_bound) && s.relative_error >= 0) {
    report.add_json("relative_error_bound", s.relative_error_bound);
    report.add_json("confidence", kErrorConfidence);
  }
  report.add("rays", number(s.rays), "rays", s.rays);
  report.add("reached the scene", share(s.rays_reached, s.rays), "rays_reached", s.rays_reached);
  report.add("rays per second", number(s.rays / s.seconds), "rays_per_second", s.rays / s.seconds);
  report.add("time", number(s.seconds) + " s, " + number(compile_seconds) + " s before to compile",
             "seconds", s.seconds);
  report.add_json("seconds_compile", compile_seconds);
  report.add_json("thread_seconds", {{"generate", s.seconds_generate},
                                     {"optics", s.seconds_optics},
                                     {"medium", s.seconds_medium},
                                     {"surfaces", s.seconds_surfaces}});
  report.add("memory", number(1e-6 * peak_memory()) + " MB at most", "peak_memory", peak_memory());
  report.add("threads", std::to_string(s.threads), "threads", s.threads);
  report.add("processor", s.isa + ", " + s.precision + " precision", "isa", s.isa);
  report.add_json("precision", s.precision);
  report.add("flame", s.medium_description, "medium", s.medium_description);
  if (s.wavelengths > 0)
    report.add("wavelengths",
               std::to_string(s.wavelengths) + " for the channels, error below " +
                   number(100 * s.spectral_error) + " %",
               "wavelengths", s.wavelengths);
  report.add_json("spectral_error", s.spectral_error);
  report.add_json("paths", s.paths);
  if (!s.surfaces_description.empty())
    report.add("surfaces", s.surfaces_description, "surfaces", s.surfaces_description);
  add_skipped(s, report);
  report.add_json("lenses", s.lenses);
  report.add_json("pixels", s.pixels);
  report.add_json("pairs", s.pairs);
  report.add_json("pairs_left_to_chance", s.pairs_left_to_chance);
  report.add_json("tiles", s.tiles);
  if (s.table_nodes > 0) {
    const double all = s.table_looked_up + s.table_corrected + s.table_rough;
    report.add("radiance table",
               share(s.table_looked_up, all) + " of the rays looked up, " +
                   share(s.table_corrected, all) + " corrected it, " + share(s.table_rough, all) +
                   " where it is not smooth; " + number(s.table_nodes) + " filled it",
               "table_looked_up", s.table_looked_up);
    report.add_json("table_corrected", s.table_corrected);
    report.add_json("table_rough", s.table_rough);
    report.add_json("table_nodes", s.table_nodes);
    report.add_json("table_clamped", s.table_clamped);
    report.add_json("table_bias_bound", s.table_sum > 0 ? s.table_clamped_sum / s.table_sum : 0.0);
  }
  report.add_json("medium_counters", {{"rays", s.medium.rays},
                                      {"cells", s.medium.cells},
                                      {"skipped_empty", s.medium.skipped_empty},
                                      {"skipped_constant", s.medium.skipped_constant},
                                      {"opaque_tails", s.medium.opaque_tails}});
  return report;
}

/// What a kept state belongs to: anything that changes the image's bits.
std::string state_key(const Scene& scene, const RenderSettings& s, bool white) {
  nlohmann::ordered_json key;
  key["version"] = version();
  key["scene"] = write_scene(scene);
  key["estimator"] = s.estimator == Estimator::forward ? "forward" : "backward";
  key["white"] = white;
  key["seed"] = s.seed;
  key["samples"] = s.samples;
  key["control_variate"] = s.control_variate;
  key["replicates"] = s.replicates;
  key["target_error"] = s.target_error;
  // Then parts of the picture are finished, and get no more samples.
  key["fixed_samples"] = has_fixed_samples(s);
  key["isa"] = name(s.isa);
  // Files that changed under the same name make another picture.
  for (const InputFile& file : input_files(scene))
    key["files"].push_back({file.name, file.size, file.modified});
  key["window"] = {s.window.x, s.window.y, s.window.width, s.window.height};
  return key.dump();
}

/// The same radiance from everywhere, for a white image.
void fill_with_light(CompiledScene& compiled) {
  compiled.medium = make_uniform_medium(1, compiled.node_count());
  compiled.scatterers.clear();
  for (CompiledScene& part : compiled.parts) {
    // Of a channel that several wavelengths stand for each sees its share.
    double sharing = 0;
    for (const CompiledScene& other : compiled.parts)
      sharing += other.film_channel == part.film_channel ? 1 : 0;
    part.medium = make_uniform_medium(1 / sharing, 1);
    part.scatterers.clear();
  }
}

/// Renders one light field. `document`: the scene of the options, perhaps with another aperture.
int render_one(const RenderOptions& options, const SceneDocument& document) {
  ProgressBar bar(options.quiet);
  Execution execution;
  execution.threads = options.threads;
  bar.connect(execution);
  check_window(options, document.scene.camera.sensor);
  check_files(options);
  const auto start = std::chrono::steady_clock::now();
  Execution compiling = execution;
  // That a white image has no flame is not worth a warning.
  if (options.white)
    compiling.message = [&](Severity severity, const std::string& text) {
      if (text.find("has no flame") == std::string::npos) execution.message(severity, text);
    };
  CompiledScene compiled = compile(document.scene, medium_loader(), compiling, document.positions);
  if (options.white) fill_with_light(compiled);
  const double compile_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  RenderSettings settings = settings_of(options, document.scene);
  const std::string key = state_key(document.scene, settings, options.white);
  Film earlier;
  if (!options.resume.empty()) {
    earlier = read_checkpoint(state_path(options.resume), key);
    settings.resume = &earlier;
  }
  const std::string state = state_path(options.output);
  settings.checkpoint = [&](const Film& film) { write_checkpoint(state, film, key); };
  RenderResult result;
  bool interrupted = false;
  {
    const InterruptHandler interrupt;
    execution.stop = interrupt.token();
    result = render(compiled, settings, execution);
    interrupted = interrupt.interrupted();
  }
  describe(compiled, result.light_field);
  if (options.white) result.light_field.texts["white"] = "1 W/(m^2 sr)";
  if (options.truth) {
    Execution rest = execution;
    rest.stop = {};  // a run that was stopped is kept, too
    add_ground_truth(compiled, result.light_field, rest);
  }
  bar.finish();
  write_light_field(options.output, result.light_field);
  if (!result.statistics.complete) write_checkpoint(state, result.film, key);
  if (result.statistics.complete) std::filesystem::remove(state);
  const Report report = report_of(result.statistics, compile_seconds);
  if (!options.stats.empty()) write_file(options.stats, report.json_text());
  if (options.json || !options.quiet) report.print(options.json);
  if (interrupted)
    std::cerr << "plenoflame: stopped; " << options.output
              << " holds what was rendered, marked partial; go on with --resume " << options.output
              << '\n';
  if (!interrupted && !result.statistics.complete)
    execution.warn("the time limit ended before every part of the picture had a ray; " +
                   options.output + " is marked partial; go on with --resume " + options.output);
  if (!interrupted && !result.statistics.target_reached)
    std::cerr << fmt::format(
        "plenoflame: error: the target error was not reached within the limit of samples or time: "
        "{}\n",
        result.statistics.flux > 0 ? fmt::format("the error is below {:.3g} %",
                                                 100 * result.statistics.relative_error_bound)
                                   : "the picture is black");
  return interrupted || !result.statistics.target_reached ? 1 : 0;
}

/// Narrows the stop to focal length over entrance pupil = `f_number`.
void stop_down(MainLensSpec& lens, double f_number) {
  const FirstOrder open = first_order(lens);
  const double factor = open.focal_length / f_number / open.entrance_pupil_diameter;
  if (!(factor <= 1 + 1e-9)) {
    char text[120];
    std::snprintf(text, sizeof text, "--f-numbers: f/%g is wider than the lens, which is f/%.4g",
                  f_number, open.focal_length / open.entrance_pupil_diameter);
    throw UsageError(text);
  }
  lens.diameter *= factor;
  for (SurfaceSpec& surface : lens.surfaces)
    if (surface.stop) surface.diameter *= factor;
}

/// "white.exr" -> "white-f5.6.exr".
std::string with_f_number(const std::string& path, double f_number) {
  char text[32];
  std::snprintf(text, sizeof text, "-f%g", f_number);
  const std::filesystem::path whole(path);
  return (whole.parent_path() / (whole.stem().string() + text + whole.extension().string()))
      .string();
}

int run_render(const RenderArguments& arguments) {
  const RenderOptions options = checked_options(arguments);
  SceneDocument document = read_valid_scene(options.scene);
  if (!options.white) return render_one(options, document);
  document.scene.flames.clear();
  if (options.f_numbers.empty()) return render_one(options, document);
  // All are tried before the first picture is begun.
  for (std::size_t i = 0; i < options.f_numbers.size(); ++i) {
    MainLensSpec lens = document.scene.camera.lens;
    stop_down(lens, options.f_numbers[i]);
    for (std::size_t k = 0; k < i; ++k)
      if (with_f_number("", options.f_numbers[k]) == with_f_number("", options.f_numbers[i]))
        throw UsageError(
            fmt::format("--f-numbers: f/{:g} is asked for twice", options.f_numbers[i]));
  }
  int status = 0;
  for (const double number : options.f_numbers) {
    SceneDocument stopped = document;
    stop_down(stopped.scene.camera.lens, number);
    RenderOptions one = options;
    one.output = with_f_number(options.output, number);
    if (!options.stats.empty()) one.stats = with_f_number(options.stats, number);
    if (one.json || !one.quiet) std::cout << (one.json ? "" : one.output + "\n");
    status = std::max(status, render_one(one, stopped));
  }
  return status;
}

}  // namespace

void register_render(const Registry& registry) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App& command =
      add_command(registry, "render", "Render the light field of a scene",
                  "plenoflame render examples/paper-flame-1m.toml -o flame.exr --samples 16");
  add_render_options(command, *arguments);
  on_chosen(command, registry, [arguments] { return run_render(*arguments); });
}

}  // namespace plenoflame::cli
