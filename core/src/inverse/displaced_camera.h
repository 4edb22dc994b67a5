#pragma once
#include "plenoflame/inverse/suspect.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// A camera with a quantity that is larger by some amount: of its place, turn or focus.
void displace(CameraSpec& camera, SuspectKind kind, double amount);

/// The scene of such a camera, without flames: rays need none.
CompiledScene displaced_scene(const CompiledScene& scene, SuspectKind kind, double amount);

}  // namespace plenoflame
