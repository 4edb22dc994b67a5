#pragma once
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// The type alone, its lens (0, 0) on the axis, upright.
Camera alone_on_axis(const Camera& camera, int type);

/// The aim points that the microlens itself lets through, as seen from sensor points out to
/// `s_max`; independent of the field.
/// @param camera with one type, its lens (0, 0) on the axis
ApertureDiscs fit_aperture(const Camera& camera, double s_max);

/// Makes room in the discs of the apertures for what a tilt of the array and another focal length
/// do to them: both move the far face's disc, as seen from s, like another s would; and a lens that
/// stands nearer to the sensor, or farther from it, sees all of its points under another angle.
void widen_discs(const Camera& camera, double s_max, ApertureDiscs& discs);

}  // namespace plenoflame
