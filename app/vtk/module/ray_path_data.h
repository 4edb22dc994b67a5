#pragma once
#include "plenoflame/render/ray_paths.h"

class vtkPolyData;

namespace plenoflame::pipeline {

/// Ray paths as polylines with the arrays of the .vtp file (docs/rays.md).
void ray_paths_to_polydata(const RayPaths& paths, vtkPolyData& out);

}  // namespace plenoflame::pipeline
