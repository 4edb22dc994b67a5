#pragma once
#include "model/flame_look.h"

class vtkVolume;

namespace plenoflame::desktop {

/// Draws of what absorbs as much as the look wants at its temperature, and as dense.
/// @param cold,hot ends of the colours [K]
/// @param volume from views::flame_volume: its points hold temperature and absorption
void apply_opacity(const FlameLook& look, double cold, double hot, vtkVolume& volume);

}  // namespace plenoflame::desktop
