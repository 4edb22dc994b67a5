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

/// Thermal emission without its constant: absorption times T^4.
double thermal_emission(double temperature, double absorption);

/// Temperatures between which nearly all of the emission lies [K]: those below which 1 % and 99.9 %
/// of it are. A wider span would spend colours on what hardly shines. 0, 0: nothing absorbs.
std::array<double, 2> emission_span(std::span<const float> temperature,
                                    std::span<const float> absorption);

}  // namespace plenoflame::desktop
