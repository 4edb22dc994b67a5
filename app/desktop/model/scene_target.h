#pragma once
#include "model/document.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame::desktop {

/// Targets of the pointer. The sensor is the target if the sight misses the flame, or without
/// microlenses.
enum class Targets { flame, microlenses, sensor };

/// The thing that a line of sight meets.
/// @param sight in the world [m], its direction of unit length
Selection target_of(const CompiledScene& scene, const Ray& sight, Targets targets);

}  // namespace plenoflame::desktop
