#pragma once
#include <vtkSmartPointer.h>

class vtkImageData;
class vtkMultiBlockDataSet;
class vtkPolyData;
class vtkRenderer;

namespace plenoflame::views {

/// Adds the parts of a camera. @param camera from vtkPlenoflameCameraSource
/// @param plate_texture repeats over the array's plate
/// @param glass opacity of lens surfaces
void add_camera(vtkMultiBlockDataSet& camera, vtkImageData* plate_texture, double glass,
                vtkRenderer& renderer);

/// The first channel of a light field as grey picture, 99.9 % of the lit pixels not white. Any
/// thread may make it.
vtkSmartPointer<vtkImageData> picture_of(vtkImageData& light_field);

/// Adds such a picture on the sensor. @param sensor from vtkPlenoflameCameraSource
void add_picture(vtkPolyData* sensor, vtkImageData& picture, vtkRenderer& renderer);

/// Adds ray paths as lines. @param by_status instead of by the type of the microlens
void add_rays(vtkPolyData& rays, bool by_status, vtkRenderer& renderer);

/// Colour of a ray's status, RGB in [0, 1].
void status_colour(int status, double (&rgb)[3]);

}  // namespace plenoflame::views
