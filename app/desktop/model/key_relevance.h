#pragma once
#include <string>

#include "plenoflame/scene/scene.h"

namespace plenoflame::desktop {

/// Why a value has no effect in this scene as it is: "only where flames[0].kind is vdb". Empty: it
/// has one.
/// @param path with indices, of a value or a table
std::string irrelevance(const Scene& scene, const std::string& path);

}  // namespace plenoflame::desktop
