#pragma once
#include <vector>

#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/stop_landing.h"

namespace plenoflame {

/// The plane behind the microlenses in which rays are compared. Usually this is the plane of the
/// exit pupil. If the pupil is far away or close to the array, the plane is one focal length of the
/// main lens away. Few rays of a close pupil are then found, and its stop is mostly unknown.
struct PupilPlane {
  explicit PupilPlane(const Camera& camera);
  double distance;       ///< in front of the array [m]; may be negative
  double radius;         ///< of the pupil there [m]
  bool moves_with_lens;  ///< a microlens' distance from the axis shifts the crossings of its rays
};

struct RayCrossings {
  RayCrossing pupil;     ///< crossing of the plane, in radii of the pupil
  RayCrossing far_face;  ///< crossing of the face towards the scene, in radii of its aperture
};

/// Fits the points where the rays of a type of microlens cross these two planes, by least squares
/// over traced rays. Sensor points reach out to `sensor_reach` [m] and microlenses to `field` [m].
RayCrossings fit_crossings(const Camera& camera, int type, double sensor_reach, double field);

/// Fits the map from the plane to the stop for microlenses at `place` [m], by least squares over
/// traced rays.
/// @param at_place the camera with a microlens there whose apertures are wide open
/// @param crossing of the plane
/// @return unknown if too few rays reach the stop
StopMap fit_stop_map(const Camera& at_place, double place, const RayCrossing& crossing);

}  // namespace plenoflame
