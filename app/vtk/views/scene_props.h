#pragma once
#include <vtkSmartPointer.h>

class vtkImageData;
class vtkMultiBlockDataSet;
class vtkPolyData;
class vtkRenderer;

namespace plenoflame::views {

/// Adds the parts of a camera. @param camera from vtkPlenoflameCameraSource
/// @param plate_texture repeats over the array's plate
/// @param light_field its first channel is shown on the sensor; null: none
/// @param glass opacity of lens surfaces
void add_camera(vtkMultiBlockDataSet& camera, vtkImageData* plate_texture,
                vtkImageData* light_field, double glass, vtkRenderer& renderer);

/// Adds ray paths as lines. @param by_status instead of by the type of the microlens
void add_rays(vtkPolyData& rays, bool by_status, vtkRenderer& renderer);

/// Colour of a ray's status, RGB in [0, 1].
void status_colour(int status, double (&rgb)[3]);

}  // namespace plenoflame::views
