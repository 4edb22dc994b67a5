#pragma once
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// Measures how far the sides of a type's apertures reach in the aim plane, by rays at the edge of
/// what passes both faces. The sensor points extend as far as the table's micro-images.
/// @param camera whose microlenses have sides
/// @param table of the circles around them
ApertureSides fit_sides(const Camera& camera, int type, const PupilTable& table);

}  // namespace plenoflame
