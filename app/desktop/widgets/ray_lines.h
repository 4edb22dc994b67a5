#pragma once
#include "plenoflame/render/ray_paths.h"

class vtkRenderer;

namespace plenoflame::desktop {

/// Draws rays as lines, coloured by how they ended.
/// @param chosen_ray the one that stands out; -1: none
/// @param dark whether the background is
void add_ray_lines(const RayPaths& paths, int chosen_ray, bool dark, vtkRenderer& renderer);

}  // namespace plenoflame::desktop
