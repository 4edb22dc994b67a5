#include "commands/series/sweep_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <filesystem>
#include <memory>
#include <sstream>
#include <utility>

#include "commands/part_option.h"
#include "commands/render/render_pictures.h"
#include "commands/scene_input.h"
#include "medium_loader.h"
#include "options.h"
#include "plenoflame/base/available_memory.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/text_file.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/input_files.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/scene_settings.h"
#include "plenoflame/scene/timeline.h"
#ifdef PLENOFLAME_HAS_VOLUMES
#include "plenoflame/volumes/flame_generators.h"
#endif

namespace plenoflame::cli {
namespace {

constexpr const char* kGenerator = ".generator";

/// A key about a generated flame: the flame's path and the name of the parameter, or nothing for
/// the generator itself.
struct GeneratorKey {
  std::string flame, parameter;
};

std::optional<GeneratorKey> generator_key(const std::string& key) {
  const auto at = key.rfind(kGenerator);
  if (at == std::string::npos || !key.starts_with("flames")) return std::nullopt;
  const std::string rest = key.substr(at + std::string_view(kGenerator).size());
  if (!rest.empty() && rest[0] != '.') return std::nullopt;
  return GeneratorKey{key.substr(0, at), rest.empty() ? "" : rest.substr(1)};
}

int flame_number(const Scene& scene, const std::string& path) {
  const std::string text = resolve_path(scene, path + ".position");
  int number = -1;
  const char* const begin = text.data() + std::min(text.size(), std::string_view("flames[").size());
  std::from_chars(begin, text.data() + text.size(), number);
  if (number < 0 || number >= static_cast<int>(scene.flames.size()))
    throw InputError(fmt::format("there is no flame '{}'; the scene has {}, from flames[0]", path,
                                 scene.flames.size()));
  return number;
}

std::array<int, 3> lattice_option(const std::string& text) {
  std::array<int, 3> count{};
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) words.push_back(word);
  if (words.size() == 1) words.assign(3, words.front());
  if (words.size() != 3)
    throw UsageError("--lattice must be the cells along x, y and z, 'NX,NY,NZ' or N, not '" + text +
                     "'");
  for (std::size_t i = 0; i < 3; ++i)
    count[i] = whole_number_option("--lattice", words[i], 1, 1024);
  return count;
}

/// The box around the flames of the scene as it stands.
Box box_of_flames(const RenderOptions& options) {
  RenderOptions one = options;
  one.output = "scene.exr";
  const Picture picture = pictures_of(one).front();
  try {
    const CompiledScene compiled = compile(picture.moments().front().scene, medium_loader());
    if (compiled.medium && !compiled.medium->bounds().empty()) return compiled.medium->bounds();
  } catch (const FileError& error) {
    throw FileError(std::string(error.what()) + "; give the box of --lattice with --region");
  }
  throw UsageError(
      "--lattice: the scene has no flame that gives the box of the lattice; give --region");
}

TruthLattice lattice_of(const SweepArguments& arguments, const RenderOptions& options,
                        const Scene& scene) {
  TruthLattice lattice;
  lattice.count = lattice_option(arguments.lattice);
  const double cells =
      1.0 * lattice.count[0] * lattice.count[1] * static_cast<double>(lattice.count[2]);
  const bool lines = std::any_of(scene.flames.begin(), scene.flames.end(),
                                 [](const FlameSpec& flame) { return !flame.lines.empty(); });
  // Temperature and absorption; of lines the places, and their light twice.
  const double bytes_of_cell = lines ? 8 + 36 : 8;
  require_memory(bytes_of_cell * cells, fmt::format("--lattice: the truth in {:g} cells", cells),
                 "take fewer cells along x, y or z");
  lattice.box =
      arguments.region.empty() ? box_of_flames(options) : box_option("--region", arguments.region);
  return lattice;
}

nlohmann::ordered_json plan_text(const SweepPlan& plan, const SceneDocument& document) {
  const SweepArguments& a = plan.arguments;
  nlohmann::ordered_json json;
  json["format"] = a.format;
  json["version"] = version();
  json["part"] = to_string(plan.part);
  json["runs"] = plan.runs.size();
  json["seed"] = plan.seed();
  json["test_share"] = a.sweep.test_share;
  json["samples"] = a.render.samples;
  json["target_error"] = a.render.target_error;
  json["estimator"] = a.render.estimator;
  json["window"] = a.render.window;
  json["cameras"] = plan.options.cameras;
  json["truth_layers"] = plan.options.truth;
  if (plan.lattice) {
    const Box& box = plan.lattice->box;
    json["lattice"] = {{"cells", plan.lattice->count},
                       {"lower_m", {box.lower.x, box.lower.y, box.lower.z}},
                       {"upper_m", {box.upper.x, box.upper.y, box.upper.z}}};
  }
  const bool drawn = a.sweep.table.empty();
  json[drawn ? "rules" : "table"] = read_file(drawn ? a.sweep.random : a.sweep.table);
  json["scene"] = write_scene(document.scene);
  json["files"] = nlohmann::json::array();
  for (const InputFile& file : input_files(document.scene))
    json["files"].push_back({file.name, file.size});
  return json;
}

void check_run(const SweepPlan& plan, int run) {
  const RunSettings settings = plan.settings(run);
#ifdef PLENOFLAME_HAS_VOLUMES
  for (const auto& [number, flame] : settings.flames) {
    const std::string key = fmt::format("flames[{}]{}", number, kGenerator);
    if (flame.generator.empty())
      throw InputError(fmt::format(
          "{} is missing; name the generator of the flame, such as {} = \"candle\"", key, key));
    const FlameGenerator& generator = flame_generator(flame.generator);
    for (const auto& [name, value] : flame.values) {
      try {
        check_flame_value(generator, name, value);
      } catch (const InputError& error) {
        throw InputError(fmt::format("{}.{}: {}", key, name, error.what()));
      }
    }
  }
#else
  if (!settings.flames.empty())
    throw InputError("generated flames need OpenVDB, which this build was made without");
#endif
  for (const Picture& picture : pictures_of(plan.options_of(run))) {
    check_window(picture.options, picture.document.scene.camera.sensor);
    for (const auto& [number, flame] : settings.flames)
      if (picture.document.scene.flames.at(static_cast<std::size_t>(number)).kind != FlameKind::vdb)
        throw InputError(
            fmt::format("flames[{}]{}: a generated flame takes the place of a file; give the "
                        "scene's flame kind = \"vdb\"",
                        number, kGenerator));
  }
}

/// Properties that pictures in one array must share.
std::string shape_of(const SweepPlan& plan, int run) {
  std::string text;
  for (const Picture& picture : pictures_of(plan.options_of(run))) {
    const Scene& scene = picture.document.scene;
    text += fmt::format("{} {}x{}", scene.camera.name, scene.camera.sensor.columns,
                        scene.camera.sensor.rows);
    for (const ChannelSpec& channel : scene.channels) text += " " + channel.name;
  }
  return text;
}

/// Checks the runs of the part. @throws the error of the first that is wrong
void check_runs(const SweepPlan& plan, const Execution& execution) {
  const auto checked = [&](int run) {
    try {
      check_run(plan, run);
      if (plan.packs() && run > 0 && shape_of(plan, run) != shape_of(plan, 0))
        throw InputError(
            "its pictures differ from those of run 0 in size or channels, and one HDF5 file cannot "
            "hold both; use --format exr");
    } catch (const FileError&) {
      throw;
    } catch (const Error& error) {
      throw_of_run(plan, run, error.what());
    }
  };
  std::vector<std::exception_ptr> wrong(plan.runs.size());
  if (!parallel_for(execution, plan.runs.size(), [&](std::size_t run, int) {
        if (!plan.is_mine(static_cast<int>(run))) return;
        try {
          checked(static_cast<int>(run));
        } catch (...) {
          wrong[run] = std::current_exception();
        }
      }))
    throw Cancelled();
  for (const std::exception_ptr& error : wrong)
    if (error) std::rethrow_exception(error);
}

}  // namespace

