#pragma once
#include <vtkSmartPointer.h>

#include "camera_mesh.h"

class vtkImageData;
class vtkPolyData;

namespace plenoflame::pipeline {

/// Polygons with cell data "surface", "type", "microlens", and normals or texture coordinates.
vtkSmartPointer<vtkPolyData> polydata_of(const CameraMesh& mesh);

/// Tile that the plate's texture repeats: the smallest rectangle along the lattice's own axes after
/// which positions and types are the same. RGB, one colour a type.
vtkSmartPointer<vtkImageData> array_texture(const Camera& camera);

/// Colours of the types, also for rays: RGB in [0, 1]. -1: no array.
Vec3 type_colour(int type);

}  // namespace plenoflame::pipeline
