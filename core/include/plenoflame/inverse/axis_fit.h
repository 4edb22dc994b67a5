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

/// The line that is nearest to the pictures' light. It minimises the sum over rows of flux times
/// the squared distance of the row's rays (their mean). Only pixels above 5 standard deviations
/// count. One view measures neither the depth along it nor a tilt towards it: both stay as in
/// `start`.
/// @param start an axis near it
/// @throws InputError where no pixel is lit
FlameAxis fit_axis(const CameraRays& rays, const MeasuredRows& measured, const FlameAxis& start);

}  // namespace plenoflame
