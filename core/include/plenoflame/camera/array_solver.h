#pragma once
#include <optional>
#include <vector>

#include "plenoflame/camera/design.h"

namespace plenoflame {

/// The free figure of a microlens of another focal length. The radius scales both faces alike.
enum class MicrolensFreedom { index, radius, thickness };

/// Limits of manufacture.
struct MicrolensLimits {
  double greatest_index = 2.0;
  double least_radius = 0;                ///< [m] of a curved face; half the diameter bounds it too
  double greatest_thickness = kInfinity;  ///< [m]
};

/// A biconvex, plano-convex, ... thick lens in air; radii [m] are positive when convex.
struct MicrolensShape {
  double radius_front = kInfinity, radius_back = kInfinity;
  double index = 1.5;
  double thickness = 0;  ///< [m]
};

/// 1/f = (n - 1) [1/R1 + 1/R2 - (n - 1) l / (n R1 R2)], R2 > 0 convex: the paper's eq. (1).
double thick_focal_length(const MicrolensShape& shape);

/// Focal lengths of `count` types whose depths of field join, longest first:
/// 1/f[k+1] = 1/f[k] + 2 p / (D B). Perwass and Wietzke 2012; the paper's eqs. (6), (7).
/// @throws InputError when a length is not positive
std::vector<double> joined_focal_lengths(double first, double sensor_distance, double diameter,
                                         double pixel, int count);

/// Finds the lens with this focal length that differs from `shape` in one property only. Closed
/// form: a quadratic equation for the index and for the radius, a linear one for the thickness.
/// @throws InputError if none lies within the limits; it names the value that would be needed
MicrolensShape solve_microlens(const MicrolensShape& shape, double focal_length, double diameter,
                               MicrolensFreedom freedom, const MicrolensLimits& limits);

/// Depth of field of a real microlens, by traced rays: the range in which the image of an axial
/// point is at most a pixel. The image's size is the diameter of the uniform disc of the same RMS
/// radius. Distances are from the front principal plane, as in depth_of_field().
/// @param gap rear vertex to the sensor [m]
/// @return nothing when the lens is never sharp to a pixel
std::optional<SharpRange> traced_depth_of_field(const MicrolensShape& shape, double gap,
                                                double diameter, double pixel);

/// One type of an array that was solved for.
struct SolvedType {
  double target = 0;  ///< [m] focal length by the rule
  MicrolensShape shape;
  SharpRange rule;  ///< depth of field by the formulas, with the B of the first type
  std::optional<SharpRange> traced;  ///< by rays, with the sensor where it is
};

/// Solves for an array whose first type is that of `array` and whose depths of field join.
/// @throws InputError for an array of thin lenses, and as above
std::vector<SolvedType> solve_array(const ArraySpec& array, double pixel, int count,
                                    MicrolensFreedom freedom, const MicrolensLimits& limits);

}  // namespace plenoflame
