#include "plenoflame/render/render.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "commands/commands.h"
#include "commands/render/compiled_scenes.h"
#include "commands/render/render_options.h"
#include "commands/render/render_pictures.h"
#include "commands/render/render_ranks.h"
#include "commands/render/run_record.h"
#include "commands/scene_input.h"
#include "medium_loader.h"
#include "messages.h"
#include "options.h"
#include "peak_memory.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/progress_share.h"
#include "plenoflame/base/report.h"
#include "plenoflame/base/version.h"
#include "plenoflame/film/checkpoint.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/media/uniform_medium.h"
#include "plenoflame/render/describe.h"
#include "plenoflame/render/exposure.h"
#include "plenoflame/render/ground_truth.h"
#include "plenoflame/render/render_request.h"
#include "plenoflame/scene/input_files.h"
#include "plenoflame/scene/scene_file.h"
#include "progress_bar.h"
#include "ranks.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

/// Everything that was left out, with the figures that there are.
void add_skipped(const RenderStatistics& s, Report& report) {
  const auto add = [&](double part, double whole, const std::string& what, const char* key) {
    if (part > 0) report.add_text("skipped", fmt::format("{:.4g} of {:.4g} {}", part, whole, what));
    if (key) report.add_json(key, part);
  };
  add(s.lenses_skipped, s.lenses, "microlenses: their beams miss the flame", "lenses_skipped");
  add(s.pixels_skipped, s.pixels_skipped + s.pairs, "pixels: their beams miss the flame",
      "pixels_skipped");
  add(s.pairs_skipped, s.pairs_skipped + s.pairs,
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
  if (s.flux == 0)
    report.add_text("error", "none: no pixel is lit");
  else if (s.relative_error >= 0)
    report.add("error",
               number(100 * s.relative_error) + " % relative RMSE over lit pixels, below " +
                   number(100 * s.relative_error_bound) + " % with " +
                   number(100 * kErrorConfidence) + " % confidence",
               "relative_error", s.relative_error);
  if (std::isfinite(s.relative_error_bound) && s.relative_error >= 0 && s.flux != 0) {
    report.add_json("relative_error_bound", s.relative_error_bound);
    report.add_json("confidence", kErrorConfidence);
  }
  report.add("rays", number(s.rays), "rays", s.rays);
  report.add("reached the scene", share(s.rays_reached, s.rays), "rays_reached", s.rays_reached);
  report.add("rays per second", number(s.rays / s.seconds), "rays_per_second", s.rays / s.seconds);
  report.add("time", number(s.seconds) + " s, " + number(compile_seconds) + " s before to compile",
             "seconds", s.seconds);
  report.add_json("seconds_compile", compile_seconds);
  report.add_json("thread_seconds", {{"generate", s.stages.generate},
                                     {"optics", s.stages.optics},
                                     {"medium", s.stages.medium},
                                     {"surfaces", s.stages.surfaces}});
  report.add("memory", number(1e-6 * peak_memory()) + " MB at most", "peak_memory", peak_memory());
  report.add("threads",
             std::to_string(s.threads) +
                 (s.ranks > 1 ? fmt::format(" of {} ranks", s.ranks) : std::string()),
             "threads", s.threads);
  report.add_json("ranks", s.ranks);
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
  report.add_json("tiles", s.tiles);
  if (s.table.nodes > 0) {
    const double all = s.table.looked_up + s.table.corrected + s.table.rough;
    report.add("radiance table",
               share(s.table.looked_up, all) + " of the rays used it, " +
                   share(s.table.corrected, all) + " were traced to correct it, " +
                   share(s.table.rough, all) + " were traced where radiance varies too fast for " +
                   "it; filled with " + number(s.table.nodes) + " rays",
               "table_looked_up", s.table.looked_up);
    report.add_json("table_corrected", s.table.corrected);
    report.add_json("table_rough", s.table.rough);
    report.add_json("table_nodes", s.table.nodes);
    report.add_json("table_clamped", s.table.clamped);
    report.add_json("table_bias_bound",
                    s.table.total > 0 ? s.table.clamped_sum / s.table.total : 0.0);
  }
  report.add_json("medium_counters", {{"rays", s.medium.rays},
                                      {"cells", s.medium.cells},
                                      {"skipped_empty", s.medium.skipped_empty},
                                      {"skipped_constant", s.medium.skipped_constant},
                                      {"opaque_tails", s.medium.opaque_tails}});
  return report;
}

/// The record that is kept with the state of this run.
RunRecord record_of(const Picture& picture, const std::vector<SceneMoment>& moments,
                    const RenderSettings& settings) {
  const RenderOptions& options = picture.options;
  const Scene& scene = moments.size() > 1 ? picture.document.scene : moments.front().scene;
  RunRecord record;
  record.version = version();
  record.scene_text = write_scene(scene);
  record.scene_file = std::filesystem::absolute(scene.file).string();
  record.files = files_of(moments);
  record.moments = moments.size();
  record.settings = settings;
  record.white = options.white;
  record.truth = options.truth;
  record.stats = options.stats.empty() ? "" : std::filesystem::absolute(options.stats).string();
  record.compression = options.compression;
  return record;
}

/// Keeps the state of a run every now and then.
class StateKeeper {
 public:
  StateKeeper(std::string path, RunRecord record, const Execution& execution)
      : path_(std::move(path)), record_(std::move(record)), execution_(execution) {}
  /// That there is no room for it is no reason to lose what has been rendered.
  void offer(const Film& film) { offer({&film}, {}); }
  void offer(const ExposureState& state, const Film& current) {
    std::vector<const Film*> films{&state.sums};
    for (std::size_t i = 0; i < state.films.size(); ++i)
      films.push_back(i == state.progress.done ? &current : &state.films[i]);
    offer(films, state.progress);
  }
  bool has_kept() const { return kept_; }

 private:
  void offer(const std::vector<const Film*>& films, const ExposureProgress& exposure) {
    RunRecord now = record_;
    now.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    now.exposure = exposure;
    try {
      write_checkpoint(path_, films, to_text(now));
      kept_ = true;
    } catch (const FileError& error) {
      if (!warned_)
        execution_.warn(std::string("the state of the run cannot be saved: ") + error.what());
      warned_ = true;
    }
  }

  std::string path_;
  RunRecord record_;
  const Execution& execution_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  bool warned_ = false, kept_ = false;
};

/// Adds time and energy to the report of a flame that changes, or of an exposure.
void add_exposure(const LightField& field, Report& report) {
  const auto number = [&](const char* key) {
    const auto found = field.numbers.find(key);
    return found == field.numbers.end() ? std::nullopt : std::optional(found->second);
  };
  if (const auto frame = number("frame.number"))
    report.add("frame", fmt::format("{}", *frame), "frame", *frame);
  if (const auto begin = number("exposure.begin"))
    report.add("begin", readable(*begin, Dimension::time), "exposure_begin", *begin);
  if (const auto time = number("exposure.time"))
    report.add("exposure", readable(*time, Dimension::time), "exposure_time", *time);
  if (const auto moments = number("exposure.moments"))
    report.add("moments", fmt::format("mean of {}", *moments), "moments", *moments);
  if (const auto energy = number("exposure.energy"))
    report.add("energy", fmt::format("{:.4g} J over the image", *energy), "energy", *energy);
}

/// The figures of one of many frames.
std::string frame_line(const std::string& file, const RenderStatistics& s, double compile_seconds) {
  return fmt::format("{}: {:.4g} W{}, {:.3g} s, {:.3g} s before to compile", file, s.flux,
                     s.relative_error >= 0 ? fmt::format(", error {:.3g} %", 100 * s.relative_error)
                                           : std::string(),
                     s.seconds, compile_seconds);
}

constexpr double kNoTruth = -1;

/// Adds layers of ground truth. A stopped run goes without them: they take long, and the picture
/// has to be saved.
/// @return seconds, or kNoTruth when it was stopped
double add_truth(const CompiledScene& compiled, LightField& light_field,
                 const Execution& execution) {
  const auto start = std::chrono::steady_clock::now();
  try {
    add_ground_truth(compiled, light_field, execution);
  } catch (const Cancelled&) {
    return kNoTruth;
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The share of rendering in a run with ground truth. Each pixel has one ray of truth, which takes
/// about as long as kTruthRays rays of the picture.
double rendering_share(bool with_truth, const RenderSettings& settings) {
  constexpr double kTruthRays = 30;
  if (!with_truth) return 1;
  if (settings.target_error > 0 || settings.time_limit > 0) return 0.9;
  return settings.samples / (settings.samples + kTruthRays);
}

std::string how_to_go_on(const RenderOptions& options, const CameraSpec& camera) {
  if (options.frames) return fmt::format("the same frames and --resume {}", options.all_frames);
  return "--resume " + options.output + (camera.name.empty() ? "" : " --camera " + camera.name);
}

/// Values that go from one picture of a run to the next.
struct RenderRun {
  CompiledScenes scenes;
  const CompiledScene* newest = nullptr;  ///< of the scenes
  std::set<std::string> said;             ///< warnings of compiling
  SeriesCheck check_lattice = series_check();
  JobCommunicator* ranks = nullptr;  ///< that share the work; nullptr: there are none
  double begin = 0, end = 1;         ///< share of all the pictures' work that this one is
};

/// Messages about a run that did not come to its end.
/// @return the exit status
int conclude(const Picture& picture, const RenderStatistics& statistics, const Execution& execution,
             bool rendering_stopped, bool truth_missing, bool goes_on) {
  const RenderOptions& options = picture.options;
  const CameraSpec& camera = picture.document.scene.camera;
  const bool stopped = execution.stop.stop_requested();
  const char* const missing = truth_missing ? ", without its layers of ground truth" : "";
  if (stopped && statistics.complete)
    say(fmt::format("stopped; {} holds the whole picture{}{}", options.output, missing,
                    options.frames ? "; continue with " + how_to_go_on(options, camera) : ""));
  else if (rendering_stopped)
    say(fmt::format("stopped; {} holds the rendered part, marked partial{}; continue with {}",
                    options.output, missing, how_to_go_on(options, camera)));
  if (!stopped && !statistics.complete)
    execution.warn("the time limit ended before every part of the picture had a ray; " +
                   options.output + " is marked partial; " +
                   (goes_on ? "continue with " + how_to_go_on(options, camera)
                            : std::string("give a longer --time-limit")));
  if (!stopped && !statistics.target_reached)
    say("error: the target error was not reached within the limit of samples or time: " +
        (statistics.flux > 0
             ? fmt::format("the error is below {:.3g} %", 100 * statistics.relative_error_bound)
             : std::string("the picture is black")));
  return stopped || !statistics.target_reached ? 1 : 0;
}

/// Files of a series that have another lattice than the first are refused, with their place.
void check_series(const Picture& picture, const Scene& now, const SeriesCheck& check) {
  if (!picture.timeline) return;
  const std::string folder = std::filesystem::path(now.file).parent_path().string();
  for (const SceneTimeline::FlameTime& flame : picture.timeline->flames()) {
    if (flame.files.empty()) continue;
    FlameSpec first = now.flames[flame.flame];
    first.file = flame.first_file;
    try {
      check(flame.flame, first, folder);
      check(flame.flame, now.flames[flame.flame], folder);
    } catch (const InputError& error) {
      throw InputError(picture.document.positions.find(fmt::format("flames[{}].file", flame.flame)),
                       error.what());
    }
  }
}

/// Renders one light field.
/// @param earlier run to continue; nullptr: none
int render_one(const Picture& picture, RenderRun& run, const std::stop_token& stop,
               const Continuation* earlier = nullptr) {
  const RenderOptions& options = picture.options;
  const SceneDocument& document = picture.document;
  ProgressBar bar(options.quiet);
  Execution execution;
  execution.threads = options.threads;
  if (run.ranks && options.threads == 0) execution.threads = default_threads(*run.ranks);
  execution.stop = stop;
  bar.connect(execution);
  execution = share_of(execution, run.begin, run.end);
  Execution compiling = execution;
  compiling.message = [&](Severity severity, const std::string& text) {
    if (run.said.insert(text).second) execution.message(severity, text);
  };
  std::vector<IssueCode> unsaid;
  if (options.white) unsaid.push_back(IssueCode::no_flame);  // its light comes from everywhere
  double compile_seconds = 0;
  int flames_loaded = 0;
  const MediumLoader loader = [&, load = medium_loader()](const auto&... arguments) {
    ++flames_loaded;
    return load(arguments...);
  };
  // Only frames come back to a view.
  const SceneUse use{options.frames ? picture.view : 0, picture.begin};
  const auto compiled = [&](const Scene& scene) -> const CompiledScene& {
    const auto start = std::chrono::steady_clock::now();
    if (run.ranks) announce_scene(scene, use, options.white, options.threads, *run.ranks);
    run.newest = &run.scenes.of(scene, use, [&](const EarlierScenes& known) {
      check_series(picture, scene, run.check_lattice);
      CompiledScene made = compile(scene, loader, compiling, document.positions, known, unsaid);
      if (options.white) fill_with_light(made);
      return made;
    });
    compile_seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return *run.newest;
  };
  const std::vector<SceneMoment> moments = picture.moments();
  RenderSettings settings =
      earlier ? continued_settings(options, *earlier) : render_settings_of(options, document.scene);
  settings.ranks = run.ranks;
  if (run.ranks && settings.estimator == Estimator::forward)
    execution.warn("bundles of the forward estimator are traced by rank 0 alone");
  if (options.checkpoint) settings.checkpoint_seconds = *options.checkpoint;
  RunRecord record = record_of(picture, moments, settings);
  add_exposure(picture, settings, record);
  if (earlier) {
    record.seconds = earlier->record.seconds;
    record.numbers.insert(earlier->record.numbers.begin(), earlier->record.numbers.end());
    for (const auto& [key, text] : earlier->record.texts) record.texts[key] = text;
    settings.resume = &earlier->film;
    // All of the limit, as far as it is the run's and not only its rest's.
    if (settings.time_limit > 0 && !earlier->exposure) record.settings.time_limit += record.seconds;
  }
  const std::string state = state_path(options.output);
  StateKeeper keeper(state, record, execution);
  settings.checkpoint = [&](const Film& film) { keeper.offer(film); };
  const double share = rendering_share(options.truth, settings);
  ExposureKeeping keeping;
  if (earlier && earlier->exposure) keeping.resume = &*earlier->exposure;
  keeping.keep = [&](const ExposureState& exposure, const Film& current) {
    keeper.offer(exposure, current);
  };
  RenderResult result =
      render_exposure(moments, compiled, settings, share_of(execution, 0, share), keeping);
  const bool rendering_stopped = stop.stop_requested();
  if (rendering_stopped &&
      (result.light_field.channels.empty() || (!(result.statistics.rays > 0) && !earlier))) {
    bar.finish();
    const bool goes_on = options.frames || keeper.has_kept();
    say(fmt::format("stopped before {} was rendered; {}{}",
                    moments.size() > 1 ? "every moment of " + options.output : "anything",
                    keeper.has_kept() ? "its state is saved; " : "",
                    goes_on ? "continue with " + how_to_go_on(options, document.scene.camera)
                            : "nothing was written"));
    return 1;
  }
  describe(*run.newest, result.light_field);
  put_exposure(record, result.statistics.flux, result.light_field);
  if (options.white) result.light_field.texts["white"] = "1 W/(m^2 sr)";
  if (earlier && earlier->picture && !options.truth)  // of the same scene
    result.light_field.layers = earlier->picture->layers;
  const auto save = [&] {
    write_light_field(options.output, result.light_field, {}, exr_compression(options.compression));
    if (result.statistics.complete) std::filesystem::remove(state);
  };
  if (!result.statistics.complete && moments.size() == 1) keeper.offer(result.film);
  // The picture took long to render: it is kept even if the ground truth cannot be added.
  if (options.truth && result.statistics.complete &&
      result.statistics.seconds > settings.checkpoint_seconds)
    save();
  const double truth_seconds =
      options.truth ? add_truth(*run.newest, result.light_field, share_of(execution, share, 1))
                    : kNoTruth;
  bar.finish();
  save();
  Report report = report_of(result.statistics, compile_seconds);
  report.add_json("flames_loaded", flames_loaded);
  add_exposure(result.light_field, report);
  if (truth_seconds >= 0)
    report.add("ground truth", fmt::format("{:.4g} s, one ray a pixel", truth_seconds),
               "seconds_truth", truth_seconds);
  if (!options.stats.empty()) write_file(options.stats, report.json_text());
  if (options.frames && !options.json && !options.quiet)
    std::cout << frame_line(options.output, result.statistics, compile_seconds) << std::endl;
  else if (options.json || !options.quiet)
    print(report, options.json);
  if (options.white) run.scenes.clear(), run.newest = nullptr;  // its light is not the scene's
  return conclude(picture, result.statistics, execution, rendering_stopped,
                  options.truth && truth_seconds < 0, moments.size() == 1);
}

/// Ground truth is of one moment. @throws UsageError
void check_truth(const RenderOptions& options, const SceneInTime& scene) {
  if (options.truth && scene.timeline && scene.moments().size() > 1)
    throw UsageError(
        "--truth needs one moment, but the exposure covers several; use --set "
        "camera.sensor.exposure_time=0s");
}

/// Continues a run, by its record and the options.
int go_on(Picture picture, const Continuation& earlier, RenderRun& run,
          const std::stop_token& stop) {
  RenderOptions& options = picture.options;
  options.white = earlier.record.white;
  options.truth = options.truth || earlier.record.truth;
  check_truth(options, picture);
  if (options.stats.empty()) options.stats = earlier.record.stats;
  if (options.compression.empty()) options.compression = earlier.record.compression;
  return render_one(picture, run, stop, &earlier);
}

int resume(const RenderOptions& options, JobCommunicator* ranks, const std::stop_token& stop) {
  check_files(options);
  const Continuation earlier = read_continuation(options);
  RenderRun run;
  run.ranks = ranks;
  return go_on({earlier.scene, options}, earlier, run, stop);
}

/// Renders a frame of several: continues one that was begun, keeps one that is complete.
int render_frame(const Picture& picture, RenderRun& run, const std::stop_token& stop) {
  RenderOptions options = picture.options;
  if (options.resume.empty()) return render_one(picture, run, stop);
  options.resume = options.output;
  if (std::filesystem::exists(state_path(options.output))) {
    Picture same = picture;
    same.options = options;
    return go_on(same, read_continuation(options, &picture), run, stop);
  }
  if (!frame_is_done(picture, render_settings_of(options, picture.document.scene)))
    return render_one(picture, run, stop);
  if (!options.quiet && !options.json) std::cout << options.output << ": done before" << std::endl;
  return kSuccess;
}

int run_render(const RenderArguments& arguments, JobCommunicator* ranks,
               const std::stop_token& stop) {
  if (!arguments.options.scene.empty()) check_is_scene(arguments.options.scene);
  const RenderOptions asked = checked_options(arguments);
  if (!asked.resume.empty() && !asked.frames) return resume(asked, ranks, stop);
  const std::vector<Picture> pictures = pictures_of(asked);
  // Errors in any of the pictures are reported before the first is begun.
  for (const Picture& picture : pictures) {
    check_window(picture.options, picture.document.scene.camera.sensor);
    check_files(picture.options);
    if (asked.part &&
        !has_fixed_samples(render_settings_of(picture.options, picture.document.scene)))
      throw UsageError(
          "--part cannot be used with the forward estimator; render pictures with several --seed "
          "and merge them");
    check_truth(picture.options, picture);
  }
  if (pictures.front().timeline && !asked.frames && !asked.time && !asked.quiet)
    say("the scene changes with time, and this is its first frame; choose others with --frames or "
        "--time");
  int status = 0;
  RenderRun run;
  run.ranks = ranks;
  const auto count = static_cast<double>(pictures.size());
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Picture& picture = pictures[i];
    const RenderOptions& options = picture.options;
    run.begin = static_cast<double>(i) / count;
    run.end = static_cast<double>(i + 1) / count;
    if (pictures.size() > 1 && !asked.frames && !options.json && !options.quiet)
      std::cout << options.output << '\n';
    status = std::max(status, render_frame(picture, run, stop));
    if (stop.stop_requested()) break;
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
  on_chosen(command, registry, [arguments, ranks = registry.ranks](const std::stop_token& stop) {
    return run_render(*arguments, ranks, stop);
  });
}

}  // namespace plenoflame::cli
