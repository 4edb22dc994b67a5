#include <algorithm>
#include <cmath>
#include <exception>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <tuple>
#include <utility>

#include "camera_optimizer.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/design_report.h"

namespace plenoflame {
namespace {

/// Two lengths with a comma between [m].
std::pair<double, double> two_lengths(const std::string& name, const std::string& text) {
  const auto comma = text.find(',');
  if (comma == std::string::npos)
    throw UsageError(name + " needs two lengths, separated by a comma");
  return {quantity_option(name, text.substr(0, comma), Dimension::length),
          quantity_option(name, text.substr(comma + 1), Dimension::length)};
}

MeritSpec merit_of(const OptimizeRequest& request) {
  const SettingNames& names = request.names;
  const auto needed = [&](const std::string& text, const char* name) {
    if (text.empty()) throw UsageError(names("merit", request.merit) + " needs " + names(name));
  };
  MeritSpec spec;
  if (request.merit == "depth") {
    needed(request.array_range, "array-range");
    const std::string name = names("array-range");
    spec.kind = MeritKind::depth;
    std::tie(spec.array_near, spec.array_far) = two_lengths(name, request.array_range);
    if (spec.array_near == 0 || spec.array_far == 0)
      throw UsageError(name + " must not contain 0, the array itself");
    if (!(1 / spec.array_near > 1 / spec.array_far))
      throw UsageError(name + ": give the near end first; a negative far end is past infinity");
    return spec;
  }
  if (request.merit == "light") {
    spec.kind = MeritKind::light;
    return spec;
  }
  needed(request.depths, "depths");
  std::tie(spec.near, spec.far) = two_lengths(names("depths"), request.depths);
  if (!(spec.near > 0 && spec.far >= spec.near))
    throw UsageError(names("depths") + " needs two object distances, the near one first");
  spec.kind = request.merit == "volume" ? MeritKind::volume : MeritKind::resolution;
  if (spec.kind == MeritKind::volume) {
    needed(request.height, "height");
    spec.height = quantity_option(names("height"), request.height, Dimension::length);
    if (!(spec.height > 0)) throw UsageError(names("height") + " must be positive");
  }
  return spec;
}

/// The camera with another number of types: further ones by the rule that joins them.
CameraSpec with_types(const CameraSpec& camera, int count, const OptimizerTask& task) {
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
  change.freedom = task.freedom;
  change.limits = task.limits;
  return changed_camera(result, change);
}

nlohmann::json state_json(const CameraSpec& spec, const MeritSpec& judged, bool traced) {
  const Camera camera(spec);
  nlohmann::json lengths = nlohmann::json::array();
  for (const Microlens& lens : camera.microlenses())
    lengths.push_back(lens.first_order.focal_length);
  const FirstOrder& lens = camera.lens_first_order();
  nlohmann::json state = {{"merit_paraxial", merit(camera, judged, false)},
                          {"merit_traced", nullptr},
                          {"pitch_m", spec.array.pitch},
                          {"sensor_distance_m", camera.microlenses().front().sensor_distance},
                          {"entrance_pupil_m", lens.entrance_pupil_diameter},
                          {"object_distance_m", spec.focus.object_distance},
                          {"focal_lengths_m", lengths},
                          {"overlap_pixels", overlap_pixels(camera)}};
  if (traced) state["merit_traced"] = merit(camera, judged, true);
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

}  // namespace

MicrolensFreedom freedom_named(const std::string& word) {
  return word == "index"    ? MicrolensFreedom::index
         : word == "radius" ? MicrolensFreedom::radius
                            : MicrolensFreedom::thickness;
}

template <>
std::span<const SettingRow<OptimizeRequest>> setting_rows() {
  using R = OptimizeRequest;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"merit", "NAME",
       "depth: types cover the array range without a gap; resolution: least over the depths; "
       "volume: resolved pixels along the flame at the depths; light: light per pixel",
       &R::merit, any_of("depth", "resolution", "volume", "light")},
      {"vary", "LIST",
       "Parameters to vary: focal (lengths of the types), pitch, spacing (B), aperture, focus, "
       "types (their number)",
       &R::vary},
      {"bound", "FACTOR", "Greatest factor of each parameter", &R::bound, between(1.0001, 100)},
      {"array-range", "LENGTH,LENGTH",
       "Near and far end in front of the array; far < 0: past infinity", &R::array_range, lengths},
      {"depths", "LENGTH,LENGTH",
       "Near and far object distance from the front vertex, such as 0.9m,1.1m", &R::depths,
       lengths},
      {"height", "LENGTH", "Height of the flame", &R::height, lengths},
      {"types", "N", "Number of types; without it, as in the scene", &R::types, between(1, 3)},
      {"free", "index|radius", "Sets the focal length of real microlenses", &R::free,
       any_of("index", "radius")},
      {"greatest-index", "INDEX", "Greatest refractive index of the microlenses",
       &R::greatest_index, between(1, 5)},
      {"overlap", "PIXELS",
       "Overlap of neighbouring micro-images (0; that of the scene if only focal lengths vary)",
       &R::overlap, between(0, 1e6)},
      {"paraxial", "", "Use only the paraxial formulas, no rays", &R::paraxial},
      {"time-limit", "SECONDS", "Of the search with rays [s]", &R::time_limit, between(0.1, 1e5)}};
  return rows;
}

BetterCamera optimize_camera(const OptimizeRequest& request, const CameraSpec& start,
                             const std::stop_token& stop) {
  OptimizerTask task;
  task.merit = merit_of(request);
  std::istringstream words(request.vary);
  for (std::string word; std::getline(words, word, ',');) {
    check_choice(request.names("vary"), word,
                 {"focal", "pitch", "spacing", "aperture", "focus", "types"});
    task.vary.push_back(word);
  }
  task.bound = request.bound;
  task.freedom = freedom_named(request.free);
  task.limits.greatest_index = request.greatest_index;
  task.time_limit = request.time_limit;
  task.overlap = request.overlap;
  task.stop = stop;
  task.traced = !request.paraxial &&
                (task.merit.kind == MeritKind::resolution || task.merit.kind == MeritKind::volume);
  if (!start.array.present) throw InputError("the camera has no microlens array to optimise");
  std::vector<int> counts{request.types.value_or(static_cast<int>(start.array.types.size()))};
  if (std::ranges::count(task.vary, "types") > 0) counts = {1, 2, 3};
  const nlohmann::json before = state_json(start, task.merit, task.traced);
  std::optional<OptimizerResult> best;
  int evaluations = 0;
  std::exception_ptr trouble;
  for (const int count : counts) {
    try {
      OptimizerResult result = optimize_camera(with_types(start, count, task), task);
      evaluations += result.evaluations;
      // A further type has to earn its place.
      if (!best || result.merit > best->merit + 1e-6 * std::fabs(best->merit))
        best = std::move(result);
    } catch (const InputError&) {
      trouble = std::current_exception();
    }
  }
  if (!best) std::rethrow_exception(trouble);
  BetterCamera found{std::move(best->camera), {}};
  const nlohmann::json after = state_json(found.camera, task.merit, task.traced);
  found.report.add("merit", request.merit, "merit", request.merit);
  add_state("before", before, found.report);
  add_state("after", after, found.report);
  found.report.add_json("before", before);
  found.report.add_json("after", after);
  found.report.add("evaluations", std::to_string(evaluations), "evaluations", evaluations);
  return found;
}

}  // namespace plenoflame
