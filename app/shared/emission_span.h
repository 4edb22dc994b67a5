#pragma once
#include <array>
#include <span>

namespace plenoflame {

/// Thermal emission without its constant: absorption times T^4.
double thermal_emission(double temperature, double absorption);

/// Temperatures between which nearly all of the emission lies [K]: those below which 1 % and 99.9 %
/// of it are. A wider span would spend colours on what hardly shines. 0, 0: nothing absorbs.
std::array<double, 2> emission_span(std::span<const float> temperature,
                                    std::span<const float> absorption);

}  // namespace plenoflame
