#pragma once
#include <string>
#include <vector>

#include "plenoflame/scene/scene_file.h"

namespace plenoflame::cli {

/// Reads and validates a scene file. @param warnings if given, gets what is probably not meant, one
/// line each, with file, line and column; compile() says the same to its execution
/// @throws FileError, InputError with at least the file in front
SceneDocument read_valid_scene(const std::string& path,
                               std::vector<std::string>* warnings = nullptr);

}  // namespace plenoflame::cli
