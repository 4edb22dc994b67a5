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
  /// Derivatives of the residual. The camera's values come first. Corners add the 6 of the pose,
  /// the displacement outwards and the 3 of the board's point. Blur fills the first row alone.
  Eigen::Matrix<double, 2, Eigen::Dynamic> rows;
  /// First column in `rows`, first unknown of the fit, count; of those that the fit has.
  struct Block {
    Eigen::Index column = 0, unknown = 0, count = 0;
  };
  std::vector<Block> blocks;
  Vec2 residual;
  std::size_t pose = kNoPose;  ///< kNoPose: a centre
  LensIndex lens;
  std::size_t type = 0;  ///< of the microlens
  Vec2 offset;           ///< of a corner from the middle of its micro-image
  Vec2 by_pupil;         ///< by which it moves with the pupil, GeometrySettings::pupil = 1
};

/// An unknown that is near zero.
struct LooseValue {
  Eigen::Index unknown = 0;
  double weight = 0;  ///< of its square, beside squares of pixels
  double value = 0;
};

/// The end of a fit.
struct FittedPoints {
  std::vector<FittedPoint> points;
  Eigen::MatrixXd square;  ///< normal matrix of all unknowns: the camera's values, then the others
  Eigen::Index values = 0;
  std::vector<LooseValue> loose;
  std::vector<Eigen::Index> others;  ///< unknowns beside the values, whose errors are wanted, too
  /// Derivatives of observations beside corners and centres by all unknowns. Their deviation is
  /// that of the noise. The first is the slope of radii where there are some, and the pupil moves
  /// it.
  std::vector<Eigen::VectorXd> known;
  double radii_by_pupil = 0;
  double noise2 = 0;  ///< [pixel^2] variance of a corner's coordinate
};

/// The displacement of corners outwards, over their distance from the middle of the micro-image.
struct OutwardsDisplacement {
  std::vector<double> by_type;
  double scatter = 0;  ///< over types and distances, beyond noise
};

/// @param types count of types of microlenses
OutwardsDisplacement outwards_displacement(const std::vector<FittedPoint>& points,
                                           std::size_t types);

/// Covariance of the camera's values and of `others`, in units of the derivatives
/// (GeometryCalibration tells its parts).
/// @param outwards and pupil: standard deviations
Eigen::MatrixXd geometry_covariance(const FittedPoints& fitted, double outwards, double pupil);

}  // namespace plenoflame
