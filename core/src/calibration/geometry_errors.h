#pragma once
#include <Eigen/Dense>
#include <cstddef>
#include <limits>
#include <vector>

#include "plenoflame/camera/microlens_lattice.h"
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Number of no pose: of what was not seen on a board.
inline constexpr std::size_t kNoPose = std::numeric_limits<std::size_t>::max();

/// A corner or a centre where a fit has ended. Lengths are in pixels on the sensor.
struct FittedPoint {
  /// Derivatives of the residual: by the camera's values, then (corners) by the 6 of the pose.
  Eigen::Matrix<double, 2, Eigen::Dynamic> rows;
  Vec2 residual;
  std::size_t pose = kNoPose;  ///< kNoPose: a centre
  LensIndex lens;
  std::size_t type = 0;  ///< of the microlens
  Vec2 offset;           ///< of a corner from the middle of its micro-image
  Vec2 by_pupil;         ///< by which it moves with the pupil, GeometrySettings::pupil = 1
};

/// The displacement of corners outwards, over their distance from the middle of the micro-image.
struct OutwardsDisplacement {
  std::vector<double> by_type;
  double scatter = 0;  ///< over types and distances, beyond noise
};

/// @param types count of types of microlenses
OutwardsDisplacement outwards_displacement(const std::vector<FittedPoint>& points,
                                           std::size_t types);

/// Covariance of the camera's `count` values, in units of the derivatives
/// (GeometryCalibration tells its parts).
/// @param square normal matrix of values and poses @param outwards and pupil: standard deviations
Eigen::MatrixXd geometry_covariance(const std::vector<FittedPoint>& points,
                                    const Eigen::MatrixXd& square, std::size_t count,
                                    double outwards, double pupil);

}  // namespace plenoflame
