#pragma once
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// The reach of the sides of a type of microlens' apertures in the aim plane, for sensor points
/// out to what the table's micro-images reach: by rays at the edge of what passes both faces.
/// @param camera whose microlenses have sides @param table of the circles around them
ApertureSides fit_sides(const Camera& camera, int type, const PupilTable& table);

}  // namespace plenoflame
