#pragma once
#include <vtkSmartPointer.h>

class vtkColorTransferFunction;
class vtkImageData;
class vtkVolume;

namespace plenoflame::views {

/// Colours of temperature, purple over orange to light yellow, over the temperatures [K] between
/// which nearly all of the emission lies (emission_span()).
vtkSmartPointer<vtkColorTransferFunction> temperature_colours(vtkImageData& flame);

/// The flame as a volume: colour by temperature, opacity by absorption, its contrast raised so that
/// the thickest way through is nearly opaque. Drawn by the processor: with software OpenGL that is
/// several times faster than by shaders.
/// @param flame from vtkPlenoflameFlameSource
vtkSmartPointer<vtkVolume> flame_volume(vtkImageData& flame, vtkColorTransferFunction* colours);

}  // namespace plenoflame::views
