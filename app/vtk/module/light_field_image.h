#pragma once
#include <vtkSmartPointer.h>

#include <string>

#include "plenoflame/image/light_field.h"

class vtkImageData;
class vtkInformation;

/// Light fields as vtkImageData and back.
///
/// Rows run upwards, as VTK shows them: the last row of the sensor comes first in memory. A pixel
/// is a point; spacing is 1 pixel, the origin places the window on the sensor whose lower left
/// corner is (0, 0). One float array per channel (flux "NAME", "NAME.error") and layer. Everything
/// else of the light field is field data, each name with "plenoflame." in front.
namespace plenoflame::pipeline {

/// Says in RequestInformation that the light field of a part of the sensor comes, which filters of
/// pictures ask for.
void announce_light_field(const PixelWindow& window, int sensor_height, vtkInformation& port);

/// Fills `image`. @throws nothing but std::bad_alloc
void light_field_to_image(const LightField& field, vtkImageData& image);

/// @throws InputError: the image was not made by light_field_to_image, or misses an array
LightField image_to_light_field(vtkImageData& image);

/// One image as a float array `name`; rows turned over.
void image_to_vtk(const Image& in, const char* name, vtkImageData& out);

}  // namespace plenoflame::pipeline
