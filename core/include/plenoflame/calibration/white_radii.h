#pragma once
#include <cstddef>
#include <vector>

#include "plenoflame/scene/camera_spec.h"

namespace plenoflame {

/// Radius of the micro-images of one type in a white picture. It belongs to the uniform disc with
/// the same second moment. A micro-image is the stop's image, blurred by the microlens' defocus, so
/// its squared radius is the sum of both squares.
struct RadiusObservation {
  double f_number = 0;
  std::size_t type = 0;  ///< of the microlens
  double radius = 0;     ///< [pixel], without the pixel's own width
  double error = 0;      ///< [pixel] standard deviation
};

/// A line through the squares of radii over 1/N^2.
struct RadiiSlope {
  double slope = 0;           ///< [pixel] radius of the stop's image, times N
  double relative_error = 0;  ///< standard deviation: scatter about the line, and f-numbers
  std::vector<double> blur;   ///< [pixel] radius of each type's blur; NaN for a type without radii
};

/// @param f_number relative standard deviation that all f-numbers share
/// @throws InputError if the radii do not determine a slope: one aperture alone, or radii that
///         shrink as the stop opens
RadiiSlope radii_slope(const std::vector<RadiusObservation>& radii, double f_number);

/// The slope that a camera with a thin lens has [pixel].
double slope_of_radii(const CameraSpec& camera);

/// Sets the types' focal lengths to those that blur white micro-images so.
void set_focal_lengths(CameraSpec& camera, const std::vector<double>& blur);

}  // namespace plenoflame
