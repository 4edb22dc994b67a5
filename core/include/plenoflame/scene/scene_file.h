#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// The places of a scene's keys in its file, for messages about values that turn out to be
/// impossible later on. A key that a preset gave is at "preset NAME:line:column".
class PositionMap {
 public:
  void set(const std::string& path, const SourcePosition& position) { positions_[path] = position; }
  /// Forgets a path and everything below it.
  void erase(std::string_view path);
  /// Gives a path and everything below it another name, too, or moves it to that.
  void copy(std::string_view from, std::string_view to);
  void move(std::string_view from, std::string_view to);
  /// Position of "camera.lens.surfaces[0].radius", or of the nearest table around it; unknown when
  /// the scene does not come from a file.
  SourcePosition find(std::string_view path) const;
  bool empty() const { return positions_.empty(); }

 private:
  std::map<std::string, SourcePosition, std::less<>> positions_;
};

struct SceneDocument {
  Scene scene;
  PositionMap positions;
};

/// Reads a scene from TOML. Every given value is checked: known key, type, unit, range. Checks of
/// several values together are left to validate() in scene/validate.h.
/// @param name of the file, for messages and as the start of relative paths (Scene::file)
/// @throws InputError "file:line:column: ..." that says what to do
SceneDocument parse_scene(std::string_view text, const std::string& name);

/// The layers of a flame alone: TOML that holds nothing but [[layers]] tables, with the keys of
/// [[flames.layers]]. All values are there and within their ranges.
/// @throws InputError "file:line:column: ..."
std::vector<EllipsoidSpec> parse_layers(std::string_view text, const std::string& name);

/// A scene from a file. @throws FileError when it cannot be read, InputError as parse_scene
SceneDocument read_scene_file(const std::string& path);

/// The whole scene as TOML, every key with a value (for a window its glass or its index). The
/// function parse_scene gives back an equal scene, bit for bit. Presets and comments of a file are
/// not kept.
/// @throws InputError when a value is NaN or a text is not UTF-8
std::string write_scene(const Scene& scene);

/// Writes to a temporary name in the same folder and renames. @throws FileError
void write_scene_file(const std::string& path, const Scene& scene);

}  // namespace plenoflame
