#pragma once
#include <array>

#include "plenoflame/math/vector.h"
#include "plenoflame/render/compiled_camera.h"

namespace plenoflame {

/// True if a whole line meets a box.
bool line_meets(const Box& box, Vec3 origin, Vec3 direction);

/// Places the frame in which a compiled camera's rays are written: its axes are those of the
/// camera, its origin is the middle of the region.
void place_frame(const CompiledScene& scene, CompiledCamera& camera);

/// [m] half of the region's extent along the camera's axis.
double half_depth(const CompiledCamera& camera);

}  // namespace plenoflame
