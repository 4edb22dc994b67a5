#pragma once
#include <vector>

#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// The greatest distance at which a ray of the camera that windows bend is from the straight line
/// on which it left the camera, at places of some boxes and across the camera's axis [m]. From
/// traced rays, with room for those between them. Infinite where that cannot be told.
double displacement_by_windows(const CompiledScene& scene, const std::vector<Box>& boxes);

}  // namespace plenoflame
