#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/scene/scene_file.h"

namespace plenoflame {

/// Settings with which a scene is read: values that replace those of the file, and limits on the
/// files that its text may open.
struct SceneSettings {
  /// "PATH=VALUE", in the order in which they apply: "camera.focus.object_distance=0.9 m". A path
  /// is a key of a scene file, including `preset`, `file` and `f_number`. Items of a list have
  /// numbers from 0, "flames[0].position", or names, "flames.candle.position" or
  /// "flames[candle].position". Files are relative to the scene file. A camera gets its values
  /// before cameras that are `like` it copy it.
  std::vector<std::string> values = {};
  std::string option = "setting";  ///< what messages call each of them
  /// The text stands inside of another file, a light field: it opens no file by itself.
  bool embedded = false;
  std::string embedded_in = {};  ///< that file: relative names of files start in its folder
};

/// As parse_scene, read_scene_file of scene_file.h. Messages about a value of `settings` have
/// "OPTION PATH" in place of the file.
/// @throws InputError as they do, and for a setting with an unknown path (names the nearest one)
/// @throws InputError for a setting with a value of the wrong type, unit or range
SceneDocument parse_scene(std::string_view text, const std::string& name,
                          const SceneSettings& settings);
SceneDocument read_scene_file(const std::string& path, const SceneSettings& settings);

/// The scene that a light field or another file holds as text. It opens no file unless a setting
/// names one. @param file that holds it
SceneDocument parse_embedded_scene(std::string_view text, const std::string& file,
                                   SceneSettings settings = {});

/// Replaces the names of items in a path by their numbers: "flames.candle.position" ->
/// "flames[2].position". A path without lists stays as it is.
/// @throws InputError when a list has no item of that name, or several
std::string resolve_path(const Scene& scene, std::string_view path);

}  // namespace plenoflame
