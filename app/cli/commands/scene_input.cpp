#include "commands/scene_input.h"
#include "commands/add_option.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>

#include "light_field_camera.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/scene_settings.h"
#include "plenoflame/scene/validate.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

constexpr const char* kOption = "--set";

/// Calls action(); what is wrong with a value of --set is wrong use of the command.
template <class Action>
auto telling_options(Action&& action) {
  try {
    return action();
  } catch (const InputError& error) {
    if (error.position().file.starts_with(kOption)) throw UsageError(error.what());
    throw;
  }
}

SceneSettings settings_of(const std::vector<std::string>& values) {
  SceneSettings settings;
  settings.values = values;
  settings.option = kOption;
  return settings;
}

}  // namespace

void add_set_option(CLI::App& command, std::vector<std::string>& values) {
  add_option(command, kOption, values, "KEY=VALUE",
             "Replace a value of the scene, such as camera.focus.object_distance=0.9m or "
             "flames[0].position=\"1 m, 0 m, -29 mm\"; repeatable")
      ->allow_extra_args(false);
}

void check_is_scene(const std::string& path) {
  std::error_code error;
  // Before anything is made of its name.
  if (!std::filesystem::exists(path, error) && !error)
    throw FileError("cannot read '" + path + "': No such file or directory");
  if (!std::filesystem::is_regular_file(path, error)) return;  // a pipe would be waited for
  std::array<char, 4> start{};
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), start.size());
  const std::string_view bytes(start.data(), static_cast<std::size_t>(file.gcount()));
  const auto refuse = [&](const std::string& what) {
    throw InputError("'" + path + "' is " + what);
  };
  if (bytes.starts_with("\x76\x2f\x31\x01"))
    refuse("a light field (.exr), but a scene (.toml) is needed; 'plenoflame info " + path +
           " --scene' prints the scene of the light field");
  if (bytes.starts_with(" BDV"))
    refuse(
        "a flame (.vdb), but a scene (.toml) is needed; name the flame as a file of its "
        "[[flames]]");
  if (bytes.starts_with("\x89PNG")) refuse("a picture (.png), but a scene (.toml) is needed");
}

SceneDocument read_valid_scene(const std::string& path, const std::vector<std::string>& settings,
                               std::vector<std::string>* warnings) {
  check_is_scene(path);
  return telling_options([&] {
    SceneDocument document = read_scene_file(path, settings_of(settings));
    try {
      for (const SceneIssue& issue : validate(document))
        // A file of cameras alone is complete for commands that describe cameras.
        if (warnings && issue.code != IssueCode::no_flame) warnings->push_back(to_string(issue));
    } catch (const InputError& error) {
      // About a key that stands nowhere in the file: say at least which file.
      if (error.position().file.empty()) throw InputError(SourcePosition{path}, error.what());
      throw;
    }
    return document;
  });
}

SceneDocument read_scene(const std::string& path, const std::vector<std::string>& settings) {
  check_is_scene(path);
  return telling_options([&] { return read_scene_file(path, settings_of(settings)); });
}

SceneDocument parse_scene_of(const LightField& light_field, const std::string& path,
                             const std::vector<std::string>& settings) {
  // A light field is one camera's.
  return telling_options([&] {
    return for_camera(parse_embedded_scene(light_field.scene_text, path, settings_of(settings)));
  });
}

SceneDocument read_scene_of(const LightField& light_field, const std::string& path,
                            const std::vector<std::string>& settings) {
  SceneDocument document = parse_scene_of(light_field, path, settings);
  telling_options([&] { check_camera_of(document, "scene of " + path); });
  return document;
}

SceneDocument read_scene_of_camera(const std::string& path,
                                   const std::vector<std::string>& settings,
                                   const std::string& camera) {
  SceneDocument document = choose_camera(read_scene(path, settings), camera);
  telling_options([&] { check_camera_of(document, path); });
  return document;
}

void add_camera_option(CLI::App& command, std::string& camera) {
  add_option(command, "--camera", camera, "NAME",
             "Name of the scene's camera ([[cameras]]); needed if the scene has several");
}

SceneDocument choose_camera(const SceneDocument& document, const std::string& camera) {
  try {
    return for_camera(document, camera);
  } catch (const InputError& error) {
    throw UsageError("--camera: " + std::string(error.what()));
  }
}

std::string CameraScene::what() const {
  const CameraSpec& camera = document.scene.camera;
  return camera.name.empty() ? file : file + ", " + camera_in_words(camera);
}

void add_cameras_option(CLI::App& command, std::vector<std::string>& cameras) {
  add_option(command, "--camera", cameras, "NAME",
             "Use only this camera of the scene ([[cameras]]); may be repeated")
      ->allow_extra_args(false);
}

std::vector<CameraScene> choose_cameras(const SceneDocument& document, const std::string& file,
                                        const std::vector<std::string>& cameras) {
  const std::vector<std::string> names = cameras.empty() ? camera_names(document.scene) : cameras;
  std::vector<CameraScene> scenes;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
        names.begin() + static_cast<std::ptrdiff_t>(i))
      throw UsageError("--camera: '" + names[i] + "' is given twice");
    scenes.push_back({file, choose_camera(document, names[i])});
  }
  return scenes;
}

std::vector<CameraScene> read_camera_scenes(const std::vector<std::string>& files,
                                            const std::vector<std::string>& settings,
                                            const std::vector<std::string>& cameras) {
  if (files.size() > 1 && !cameras.empty())
    throw UsageError("--camera chooses a camera of one scene, but several scenes are given");
  std::vector<CameraScene> scenes;
  for (const std::string& file : files)
    for (CameraScene& scene : choose_cameras(read_valid_scene(file, settings), file, cameras))
      scenes.push_back(std::move(scene));
  return scenes;
}

SceneDocument read_camera_scene(const std::string& path, const std::vector<std::string>& settings,
                                const std::string& camera, std::vector<std::string>* warnings) {
  return choose_camera(read_valid_scene(path, settings, warnings), camera);
}

}  // namespace plenoflame::cli
