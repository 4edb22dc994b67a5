#pragma once
#include "model/document.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame::desktop {

/// Things that can be pointed at. Where the flame is not met, or there are no microlenses, it is
/// the sensor.
enum class Targets { flame, microlenses, sensor };

/// The thing that a line of sight meets.
/// @param sight in the world [m], its direction of unit length
Selection target_of(const CompiledScene& scene, const Ray& sight, Targets targets);

}  // namespace plenoflame::desktop
