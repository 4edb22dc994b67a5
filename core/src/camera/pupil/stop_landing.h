#pragma once
#include <vector>

#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/stop_landing.h"

namespace plenoflame {

/// The plane that rays are looked at in behind the microlenses: that of the exit pupil, or where it
/// is far away or close to the array, one at the main lens' focal length (few rays of a pupil that
/// is close are then found, and its stop mostly is not known).
struct PupilPlane {
  explicit PupilPlane(const Camera& camera);
  double distance;       ///< in front of the array [m]; may be negative
  double radius;         ///< of the pupil there [m]
  bool moves_with_lens;  ///< how far off the axis a microlens stands adds to where its rays cross
};

struct RayCrossings {
  RayCrossing pupil;     ///< of the plane, in radii of the pupil
  RayCrossing far_face;  ///< of the microlens' face towards the scene, in radii of its aperture
};

/// The places where the rays of a type of microlens cross them, for sensor points out to
/// `sensor_reach` [m] and microlenses out to `field` [m]: least squares over traced rays.
RayCrossings fit_crossings(const Camera& camera, int type, double sensor_reach, double field);

/// From the plane to the stop, for microlenses at `place` [m]: least squares over traced rays.
/// @param at_place the camera with a microlens there whose apertures are wide open @param crossing
/// of the plane. @return not known where too few rays get to the stop
StopMap fit_stop_map(const Camera& at_place, double place, const RayCrossing& crossing);

}  // namespace plenoflame
