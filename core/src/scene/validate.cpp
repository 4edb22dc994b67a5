#include "plenoflame/scene/validate.h"

#include "plenoflame/scene/scene_schema.h"
#include "scene/issues.h"

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

}  // namespace

std::string to_string(const SceneIssue& issue) {
  const std::string where = to_string(issue.position);
  return where.empty() ? issue.message : where + ": " + issue.message;
}

std::vector<SceneIssue> check_scene(const Scene& scene, const PositionMap& positions) {
  Issues issues(positions, scene.file);
  check_ranges(scene, positions, issues);
  // What follows computes with the values and would be misled by impossible ones.
  if (issues.errors() == 0) {
    check_camera(scene.camera, issues);
    check_flames(scene, issues.errors() == 0, issues);
    check_surfaces(scene, issues);
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
