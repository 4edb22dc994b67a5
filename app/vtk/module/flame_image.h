#pragma once
#include <vtkSmartPointer.h>

#include <stop_token>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/radiometry/source_function.h"
#include "plenoflame/volumes/flame_file.h"

class vtkImageData;

namespace plenoflame {
class Medium;
}

namespace plenoflame::pipeline {

/// A medium's temperature (the scalars, [K]) and absorption ([1/m]) as point data of an image over
/// its bounds. It has `longest` points along the longest side; null when the medium is nowhere.
/// @throws Cancelled
vtkSmartPointer<vtkImageData> flame_image(const Medium& medium, int longest,
                                          const Execution& execution);

/// The flame of an image: temperature, absorption, and the other arrays that are named after
/// emission lines. @param ambient temperature outside [K]
/// @throws InputError as image_to_voxels, and for values that are not finite or negative
FlameFields image_to_flame(vtkImageData& image, const std::string& temperature,
                           const std::string& absorption, double ambient,
                           const std::stop_token& stop);

}  // namespace plenoflame::pipeline
