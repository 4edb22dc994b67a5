#pragma once
#include <vtkSmartPointer.h>

#include <string>

#include "voxel_arrays.h"

class vtkImageData;
class vtkMatrix4x4;

/// Voxel grids as vtkImageData and back.
namespace plenoflame::pipeline {

/// Makes an image of the lattice of `transform` within `box`: its extent starts at 0. Spacing and
/// direction are the columns of the map's linear part, so that rotation, and shear, are kept.
/// @param local true: origin 0 and no direction, placed by local_to_world() instead
void place_image(const AffineTransform& transform, const IndexBox& box, bool local,
                 vtkImageData& image);

/// From the coordinates of an image made with local = true to the world.
void local_to_world(const AffineTransform& transform, const IndexBox& box, vtkMatrix4x4& matrix);

/// Adds values as a float array of the image's points.
void add_array(const VoxelArray& values, vtkImageData& image);

/// An array of an image (point or cell data) as voxels with the image's origin, spacing and
/// direction. Bricks that hold only the background are left out.
/// @throws InputError: no such array (lists those present), more than one component
VoxelField image_to_voxels(vtkImageData& image, const std::string& array, float background);

}  // namespace plenoflame::pipeline
