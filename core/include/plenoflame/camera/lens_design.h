#pragma once
#include <vector>

#include "plenoflame/optics/first_order.h"
#include "plenoflame/optics/lens_system.h"

namespace plenoflame {

/// One point of a ray fan: where in the pupil, and how far from the chief ray it arrives.
struct FanPoint {
  double pupil = 0;  ///< -1 to 1, of the paraxial entrance pupil
  double error = 0;  ///< [m] across the image plane
};

/// The image that a lens makes of an object point in one direction, in the paraxial image plane
/// moved by `LensDesign::focus`.
struct LensFieldDesign {
  double field = 0;         ///< [rad] angle of the chief ray at the entrance pupil
  double image_height = 0;  ///< [m] of the chief ray
  double distortion = 0;    ///< image_height over the paraxial one, minus 1
  /// Share of the rays that get through, of those on the axis: rays uniform over the plane of the
  /// entrance pupil.
  double throughput = 0;
  double tangential = 0, sagittal = 0;  ///< [m] focus of narrow beams around the chief ray, from
                                        ///< the image plane towards the sensor's side
  double rms = 0;                       ///< [m] radius about the centroid
  std::vector<FanPoint> tangential_fan, sagittal_fan;
  std::vector<Vec2> spot;  ///< [m] from the chief ray
};

/// A lens without a camera.
struct LensDesign {
  FirstOrder lens;
  double object_distance = kInfinity;  ///< [m] from the first vertex
  double image_distance = 0;           ///< [m] last vertex to the image plane
  double focus = 0;  ///< [m] shift of that plane from the paraxial image, towards the sensor
  double greatest_field = 0;  ///< [rad] beyond it less than a tenth of the light of the axis passes
  std::vector<LensFieldDesign> fields;
};

/// Traces a lens at field angles from 0 to `field` in equal steps.
/// @param field [rad]; 0: as far as a tenth of the light of the axis gets through, at most 45
/// degrees
/// @param focus [m] as LensDesign::focus; NaN: where the spot on the axis is least
/// @throws InputError when the lens forms no image, or no light gets through at an angle
LensDesign design_lens(const std::vector<SurfaceSpec>& surfaces, double object_distance,
                       double field, int fields, double focus);

}  // namespace plenoflame