std::string run_name(int run) {
  return fmt::format("{:06}", run);
}

void throw_of_run(const SweepPlan& plan, int run, const std::string& message) {
  const SweepRun& values = plan.runs[static_cast<std::size_t>(run)];
  const std::string which = plan.arguments.sweep.table.empty() ? fmt::format("run {}: ", run) : "";
  std::string text = message;
  if (text.starts_with("--set ")) text.erase(0, 6);
  for (const SweepValue& value : values)
    if (!value.key.empty() &&
        (text.starts_with(value.key + ":") || text.starts_with(value.key + " ")))
      throw InputError(value.position, which + text);
  SourcePosition row = values.front().position;
  row.column = 0;
  throw InputError(row, which + text);
}

RunSettings SweepPlan::settings(int run) const {
  RunSettings result;
  result.set = options.set;
  const Scene* scene = nullptr;
  SceneDocument document;
  for (const SweepValue& value : runs[static_cast<std::size_t>(run)]) {
    if (value.key.empty()) continue;
    const auto generated = generator_key(value.key);
    if (!generated) {
      result.set.push_back(value.key + "=" + value.value);
      continue;
    }
    if (!scene) {
      document = read_scene(options.scene, options.set);
      scene = &document.scene;
    }
    GeneratedFlame& flame = result.flames[flame_number(*scene, generated->flame)];
    if (generated->parameter.empty())
      flame.generator = value.value;
    else
      flame.values[generated->parameter] = value.value;
  }
  for (const auto& [number, flame] : result.flames)
    result.set.push_back(
        fmt::format("flames[{}].file={}-flame{}.vdb", number, run_name(run), number));
  return result;
}

RenderOptions SweepPlan::options_of(int run) const {
  RenderOptions one = options;
  one.set = settings(run).set;
  one.output = folder + "/runs/" + run_name(run) + ".exr";
  one.seed = seed_of_run(seed(), run);
  return one;
}

SweepPlan plan_sweep(const SweepArguments& arguments, const Execution& execution, RunsAre runs) {
  SweepPlan plan;
  plan.arguments = arguments;
  check_is_scene(arguments.render.options.scene);
  RenderArguments render = arguments.render;
  render.options.output = "run.exr";
  plan.options = checked_options(render);
  plan.options.output_given = false;
  if (!arguments.part.empty()) plan.part = part_option("--part", arguments.part);
  plan.folder = arguments.output;
  while (plan.folder.size() > 1 && plan.folder.back() == '/') plan.folder.pop_back();
  if (!plan.part.is_whole()) plan.folder += "-" + part_ending(plan.part);
  SweepRuns drawn = runs_of(arguments.sweep);
  plan.runs = std::move(drawn.values);
  plan.test = std::move(drawn.test);
  const int count = static_cast<int>(plan.runs.size());
  if (plan.part.count > count)
    throw UsageError(
        fmt::format("--part: there are {} runs, fewer than {} parts", count, plan.part.count));
  const SceneDocument document = read_scene(plan.options.scene, plan.options.set);
  if (runs == RunsAre::unchecked) check_runs(plan, execution);
  if (!arguments.lattice.empty())
    plan.lattice = lattice_of(arguments, plan.options, document.scene);
  else if (!arguments.region.empty())
    throw UsageError("--region needs --lattice");
  plan.text = plan_text(plan, document);
  return plan;
}

}  // namespace plenoflame::cli
