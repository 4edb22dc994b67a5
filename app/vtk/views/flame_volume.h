#pragma once
#include <vtkSmartPointer.h>

class vtkColorTransferFunction;
class vtkImageData;
class vtkVolume;

namespace plenoflame::views {

/// Colours of temperature, dark red to white, over the temperatures [K] that emit: from the lowest
/// to the highest where there is absorption.
vtkSmartPointer<vtkColorTransferFunction> temperature_colours(vtkImageData& flame);

/// The flame as a volume: colour by temperature, opacity by absorption, its contrast raised so that
/// the thickest way through is nearly opaque. Drawn by the processor: with software OpenGL that is
/// several times faster than by shaders.
/// @param flame from vtkPlenoflameFlameSource
vtkSmartPointer<vtkVolume> flame_volume(vtkImageData& flame, vtkColorTransferFunction* colours);

}  // namespace plenoflame::views
