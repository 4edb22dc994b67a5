#include "plenoflame/scene/validate.h"

#include <algorithm>
#include <map>

#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/scene_schema.h"
#include "scene/schema/nearest.h"
#include "scene/validation/issues.h"

namespace plenoflame {
namespace {

/// Every single value against its range, which the reader has done for those that a file gave.
void check_ranges(const Scene& scene, const PositionMap& positions, Issues& issues) {
  for (const std::string& path : scene_paths(scene)) {
    if (path.starts_with("camera.array.") && !scene.camera.array.present) continue;
    const ParsedPath parsed = parse_path(path);
    const SchemaKey& key = *find_schema_key(parsed.schema_path);
    const SchemaValue value = key.get(scene, parsed.indices);
    if (in_range(key, value)) continue;
    if (value == default_value(key)) {
      const bool no_camera = path.starts_with("camera.") && !scene.file.empty() &&
                             positions.find("camera").file.empty();
      issues.error(path, path + " is missing; " + range_text(key) + " is allowed" +
                             (no_camera ? "; the easiest start is a preset: [camera] preset = "
                                          "\"paper-plenoptic2\""
                                        : ""));
      continue;
    }
    try {
      check_range(key, value);
    } catch (const InputError& error) {
      issues.error(path, path + ": " + error.what());
    }
  }
  for (const SchemaList& list : schema_lists()) {
    if (list.path.find("[]") != std::string_view::npos) continue;
    const std::size_t size = list.size(scene, {});
    if (size < list.fewest || size > list.most)
      issues.error(std::string(list.path), std::string(list.path) + " has " + std::to_string(size) +
                                               " items; " + std::to_string(list.fewest) + " to " +
                                               std::to_string(list.most) + " are allowed");
  }
}

/// Names of cameras make names of files.
bool is_plain_name(const std::string& name) {
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

void check_plain_name(const CameraSpec& camera, const std::string& path, Issues& issues) {
  if (!is_plain_name(camera.name))
    issues.error(path + ".name", path + ".name is " + quote_for_message(camera.name) +
                                     "; letters, digits, _ and - are allowed");
}

void check_camera_names(const Scene& scene, Issues& issues) {
  std::map<std::string, std::size_t> first;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    const CameraSpec& camera = scene.cameras[i];
    const std::string path = "cameras[" + std::to_string(i) + "]";
    if (camera.name.empty()) {
      issues.error(path, path + " has no name; each of several cameras needs one of its own");
      continue;
    }
    check_plain_name(camera, path, issues);
    const auto [other, is_new] = first.emplace(camera.name, i);
    if (!is_new)
      issues.error(path + ".name", "cameras[" + std::to_string(other->second) + "] and " + path +
                                       " are both called " + quote_for_message(camera.name) +
                                       "; give one of them another name");
  }
}

/// Everything about a scene with several cameras: what each sees, and what it says more than once
/// only the first time.
std::vector<SceneIssue> check_all_cameras(const Scene& scene, const PositionMap& positions) {
  Issues names(positions, scene.file);
  check_camera_names(scene, names);
  if (!(scene.camera == CameraSpec{}))
    names.error("camera", "the scene has both one camera and a list of several");
  if (names.errors() > 0) return names.take();
  std::vector<SceneIssue> all;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    const SceneDocument one = for_camera({scene, positions}, scene.cameras[i].name);
    for (SceneIssue& issue : check_scene(one.scene, one.positions)) {
      if (issue.key == "camera" || issue.key.starts_with("camera.")) {
        issue.key = "cameras[" + std::to_string(i) + "]" + issue.key.substr(6);
        issue.message = camera_in_words(scene.cameras[i]) + ": " + issue.message;
      }
      const auto said = [&](const SceneIssue& other) {
        return other.key == issue.key && other.message == issue.message;
      };
      if (std::none_of(all.begin(), all.end(), said)) all.push_back(std::move(issue));
    }
  }
  return all;
}

}  // namespace

std::string to_string(const SceneIssue& issue) {
  const std::string where = to_string(issue.position);
  return where.empty() ? issue.message : where + ": " + issue.message;
}

std::vector<SceneIssue> check_scene(const Scene& scene, const PositionMap& positions) {
  if (!scene.cameras.empty()) return check_all_cameras(scene, positions);
  Issues issues(positions, scene.file);
  check_ranges(scene, positions, issues);
  // The checks that follow compute with the values and would be misled by impossible ones.
  if (issues.errors() == 0) {
    check_plain_name(scene.camera, "camera", issues);
    check_camera(scene.camera, issues);
    check_flames(scene, issues.errors() == 0, issues);
    check_surfaces(scene, issues);
    check_windows(scene, issues);
    check_channels(scene, issues);
    if (issues.errors() == 0) check_lines(scene, issues);
  }
  return issues.take();
}

std::vector<SceneIssue> validate(const Scene& scene, const PositionMap& positions) {
  std::vector<SceneIssue> issues = check_scene(scene, positions);
  for (const SceneIssue& issue : issues)
    if (issue.is_error) throw InputError(issue.position, issue.message);
  return issues;
}

}  // namespace plenoflame
