#pragma once
#include <array>

#include "plenoflame/math/vector.h"
#include "plenoflame/render/compiled_camera.h"

namespace plenoflame {

/// True if an infinite line meets a box.
bool line_meets(const Box& box, Vec3 origin, Vec3 direction);

/// Sets the frame of a compiled camera's rays. Its axes are those of the camera, and its origin is
/// the middle of the region.
void place_frame(const CompiledScene& scene, CompiledCamera& camera);

/// [m] half of the region's extent along the camera's axis.
double half_depth(const CompiledCamera& camera);

}  // namespace plenoflame
