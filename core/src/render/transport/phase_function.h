#pragma once
#include "plenoflame/scene/flame_spec.h"

namespace plenoflame {

/// Phase function [1/sr] at a cosine between the directions before and behind.
double phase_function(const ScatteringSpec& spec, double cosine);
/// A cosine drawn from it by a uniform number.
double draw_cosine(const ScatteringSpec& spec, double u);

}  // namespace plenoflame
