#pragma once
#include <string>

#include "plenoflame/render/ray_paths.h"

namespace plenoflame {

/// Rays as a numpy .npz: their ends and their light, without the vertices between. Arrays:
/// docs/rays.md. @throws InputError beyond 4 GiB, and for microlenses beyond +-32767
std::string ray_path_npz(const RayPaths& paths);

}  // namespace plenoflame
