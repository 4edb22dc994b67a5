#pragma once
#include <stop_token>

#include "commands/render/compiled_scenes.h"
#include "plenoflame/base/communicator.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame::cli {

/// Rank 0 tells the others which scene is rendered next: they compile it, too.
/// @param threads of each; 0: as many as each thinks best
void announce_scene(const Scene& scene, const SceneUse& use, bool white, int threads,
                    Communicator& ranks);

/// Compiles what rank 0 announces and renders along, until it quits.
/// @param threads where rank 0 does not say how many
void serve_renderings(Communicator& ranks, int threads, const std::stop_token& stop);

}  // namespace plenoflame::cli
