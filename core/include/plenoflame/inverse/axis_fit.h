#pragma once
#include <vector>

#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/measurement.h"

namespace plenoflame {

/// A line that a round flame turns about.
struct FlameAxis {
  Vec3 base;          ///< [m] its point nearest to that of the start
  Vec3 direction;     ///< unit vector
  double spread = 0;  ///< [m] RMS distance of light from it: about half a radius
};

/// The line from which the pictures' light is least away: the sum over rows of flux times the
/// squared distance of its rays (their mean) is least. Only pixels above 5 standard deviations
/// count. What the cameras cannot tell stays as it was: the depth along the only view, and a tilt
/// along it.
/// @param start an axis near it @throws InputError where no pixel is lit
FlameAxis fit_axis(const CameraRays& rays, const MeasuredRows& measured, const FlameAxis& start);

}  // namespace plenoflame
