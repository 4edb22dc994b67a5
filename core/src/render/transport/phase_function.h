#pragma once
#include "plenoflame/scene/flame_spec.h"

namespace plenoflame {

/// Phase function [1/sr] at the cosine of the angle between the directions before and after
/// scattering.
double phase_function(const ScatteringSpec& spec, double cosine);
/// Draws a cosine from the phase function with a uniform number.
double draw_cosine(const ScatteringSpec& spec, double u);

}  // namespace plenoflame
