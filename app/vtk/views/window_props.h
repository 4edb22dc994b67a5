#pragma once
#include <vector>

#include "plenoflame/math/vector.h"

class vtkRenderer;

namespace plenoflame {
struct Scene;
}

namespace plenoflame::views {

/// Outlines of a scene's windows [m] world: closed and open loops of points.
std::vector<std::vector<Vec3>> window_outlines(const Scene& scene);

/// Adds them as thin lines, through which everything else stays visible.
void add_windows(const std::vector<std::vector<Vec3>>& outlines, vtkRenderer& renderer);

}  // namespace plenoflame::views
