#pragma once
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "plenoflame/scene/scene_file.h"

namespace plenoflame {

/// A scene while its file is read: what is known of it so far, and what can only be done at the
/// end.
struct SceneInReading {
  struct FNumber {
    double value;
    std::optional<std::size_t> camera;  ///< of a list of cameras; otherwise of the only one
  };

  SceneDocument document;
  /// By the path of the lens; its stop is set when the glasses are known.
  std::map<std::string, FNumber> f_numbers;
  std::set<std::string> set_paths;           ///< what settings gave, not the file
  std::set<std::string> indices_of_windows;  ///< what the file gave of these
  bool closed = false;                       ///< opens no file
  std::vector<std::string> settings = {};    ///< "PATH=VALUE", those that are not applied yet
  std::string option = {};                   ///< what messages call each of them
};

/// A path in a scene, taken apart.
struct ScenePlace {
  std::string path;                  ///< with the numbers of items
  std::string schema_path;           ///< with [] in place of these
  std::vector<std::size_t> indices;  ///< the numbers
};

/// Reads what is no key of the schema: `preset`, `file` and `f_number` of a table.
/// @param origin for messages
void read_instruction(SceneInReading& reading, const ScenePlace& table, const std::string& name,
                      const std::string& value, const std::string& origin);

/// Applies the remaining settings, in their order. Files named by settings are opened even if the
/// text itself opens no files. @throws InputError
void apply_settings(SceneInReading& reading);

/// Applies the settings of one camera of several, once its item is read. Cameras that are like it
/// take them over.
void apply_settings_of_camera(SceneInReading& reading, std::size_t number);

}  // namespace plenoflame
