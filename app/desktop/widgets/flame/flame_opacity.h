#pragma once
#include "model/flame_look.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/media/medium.h"

class vtkImageData;
class vtkVolume;

namespace plenoflame::desktop {

/// Draws of what absorbs as much as the look wants at its temperature, and as dense.
/// @param cold,hot ends of the colours [K]
/// @param volume from views::flame_volume: its points hold temperature and absorption
void apply_opacity(const FlameLook& look, double cold, double hot, vtkVolume& volume);

/// The light that a flame emits takes the place of absorption where it absorbs nowhere.
/// @param flame from pipeline::flame_image(), of this medium
void show_glow(const Medium& medium, vtkImageData& flame, const Execution& execution);

}  // namespace plenoflame::desktop
