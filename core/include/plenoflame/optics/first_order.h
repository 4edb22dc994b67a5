#pragma once
#include <vector>
#include "plenoflame/scene/array_spec.h"
#include "plenoflame/scene/main_lens_spec.h"

namespace plenoflame {

/// Gaussian optics of a lens in air, from its ABCD matrix. All positions are measured along the
/// light's way from the scene to the sensor: positive is towards the sensor.
struct FirstOrder {
  double focal_length = 0;          ///< EFL [m]; infinite for an afocal system
  double back_focal_distance = 0;   ///< BFL: last vertex to the rear focal point [m]
  double front_focal_distance = 0;  ///< FFL: first vertex to the front focal point [m] (negative
                                    ///< when it lies in front)
  double front_principal = 0;       ///< first vertex to the front principal plane [m]
  double rear_principal = 0;        ///< last vertex to the rear principal plane [m]
  double length = 0;                ///< first to last vertex [m]
  double entrance_pupil = 0;        ///< first vertex to the entrance pupil [m]
  double entrance_pupil_diameter = 0;
  double exit_pupil = 0;  ///< last vertex to the exit pupil [m]
  double exit_pupil_diameter = 0;
  int stop = -1;  ///< index of the stop surface; -1: none, pupils are 0
};

/// Paraxial properties of surfaces listed from the scene to the sensor, in air on both sides.
/// Source: Gaussian optics, any text; the matrices act on (height, index * angle).
FirstOrder first_order(const std::vector<SurfaceSpec>& surfaces);

/// The same for a main lens of either kind; a lens without surfaces is thin, at z = 0.
FirstOrder first_order(const MainLensSpec& lens);

/// The same for one microlens (front surface towards the scene).
FirstOrder first_order(const ArraySpec& array, const MicrolensSpec& type);

/// Image distance of an axial point at `object_distance` in front of the first vertex (may be
/// infinite). It is measured from the last vertex, positive towards the sensor, negative for a
/// virtual image. Infinite if the object is in the front focal plane.
double paraxial_image_distance(const FirstOrder& lens, double object_distance);

/// Paraxial transverse magnification for that object (negative: inverted).
double paraxial_magnification(const FirstOrder& lens, double object_distance);

}  // namespace plenoflame
