#pragma once
#include <vtkSmartPointer.h>

#include "plenoflame/base/execution.h"

class vtkImageData;

namespace plenoflame {
class Medium;
}

namespace plenoflame::pipeline {

/// A medium's temperature (the scalars, [K]) and absorption ([1/m]) as point data of an image over
/// its bounds with `longest` points along the longest side; null when the medium is nowhere.
/// @throws Cancelled
vtkSmartPointer<vtkImageData> flame_image(const Medium& medium, int longest,
                                          const Execution& execution);

}  // namespace plenoflame::pipeline
