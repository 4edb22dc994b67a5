#pragma once
#include <QColor>
#include <vector>

#include "model/schematic.h"
#include "plenoflame/render/ray_paths.h"

class vtkRenderer;

namespace plenoflame::desktop {

/// The colour of the type of its microlens if the ray arrives, else that of its end.
QColor ray_colour(const RayPath& ray, bool dark);

/// Draws rays as lines in these colours.
/// @param chosen_ray the one that stands out; -1: none
/// @param dark whether the background is
void add_ray_lines(const RayPaths& paths, int chosen_ray, bool dark, const Schematic& schematic,
                   vtkRenderer& renderer);

/// The points of a ray as it is drawn, from the sensor on.
std::vector<Vec3> drawn_ray(const RayPaths& paths, std::size_t ray, const Schematic& schematic);

}  // namespace plenoflame::desktop
