#include "model/document.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include "model/scene_values.h"
#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/scene_schema.h"
#include "plenoflame/scene/scene_settings.h"
#include "plenoflame/scene/timeline.h"
#include "plenoflame/volumes/vdb_info.h"

namespace plenoflame::desktop {
namespace {

namespace fs = std::filesystem;

std::string ending_of(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

std::string moved_path(const std::string& path, const fs::path& from, const fs::path& to) {
  if (path.empty() || fs::path(path).is_absolute()) return path;
  const fs::path whole = fs::absolute(from / path).lexically_normal();
  const fs::path relative = whole.lexically_relative(fs::absolute(to).lexically_normal());
  return relative.empty() ? whole.string() : relative.string();
}

}  // namespace

Scene moved_to(Scene scene, const std::string& file) {
  const fs::path from = fs::path(scene.file).parent_path(), to = fs::path(file).parent_path();
  for (FlameSpec& flame : scene.flames) {
    flame.file = moved_path(flame.file, from, to);
    flame.time.table = moved_path(flame.time.table, from, to);
  }
  for (SolidSurfaceSpec& surface : scene.surfaces) {
    surface.file = moved_path(surface.file, from, to);
    surface.material.texture.file = moved_path(surface.material.texture.file, from, to);
  }
  for (ChannelSpec& channel : scene.channels) channel.file = moved_path(channel.file, from, to);
  scene.file = file;
  return scene;
}

bool operator==(const Selection& a, const Selection& b) {
  if (a.kind != b.kind) return false;
  switch (a.kind) {
    case Selection::Kind::none:
      return true;
    case Selection::Kind::pixel:
      return a.column == b.column && a.row == b.row;
    case Selection::Kind::microlens:
      return a.lens == b.lens;
    case Selection::Kind::point:
      return a.point == b.point;
  }
  return false;
}

Document::Document(QObject* parent) : QObject(parent) {}

std::string Document::name() const {
  return file_.empty() ? "untitled" : fs::path(file_).filename().string();
}

const CameraSpec& Document::camera() const {
  for (const CameraSpec& camera : scene().cameras)
    if (camera.name == camera_) return camera;
  return scene().camera;
}

SceneDocument Document::scene_of_camera() const {
  return for_camera(history_.state(), camera_);
}

void Document::choose_camera(const std::string& name) {
  static_cast<void>(for_camera(scene(), name));
  if (name == camera_ || scene().cameras.empty()) return;
  camera_ = name;
  image_current_ = false;
  SceneChanges changes;
  changes.camera = changes.develop = true;
  emit state_changed();
  emit scene_changed(changes);
  drop_image_of_other_size();
}

Scene Document::at_moment(const SceneDocument& scene, const std::optional<double>& time) {
  if (!time || !changes_with_time(scene.scene)) return scene.scene;
  return SceneTimeline(scene).at_time(*time);
}

void Document::choose_time(double seconds) {
  if (time_ == seconds || !changes_with_time(scene())) return;
  time_ = seconds;
  image_current_ = false;
  SceneChanges changes;
  changes.flames = changes.time = true;
  emit state_changed();
  emit scene_changed(changes);
}

void Document::keep_camera() {
  if (!changes_with_time(scene())) time_.reset();
  const std::vector<std::string> names = camera_names(scene());
  if (scene().cameras.empty())
    camera_.clear();
  else if (std::find(names.begin(), names.end(), camera_) == names.end())
    camera_ = names.front();
}

void Document::begin(SceneDocument scene, const std::string& file,
                     std::shared_ptr<const LightField> image) {
  history_.reset(std::move(scene));
  empty_ = false;
  file_ = file;
  time_.reset();
  keep_camera();
  check();
  image_ = std::move(image);
  image_current_ = image_ != nullptr;
  selection_ = {};
  emit state_changed();
  emit selection_changed();
  SceneChanges changes = SceneChanges::all();
  changes.opened = true;
  emit scene_changed(changes);
  emit image_changed();
}

void Document::drop_image_of_other_size() {
  const SensorSpec& sensor = camera().sensor;
  if (!image_ || (image_->sensor_width == sensor.columns && image_->sensor_height == sensor.rows))
    return;
  image_ = nullptr;
  image_current_ = false;
  emit image_changed();
}

FileContent Document::read(const std::string& path, const std::stop_token& stop) {
  FileContent content;
  content.path = path;
  const std::string ending = ending_of(path);
  if (ending == ".toml") {
    content.scene = read_scene_file(path);
  } else if (ending == ".exr") {
    auto field = std::make_shared<LightField>(read_light_field(path, stop));
    if (field->scene_text.empty())
      throw InputError("'" + path +
                       "' holds no scene, so its camera is not known; open the scene instead");
    content.kind = FileContent::Kind::light_field;
    content.scene = parse_embedded_scene(field->scene_text, path);
    check_raw_image(*field, content.scene.scene.camera, "'" + path + "'");
    content.scene.scene.file = path;  // relative paths start beside it
    content.image = std::move(field);
  } else if (ending == ".vdb") {
    content.kind = FileContent::Kind::flame;
    vdb_info(path);  // says what is wrong with it before anything changes
  } else {
    throw UsageError("'" + path +
                     "' is neither a scene (.toml) nor a flame (.vdb) nor a light field (.exr)");
  }
  return content;
}

void Document::open(FileContent content) {
  if (content.kind == FileContent::Kind::scene)
    return begin(std::move(content.scene), content.path, nullptr);
  if (content.kind == FileContent::Kind::light_field)
    return begin(std::move(content.scene), "", std::move(content.image));
  Scene scene = this->scene();
  const bool first = empty_;
  if (first) scene = parse_scene("[camera]\npreset = \"paper-previous-60x60\"\n", "").scene;
  FlameSpec flame;
  flame.kind = FlameKind::vdb;
  flame.name = fs::path(content.path).stem().string();
  flame.file = fs::absolute(content.path).string();
  if (!scene.flames.empty()) flame.position = scene.flames.front().position;
  if (scene.flames.empty()) flame.position = {1, 0, -0.02};
  scene.flames = {flame};
  if (first)
    begin({scene, {}}, "", nullptr);
  else
    change(scene, "open " + fs::path(content.path).filename().string());
  if (first) history_.forget_saved();
  emit state_changed();
}

void Document::open_text(const std::string& text, const std::string& name) {
  begin(parse_scene(text, name), "", nullptr);
}

void Document::recover(const RecoveredScene& recovered) {
  SceneDocument document = parse_scene(recovered.text, recovered.path);
  document.scene = moved_to(document.scene, recovered.file);
  document.positions = {};  // of the copy, which are unknown
  begin(std::move(document), recovered.file, nullptr);
  history_.forget_saved();
  emit state_changed();
}

void Document::save(const std::string& path) {
  write_scene_file(path, moved_to(scene(), path));
  file_ = path;
  // Edits that are undone later name the same files, too.
  history_.update_all([&](Scene& scene) { scene = moved_to(scene, path); });
  history_.set_saved();
  emit state_changed();
}

void Document::push(SceneDocument state, const std::string& what, const std::string& merge) {
  const Scene before = scene();
  history_.push(std::move(state), what, merge);
  after(before, look());
}

void Document::set_look(const FlameLook& look, const std::string& what, const std::string& merge) {
  if (look == this->look()) return;
  history_.push_look(look, what, merge);
  emit state_changed();
  emit look_changed();
}

void Document::begin_look(const FlameLook& look) {
  history_.begin_look(look);
  emit look_changed();
}

void Document::after(const Scene& before, const FlameLook& look_before) {
  const SceneChanges changes = changes_between(before, scene());
  keep_camera();
  check();
  if (changes.image()) image_current_ = false;
  emit state_changed();
  if (changes.any()) emit scene_changed(changes);
  if (changes.camera) drop_image_of_other_size();
  if (!(look() == look_before)) emit look_changed();
}

void Document::set_value(const std::string& path, const std::string& text,
                         const std::string& merge) {
  SceneDocument state = history_.state();
  set_value_text(state.scene, path, text);
  if (state.scene == scene()) return;
  state.positions.erase(path);
  push(std::move(state), "change " + path, merge);
}

void Document::insert_item(const std::string& list, std::size_t position) {
  SceneDocument state = history_.state();
  plenoflame::insert_item(state.scene, list, position);
  state.positions.erase(list);
  push(std::move(state), "add to " + list);
}

void Document::erase_item(const std::string& list, std::size_t position) {
  SceneDocument state = history_.state();
  plenoflame::erase_item(state.scene, list, position);
  state.positions.erase(list);
  push(std::move(state), "remove from " + list);
}

void Document::apply_preset(PresetKind kind, const std::string& name, std::size_t index) {
  preset_text(kind, name);  // throws with the nearest name
  const std::string quoted = "preset = \"" + name + "\"\n";
  SceneDocument state = history_.state();
  Scene& scene = state.scene;
  const bool several = !scene.cameras.empty();
  CameraSpec& old =
      several ? scene.cameras.at(kind == PresetKind::flame ? 0 : index) : scene.camera;
  const std::string path = several ? "cameras[" + std::to_string(index) + "]" : "camera";
  if (kind == PresetKind::camera) {
    CameraSpec camera = parse_scene("[camera]\n" + quoted, name).scene.camera;
    camera.name = old.name;
    camera.position = old.position;
    camera.look_direction = old.look_direction;
    camera.up = old.up;
    old = camera;
    state.positions.erase(path);
  } else if (kind == PresetKind::lens) {
    old.lens = parse_scene("[camera.lens]\n" + quoted, name).scene.camera.lens;
    state.positions.erase(path + ".lens");
  } else {
    FlameSpec flame = parse_scene("[[flames]]\n" + quoted, name).scene.flames.at(0);
    if (index >= scene.flames.size()) {
      if (!scene.flames.empty()) flame.position = scene.flames.front().position;
      scene.flames.push_back(flame);
    } else {
      flame.position = scene.flames[index].position;
      flame.rotation = scene.flames[index].rotation;
      scene.flames[index] = flame;
    }
    state.positions.erase("flames");
  }
  if (!(scene == this->scene())) push(std::move(state), "preset " + name);
}

void Document::change(const Scene& scene, const std::string& what, const std::string& merge) {
  if (scene == this->scene()) return;
  SceneDocument state{scene, {}};
  push(std::move(state), what, merge);
}

void Document::undo() {
  if (!can_undo()) return;
  const Scene before = scene();
  const FlameLook look_before = look();
  history_.undo();
  after(before, look_before);
}

void Document::redo() {
  if (!can_redo()) return;
  const Scene before = scene();
  const FlameLook look_before = look();
  history_.redo();
  after(before, look_before);
}

void Document::check() {
  issues_ = check_scene(scene(), positions());
  valid_ = std::none_of(issues_.begin(), issues_.end(),
                        [](const SceneIssue& issue) { return issue.is_error; });
  issues_.insert(issues_.end(), unreadable_.begin(), unreadable_.end());
}

void Document::set_unreadable(const SceneIssue* issue) {
  if (unreadable_.empty() && !issue) return;
  unreadable_.clear();
  if (issue) unreadable_.push_back(*issue);
  check();
  emit issues_changed();
}

void Document::set_image(std::shared_ptr<const LightField> image) {
  image_ = std::move(image);
  image_current_ = image_ != nullptr;
  emit image_changed();
}

void Document::select(const Selection& selection) {
  if (selection == selection_) return;
  selection_ = selection;
  emit selection_changed();
}

}  // namespace plenoflame::desktop
