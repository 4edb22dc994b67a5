#pragma once
#include <array>
#include <cstddef>
#include <span>

#include "plenoflame/math/vector.h"
#include "plenoflame/media/medium.h"

namespace plenoflame::desktop {

/// Emission of a medium at a point, all channels together [W/(m^3 sr)]. Where a flame is clear,
/// light of radicals and atoms alone, this is what there is to draw of it.
double glow(const Medium& medium, Vec3 place);

}  // namespace plenoflame::desktop
