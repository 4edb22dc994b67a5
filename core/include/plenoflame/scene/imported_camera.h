#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/scene/scene.h"
#include "plenoflame/scene/scene_settings.h"

namespace plenoflame {

/// The scene of a camera that was read from calibration files of another tool.
struct ImportedScene {
  Scene scene;
  std::vector<std::string> formats;   ///< of the files, in their order
  std::vector<std::string> notes;     ///< what was assumed or left out, one line each
  std::vector<std::string> warnings;  ///< of validate()
};

/// Makes a scene by import_camera(). @param settings values by scene keys that replace those of the
/// files, camera.lens.f_number among them; and what messages call them
/// @param format as for import_camera()
/// @throws as import_camera(), UsageError for a wrong setting
ImportedScene import_camera_scene(const std::vector<std::string>& files,
                                  const SceneSettings& settings, std::string_view format = {});

}  // namespace plenoflame
