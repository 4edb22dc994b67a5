#pragma once
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// A camera with this type alone, its lens (0, 0) on the axis, without tilt.
Camera alone_on_axis(const Camera& camera, int type);

/// Fits the aim points that pass the microlens' own apertures, seen from sensor points out to
/// `s_max`. They do not depend on the field.
/// @param camera with one type, its lens (0, 0) on the axis
ApertureDiscs fit_aperture(const Camera& camera, double s_max);

/// Widens the discs of the apertures for a tilt of the array and for another focal length. Both
/// move the far face's disc, seen from s, as another s would. A lens that is nearer to the sensor,
/// or farther from it, sees all of its points at another angle.
void widen_discs(const Camera& camera, double s_max, ApertureDiscs& discs);

}  // namespace plenoflame
