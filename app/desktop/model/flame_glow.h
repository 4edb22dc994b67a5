#pragma once
#include <array>
#include <cstddef>
#include <span>

#include "plenoflame/math/vector.h"
#include "plenoflame/media/medium.h"

namespace plenoflame::desktop {

/// Emission of a medium at a point, all channels together [W/(m^3 sr)]. A clear flame, with only
/// the light of radicals and atoms, is drawn from it.
double glow(const Medium& medium, Vec3 place);

}  // namespace plenoflame::desktop
