#include "plenoflame/scene/cameras.h"

#include <algorithm>

#include "plenoflame/base/error.h"
#include "scene/schema/nearest.h"

namespace plenoflame {
namespace {

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text.append(text.empty() ? "" : ", ").append(name);
  return text;
}

/// The camera's number in Scene::cameras; that of a scene with a single "[camera]" is 0. @throws as
/// for_camera
std::size_t index_of_camera(const Scene& scene, std::string_view name) {
  const std::vector<std::string> names = camera_names(scene);
  if (name.empty()) {
    if (names.size() == 1) return 0;
    throw InputError("the scene has the cameras " + list_of(names) + "; choose one of them");
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return i;
  if (names.size() == 1 && names.front().empty())
    throw InputError("there is no camera " + quote_for_message(name) +
                     "; the scene has one, without a name");
  throw InputError("there is no camera " + quote_for_message(name) + suggestion(name, names));
}

Scene with_camera(const Scene& scene, std::size_t index) {
  Scene one = scene;
  if (scene.cameras.empty()) return one;
  one.camera = scene.cameras[index];
  one.cameras.clear();
  return one;
}

}  // namespace

std::vector<std::string> camera_names(const Scene& scene) {
  if (scene.cameras.empty()) return {scene.camera.name};
  std::vector<std::string> names;
  for (const CameraSpec& camera : scene.cameras) names.push_back(camera.name);
  return names;
}

Scene for_camera(const Scene& scene, std::string_view name) {
  return with_camera(scene, index_of_camera(scene, name));
}

SceneDocument for_camera(const SceneDocument& document, std::string_view name) {
  const std::size_t index = index_of_camera(document.scene, name);
  if (document.scene.cameras.empty()) return document;
  SceneDocument one{with_camera(document.scene, index), document.positions};
  one.positions.move("cameras[" + std::to_string(index) + "]", "camera");
  one.positions.erase("cameras");
  return one;
}

Scene replace_camera(const Scene& scene, const CameraSpec& camera) {
  Scene changed = scene;
  if (scene.cameras.empty()) changed.camera = camera;
  for (CameraSpec& one : changed.cameras)
    if (one.name == camera.name) one = camera;
  return changed;
}

void insert_camera(Scene& scene, std::size_t position) {
  const auto free_name = [&]() {
    const std::vector<std::string> names = camera_names(scene);
    std::size_t number = scene.cameras.size() + 1;
    const auto taken = [&](const std::string& name) {
      return std::find(names.begin(), names.end(), name) != names.end();
    };
    while (taken("camera" + std::to_string(number))) ++number;
    return "camera" + std::to_string(number);
  };
  if (scene.cameras.empty()) {
    if (scene.camera.name.empty()) scene.camera.name = free_name();
    scene.cameras.push_back(std::move(scene.camera));
    scene.camera = {};
    position = 1;
  }
  CameraSpec added = scene.cameras[position == 0 ? 0 : position - 1];
  added.name = free_name();
  scene.cameras.insert(scene.cameras.begin() + static_cast<std::ptrdiff_t>(position),
                       std::move(added));
}

std::string camera_in_words(const CameraSpec& camera) {
  return camera.name.empty() ? "the camera" : "camera " + quote_for_message(camera.name);
}

}  // namespace plenoflame
