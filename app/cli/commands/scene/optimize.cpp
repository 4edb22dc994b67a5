#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "camera_optimizer.h"
#include "choice.h"
#include "commands/commands.h"
#include "commands/scene/design_array.h"
#include "commands/scene_input.h"
#include "design_report.h"
#include "messages.h"
#include "number_range.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/scene_file.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

struct OptimizeArguments {
  std::string scene, camera, output;
  std::vector<std::string> set;
  std::string merit = "resolution";
  std::vector<std::string> vary{"focal"};
  std::string array_range, depths, height;
  std::string freedom = "index";
  double bound = 2, greatest_index = 2;
  double time_limit = 50;
  std::optional<double> overlap;
  int types = 0;
  bool paraxial = false, json = false;
};

MeritSpec merit_spec(const OptimizeArguments& settings) {
  MeritSpec spec;
  const auto pair = [](const char* option, const std::string& text) {
    const auto comma = text.find(',');
    if (comma == std::string::npos)
      throw UsageError(std::string(option) + " needs two lengths, separated by a comma");
    return std::pair{quantity_option(option, text.substr(0, comma), Dimension::length),
                     quantity_option(option, text.substr(comma + 1), Dimension::length)};
  };
  const auto needed = [](const std::string& text, const char* option, const char* merit) {
    if (text.empty()) throw UsageError(std::string("--merit ") + merit + " needs " + option);
  };
  if (settings.merit == "depth") {
    needed(settings.array_range, "--array-range", "depth");
    spec.kind = MeritKind::depth;
    std::tie(spec.array_near, spec.array_far) = pair("--array-range", settings.array_range);
    if (spec.array_near == 0 || spec.array_far == 0)
      throw UsageError("--array-range must not contain 0, the array itself");
    if (!(1 / spec.array_near > 1 / spec.array_far))
      throw UsageError(
          "--array-range: give the near end first; a negative far end is past infinity");
    return spec;
  }
  if (settings.merit == "light") {
    spec.kind = MeritKind::light;
    return spec;
  }
  needed(settings.depths, "--depths", settings.merit.c_str());
  std::tie(spec.near, spec.far) = pair("--depths", settings.depths);
  if (!(spec.near > 0 && spec.far >= spec.near))
    throw UsageError("--depths needs two object distances, the near one first");
  spec.kind = settings.merit == "volume" ? MeritKind::volume : MeritKind::resolution;
  if (spec.kind == MeritKind::volume) {
    needed(settings.height, "--height", "volume");
    spec.height = quantity_option("--height", settings.height, Dimension::length);
    if (!(spec.height > 0)) throw UsageError("--height must be positive");
  }
  return spec;
}

/// The scene's camera with another number of types: further ones by the rule that joins them.
CameraSpec with_types(const CameraSpec& camera, int count, const OptimizeArguments& settings) {
  CameraSpec result = camera;
  auto& types = result.array.types;
  if (count < static_cast<int>(types.size())) types.resize(static_cast<std::size_t>(count));
  if (count <= static_cast<int>(types.size())) return result;
  const Camera compiled(camera);
  const auto lengths =
      joined_focal_lengths(compiled.microlenses().front().first_order.focal_length,
                           compiled.microlenses().front().sensor_distance, camera.array.diameter,
                           camera.sensor.pixel_pitch, count);
  while (static_cast<int>(types.size()) < count) {
    types.push_back(types.front());
    types.back().name = "type" + std::to_string(types.size());
  }
  CameraChange change;
  change.focal_lengths = lengths;
  change.freedom = freedom_named(settings.freedom);
  change.limits.greatest_index = settings.greatest_index;
  return changed_camera(result, change);
}

nlohmann::json state_json(const CameraSpec& spec, const MeritSpec& merit_of, bool traced) {
  const Camera camera(spec);
  nlohmann::json lengths = nlohmann::json::array();
  for (const Microlens& lens : camera.microlenses())
    lengths.push_back(lens.first_order.focal_length);
  const FirstOrder& lens = camera.lens_first_order();
  nlohmann::json state = {{"merit_paraxial", merit(camera, merit_of, false)},
                          {"merit_traced", nullptr},
                          {"pitch_m", spec.array.pitch},
                          {"sensor_distance_m", camera.microlenses().front().sensor_distance},
                          {"entrance_pupil_m", lens.entrance_pupil_diameter},
                          {"object_distance_m", spec.focus.object_distance},
                          {"focal_lengths_m", lengths},
                          {"overlap_pixels", overlap_pixels(camera)}};
  if (traced) state["merit_traced"] = merit(camera, merit_of, true);
  return state;
}

void add_state(const std::string& when, const nlohmann::json& state, Report& report) {
  std::string lengths;
  for (const auto& f : state["focal_lengths_m"])
    lengths += (lengths.empty() ? "" : ", ") + length_text(f.get<double>());
  report.add_text(when,
                  "merit " + readable_number(state["merit_paraxial"].get<double>() + 0.0) +
                      (state["merit_traced"].is_null()
                           ? std::string()
                           : ", by rays " + readable_number(state["merit_traced"].get<double>())));
  report.add_text("  microlenses", "focal lengths " + lengths + ", pitch " +
                                       length_text(state["pitch_m"].get<double>()) + ", B " +
                                       length_text(state["sensor_distance_m"].get<double>()));
  report.add_text("  main lens",
                  "entrance pupil " + length_text(state["entrance_pupil_m"].get<double>()) +
                      ", in focus at " + length_text(state["object_distance_m"].get<double>()));
  const double overlap = state["overlap_pixels"].get<double>();
  report.add_text("  micro-images", readable_number(std::fabs(overlap)) + " pixels " +
                                        (overlap > 0 ? "overlap" : "apart"));
}

