#include "plenoflame/volumes/scene_session.h"

#include <algorithm>
#include <utility>

#include "field.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/spectral.h"
#include "plenoflame/scene/timeline.h"
#include "plenoflame/scene/validate.h"
#include "plenoflame/volumes/load_medium.h"

namespace plenoflame {

SceneSession::SceneSession(const SceneSession& other)
    : document_(other.document_), flames_(other.flames_), camera_(other.camera_) {}

SceneSession& SceneSession::operator=(const SceneSession& other) {
  if (this == &other) return *this;
  document_ = other.document_;
  flames_ = other.flames_;
  camera_ = other.camera_;
  forget();
  return *this;
}

void SceneSession::read_file(const std::string& path) {
  SceneDocument document = read_scene_file(path);
  validate(document);
  set_document(std::move(document));
  camera_.clear();
}

void SceneSession::read_text(const std::string& text, const std::string& name) {
  SceneDocument document = parse_scene(text, name);
  validate(document);
  set_document(std::move(document));
  camera_.clear();
}

void SceneSession::set_document(SceneDocument document) {
  document_ = std::move(document);
  forget();
}

Scene& SceneSession::change() {
  forget();
  return document_.scene;
}

void SceneSession::set_flame(const std::string& name, FlameFields flame) {
  flames_[name] = std::make_shared<const FlameFields>(std::move(flame));
  forget();
}

void SceneSession::set_camera(const std::string& name) {
  if (!name.empty()) static_cast<void>(for_camera(scene(), name));
  const std::lock_guard lock(compiling_);
  camera_ = name;
}

Scene SceneSession::scene_of_camera() const {
  return for_camera(scene(), camera_);
}

namespace {

SceneTimeline timeline_of(const SceneDocument& document, const std::string& camera) {
  return SceneTimeline(camera.empty() ? document : for_camera(document, camera));
}

}  // namespace

std::pair<int, int> SceneSession::frames() const {
  if (!changes_with_time(document_.scene)) return {0, -1};
  const SceneTimeline timeline = timeline_of(document_, camera_);
  if (!(timeline.frame_rate() > 0)) return {0, -1};
  return {timeline.first_frame(), timeline.last_frame()};
}

void SceneSession::move_to_time(double time) {
  Scene moment = SceneTimeline(document_).at_time(time);
  change() = std::move(moment);
}

void SceneSession::move_to_frame(int frame) {
  move_to_time(timeline_of(document_, camera_).begin_of(frame));
}

void SceneSession::forget() {
  const std::lock_guard lock(compiling_);
  compiled_.clear();
}

std::shared_ptr<const CompiledScene> SceneSession::compile(const Execution& execution,
                                                           const std::vector<IssueCode>& unsaid) {
  const std::lock_guard lock(compiling_);
  std::shared_ptr<const CompiledScene>& compiled = compiled_[camera_];
  if (compiled) return compiled;
  const auto load = [this](const FlameSpec& flame, const std::string& folder,
                           const std::vector<SourceFunction>& channels,
                           const Execution& run) -> std::shared_ptr<const Medium> {
    // A flame that was handed over stands in for the file of its name.
    const auto kept = flame.kind == FlameKind::vdb ? flames_.find(flame.file) : flames_.end();
    if (kept == flames_.end()) return load_medium(flame, folder, channels, run);
    return medium_in_memory(*kept->second, flame, channels);
  };
  EarlierScenes earlier;
  for (const auto& other : compiled_)
    if (other.second) earlier.push_back(other.second.get());
  compiled = std::make_shared<const CompiledScene>(
      plenoflame::compile(for_camera(document_, camera_), load, execution, earlier, unsaid));
  return compiled;
}

std::unique_ptr<Medium> medium_in_memory(const FlameFields& grids, const FlameSpec& spec,
                                         const std::vector<SourceFunction>& channels) {
  if (spec.temperature != GridSpec{} || spec.absorption != GridSpec{} ||
      !spec.scattering.grid.empty())
    throw InputError("flame \"" + spec.file +
                     "\" is in memory, in K and 1/m, so it takes no mapping of grids and no grid "
                     "of albedos; write it to a file for these");
  FlameFields flame{grids.temperature, grids.absorption};
  for (const LineSpec& line : spec.lines) {
    const auto names = line_grid_names(line.kind);
    const auto found =
        std::find_if(grids.lines.begin(), grids.lines.end(), [&](const VoxelField& field) {
          return line.emission.grid.empty()
                     ? std::find(names.begin(), names.end(), detail::lower_case(field.name)) !=
                           names.end()
                     : line.emission.grid == field.name;
        });
    if (found == grids.lines.end())
      throw InputError("flame \"" + spec.file + "\" has no array for the emission line \"" +
                       std::string(line_word(line.kind)) + "\"");
    flame.lines.push_back(*found);
  }
  return make_flame_medium(std::move(flame), spec, channels);
}

}  // namespace plenoflame
