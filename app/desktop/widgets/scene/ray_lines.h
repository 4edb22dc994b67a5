#pragma once
#include <vector>

#include "model/schematic.h"
#include "plenoflame/render/ray_paths.h"

class vtkRenderer;

namespace plenoflame::desktop {

/// Draws rays as lines, coloured by how they ended.
/// @param chosen_ray the one that stands out; -1: none
/// @param dark whether the background is
void add_ray_lines(const RayPaths& paths, int chosen_ray, bool dark, const Schematic& schematic,
                   vtkRenderer& renderer);

/// The points of a ray as it is drawn, from the sensor on.
std::vector<Vec3> drawn_ray(const RayPaths& paths, std::size_t ray, const Schematic& schematic);

}  // namespace plenoflame::desktop