int run_optimize(const OptimizeArguments& settings) {
  if (settings.output.empty())
    throw UsageError("--output is missing; give the scene to write (.toml)");
  OptimizerTask task;
  task.merit = merit_spec(settings);
  for (const std::string& name : settings.vary) task.vary.push_back(name);
  task.bound = settings.bound;
  task.freedom = freedom_named(settings.freedom);
  task.limits.greatest_index = settings.greatest_index;
  task.time_limit = settings.time_limit;
  task.overlap = settings.overlap;
  const bool has_rays =
      task.merit.kind == MeritKind::resolution || task.merit.kind == MeritKind::volume;
  task.traced = has_rays && !settings.paraxial;
  std::vector<std::string> warnings;
  const Scene whole = read_valid_scene(settings.scene, settings.set, &warnings).scene;
  Scene scene = choose_camera({whole, {}}, settings.camera).scene;
  for (const std::string& warning : warnings) warn(warning);
  if (!scene.camera.array.present)
    throw InputError(settings.scene + ": the camera has no microlens array to optimise");
  const bool free_types =
      std::find(settings.vary.begin(), settings.vary.end(), "types") != settings.vary.end();
  std::vector<int> counts{settings.types > 0 ? settings.types
                                             : static_cast<int>(scene.camera.array.types.size())};
  if (free_types) counts = {1, 2, 3};
  const nlohmann::json before = state_json(scene.camera, task.merit, task.traced);
  std::optional<OptimizerResult> best;
  int evaluations = 0;
  std::string trouble;
  for (const int count : counts) {
    try {
      OptimizerResult result = optimize_camera(with_types(scene.camera, count, settings), task);
      evaluations += result.evaluations;
      // A further type has to earn its place.
      if (!best || result.merit > best->merit + 1e-6 * std::fabs(best->merit))
        best = std::move(result);
    } catch (const InputError& error) {
      trouble = error.what();
    }
  }
  if (!best) throw InputError(trouble);
  const std::string conjugate = scene.camera.focus.conjugate;
  scene.camera = best->camera;
  const nlohmann::json after = state_json(scene.camera, task.merit, task.traced);
  write_scene_file(settings.output, replace_camera(whole, scene.camera));
  Report report;
  report.add("merit", settings.merit, "merit", settings.merit);
  add_state("before", before, report);
  add_state("after", after, report);
  report.add_json("before", before);
  report.add_json("after", after);
  report.add("evaluations", std::to_string(evaluations), "evaluations", evaluations);
  report.add("scene", settings.output, "scene", settings.output);
  report.print(settings.json);
  return kSuccess;
}

}  // namespace

void register_optimize(const Registry& registry) {
  auto settings = std::make_shared<OptimizeArguments>();
  CLI::App& command = add_command(registry, "optimize",
                                  "Find a better camera: microlenses, spacing, aperture, focus",
                                  "plenoflame optimize camera.toml --merit depth "
                                  "--array-range \"0.4 mm,-20 mm\" -o best.toml");
  command.add_option("SCENE", settings->scene, "Scene file (.toml) with the camera to start from")
      ->required();
  add_set_option(command, settings->set);
  add_camera_option(command, settings->camera);
  command
      .add_option(
          "--merit", settings->merit,
          "depth: types cover --array-range without a gap; resolution: least over --depths; "
          "volume: resolved pixels along a flame of --height at --depths; light: light per pixel")
      ->check(one_of({"depth", "resolution", "volume", "light"}))
      ->option_text("NAME")
      ->capture_default_str();
  command
      .add_option("--vary", settings->vary,
                  "Parameters to vary: focal (lengths of the types), pitch, spacing (B), aperture, "
                  "focus, types (their number)")
      ->delimiter(',')
      ->check(one_of({"focal", "pitch", "spacing", "aperture", "focus", "types"}))
      ->option_text("LIST")
      ->capture_default_str();
  command.add_option("--bound", settings->bound, "Greatest factor of each parameter")
      ->option_text("FACTOR")
      ->check(number_between(1.0001, 100.0))
      ->capture_default_str();
  command
      .add_option("--array-range", settings->array_range,
                  "Near and far end in front of the array; far < 0: past infinity")
      ->option_text("LENGTH,LENGTH");
  command
      .add_option("--depths", settings->depths,
                  "Near and far object distance from the front vertex, such as 0.9m,1.1m")
      ->option_text("LENGTH,LENGTH");
  command.add_option("--height", settings->height, "Height of the flame")->option_text("LENGTH");
  command.add_option("--types", settings->types, "Number of types; without it, as in the scene")
      ->option_text("N")
      ->check(CLI::Range(1, 3));
  command.add_option("--free", settings->freedom, "Sets the focal length of real microlenses")
      ->check(one_of({"index", "radius"}))
      ->option_text("index|radius")
      ->capture_default_str();
  command
      .add_option("--greatest-index", settings->greatest_index,
                  "Greatest refractive index of the microlenses")
      ->option_text("INDEX")
      ->check(number_between(1.0, 5.0))
      ->capture_default_str();
  command
      .add_option(
          "--overlap", settings->overlap,
          "Overlap of neighbouring micro-images (0; that of SCENE if only focal lengths vary)")
      ->option_text("PIXELS")
      ->check(number_between(0.0, 1e6));
  command.add_flag("--paraxial", settings->paraxial, "Use only the paraxial formulas, no rays");
  command.add_option("--time-limit", settings->time_limit, "Of the search with rays [s]")
      ->option_text("SECONDS")
      ->check(number_between(0.1, 1e5))
      ->capture_default_str();
  command.add_option("-o,--output", settings->output, "The optimised scene (.toml)")
      ->check(written())
      ->option_text("SCENE.toml");
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry, [settings] { return run_optimize(*settings); });
}

}  // namespace plenoflame::cli
