#pragma once
#include <string>

#include "plenoflame/render/compiled_camera.h"
#include "render/estimators/backward.h"

namespace plenoflame {

/// The work that renders tiles with a compiled camera. It keeps references to all arguments except
/// the name. A damaged tile of the camera causes a FileError. @param name of the camera, for
/// messages
TileWork compiled_work(const CompiledScene& scene, const CompiledCamera& camera,
                       const RenderSettings& settings, const std::string& name);

}  // namespace plenoflame
