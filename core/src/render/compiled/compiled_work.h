#pragma once
#include <string>

#include "plenoflame/render/compiled_camera.h"
#include "render/estimators/backward.h"

namespace plenoflame {

/// Makes tiles of a picture by a compiled camera; refers to all of it but the name. A damaged tile
/// of the camera is a FileError. @param name of the camera, for messages
TileWork compiled_work(const CompiledScene& scene, const CompiledCamera& camera,
                       const RenderSettings& settings, const std::string& name);

}  // namespace plenoflame
