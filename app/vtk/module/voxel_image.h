#pragma once
#include <vtkSmartPointer.h>

#include <array>
#include <string>

#include "plenoflame/media/voxel_medium.h"

class vtkImageData;
class vtkMatrix4x4;

/// Voxel grids as vtkImageData and back.
namespace plenoflame::pipeline {

/// Whole index coordinates, both ends included; empty when a lower one exceeds its upper one.
struct IndexBox {
  std::array<int, 3> lower{0, 0, 0}, upper{-1, -1, -1};
  bool empty() const { return lower[0] > upper[0]; }
  void add(const IndexBox& other);
};

/// Box around every voxel that differs from the background.
IndexBox stored_box(const VoxelField& field);

/// Makes an image of the lattice of `transform` within `box`: its extent starts at 0. Spacing and
/// direction are the columns of the map's linear part, so that rotation, and shear, are kept.
/// @param local true: origin 0 and no direction, placed by local_to_world() instead
void place_image(const AffineTransform& transform, const IndexBox& box, bool local,
                 vtkImageData& image);

/// From the coordinates of an image made with local = true to the world.
void local_to_world(const AffineTransform& transform, const IndexBox& box, vtkMatrix4x4& matrix);

/// Adds the values of the field at the image's points as float array; outside of stored voxels the
/// background. The field's lattice must be `transform`'s.
void add_values(const VoxelField& field, const IndexBox& box, const char* name,
                vtkImageData& image);

/// Adds the field's values interpolated trilinearly at world positions of another lattice.
void add_interpolated(const VoxelField& field, const AffineTransform& transform,
                      const IndexBox& box, const char* name, vtkImageData& image);

/// An array of an image (point or cell data) as voxels with the image's origin, spacing and
/// direction; bricks that hold only the background are left out.
/// @throws InputError: no such array (lists those present), more than one component
VoxelField image_to_voxels(vtkImageData& image, const std::string& array, float background);

}  // namespace plenoflame::pipeline
