#pragma once
#include <vtkSmartPointer.h>

#include <vector>

#include "lens_geometry.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/image/image.h"

class vtkImageData;
class vtkPolyData;

/// The microlens array: lens by lens, or as a plate with a repeating texture.
namespace plenoflame::pipeline {

/// Microlenses whose centres lie in front of a part of the sensor, or within a pitch of it.
/// @param window of the sensor; width 0: all of it
std::vector<LensIndex> microlenses_over(const Camera& camera, PixelWindow window);

/// Both surfaces of each; of ideal microlenses a disc.
vtkSmartPointer<vtkPolyData> microlens_surfaces(const Camera& camera,
                                                const std::vector<LensIndex>& lenses,
                                                const Tessellation& tessellation);

/// A rectangle as large as the sensor where the array's front is; texture coordinates repeat with
/// the lattice.
vtkSmartPointer<vtkPolyData> array_plate(const Camera& camera);

/// What the plate's texture repeats: the smallest rectangle along the lattice's own axes after
/// which positions and types are the same. RGB, one colour a type.
vtkSmartPointer<vtkImageData> array_texture(const Camera& camera);

/// Colours of the types, also for rays: RGB in [0, 1]. -1: no array.
Vec3 type_colour(int type);

}  // namespace plenoflame::pipeline
