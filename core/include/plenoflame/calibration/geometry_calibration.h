#pragma once
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/calibration/white_radii.h"
#include "plenoflame/camera/microlens_lattice.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/scene/camera_spec.h"

namespace plenoflame {

/// A corner of a plane board, seen through one microlens.
struct CornerObservation {
  int pose = 0;  ///< which placement of the board
  Vec2 board;    ///< [m] on the board
  Vec2 pixel;    ///< column, row; pixel (0, 0) has its centre at (0.5, 0.5)
  /// None: the lens whose micro-image, by the camera to start with, has its centre nearest.
  std::optional<LensIndex> lens;
  /// [pixel] radius of the image of a point of the board through the whole microlens; below 0 where
  /// the microlens turns that image over.
  double blur = 0;
  double blur_error = 0;  ///< [pixel] standard deviation; 0: the blur is not known
  double error = 0;       ///< [pixel] standard deviation of each coordinate; 0: it is not known
};

/// The centre of a micro-image in white pictures.
struct CentreObservation {
  LensIndex lens;
  Vec2 pixel;
};

struct BoardPose {
  int pose = 0;
  RigidTransform to_camera;   ///< board to camera [m]
  double rms = 0;             ///< [pixel] of its corners, both coordinates together
  double distance_error = 0;  ///< [m] standard deviation of its distance along the axis
};

struct CalibratedValue {
  std::string key;
  double value = 0;
  double error = 0;  ///< standard deviation; GeometryCalibration tells its contents
};

/// Name of the values that are fitted by default.
inline constexpr const char* kUsualValues = "usual";

struct GeometrySettings {
  /// Keys of the fitted values: those of calibrated_keys(), their parts before a dot or bracket,
  /// and kUsualValues. Empty: the usual ones. These are distances, focal length, decentre, and the
  /// array's values that centres determine. Distortion is one of them if the camera has some at the
  /// start.
  std::vector<std::string> free;
  double outlier = 6;  ///< corners farther off than this many times the RMS are left out; 0: none
  /// Standard deviation of the lens' distance from the array over the exit pupil's. In the model
  /// the chief rays cross in the middle of the lens, where the quotient is 1. In a real lens they
  /// cross elsewhere. 0 for a thin lens with its stop.
  double pupil = 0.3;
  /// Radii of white micro-images, which determine the distance of the sensor from the array.
  std::vector<RadiusObservation> radii;
  double f_number = 0.03;  ///< relative standard deviation of what all f-numbers share
  /// Relative standard deviation that all focal lengths of microlenses share. Blur of corners tells
  /// the ratio of the sensor's distance to them.
  double microlens = 0.03;
};

/// A point of the board that does not lie at its nominal place.
struct BoardPoint {
  Vec2 nominal;  ///< [m] on the board
  Vec3 offset;   ///< [m] from there
};

/// The radii of white micro-images against the camera.
struct RadiiMatch {
  double observed = 0, predicted = 0;  ///< [pixel] slope over 1/N, of RadiiSlope
  double relative_error = 0;           ///< standard deviation of the observed one
  double conflict = 0;  ///< corners alone against radii, in standard deviations of the radii
};

/// The blur of corners against the camera.
struct BlurMatch {
  std::size_t corners = 0;
  double excess = 0;  ///< RMS of what the fit leaves, over the stated deviations
  /// Mean relative difference of the focal lengths of microlenses by places and blur alone from
  /// those of the camera to start with.
  double change = 0;
  double change_error = 0;  ///< with that of the sensor distance by places
};

/// The covariance has four parts:
/// - The scatter of the residuals: the largest of three estimates for each value, in which single
///   corners, micro-images or boards err independently.
/// - The displacement of the corners outwards in their micro-images (outwards_scatter).
/// - The place of the exit pupil (GeometrySettings::pupil).
/// - Values beside the camera's that explain more than noise. They are a
///   displacement outwards for each type of microlens, and places of the board's points. Their
///   standard deviations follow from the observations. Radii have the error that is given.
/// - Blur of corners has its scatter, and the focal lengths of microlenses the error that is given.
struct GeometryCalibration {
  CameraSpec camera;
  std::vector<BoardPose> poses;
  std::vector<CalibratedValue> values;
  std::vector<std::vector<double>> covariance;  ///< of the values, in their order and units
  double corner_rms = 0;                        ///< [pixel] of both coordinates together
  double centre_rms = 0;
  std::size_t corners = 0, centres = 0, left_out = 0;
  /// Mean displacement of the corners outwards, over their distance from the middle of their
  /// micro-image; for each type of microlens.
  std::vector<double> outwards;
  double outwards_scatter = 0;    ///< over types and distances, beyond noise
  std::vector<BoardPoint> board;  ///< empty: noise explains how the board differs from its pattern
  double board_deviation = 0;     ///< [m] standard deviation of a coordinate of its points
  std::optional<RadiiMatch> radii;
  std::optional<BlurMatch> blur;
  /// Residuals of the corners, observed - predicted [pixel]; NaN where it was left out.
  std::vector<Vec2> residuals;
  int steps = 0;
};

/// Keys of all values that can be fitted.
std::vector<std::string> calibrated_keys();

/// Fits camera and board poses so that exact rays through the middles of the microlenses meet the
/// corners and the centres of micro-images. Joint least squares (Levenberg and Marquardt).
/// @param start a thin ideal main lens and ideal microlenses, near enough that corners are found in
///        the right micro-images; poses begin with a homography
/// @throws InputError for another kind of camera and for too few corners
/// @throws InputError for values that the observations do not determine; it names those that depend
///         on each other
/// @throws InputError for lengths that doubled or halved, and for a camera that explains the
///         observations worse than `start`
GeometryCalibration calibrate_geometry(const CameraSpec& start,
                                       const std::vector<CornerObservation>& corners,
                                       const std::vector<CentreObservation>& centres,
                                       const GeometrySettings& settings = {},
                                       const Execution& execution = {});

}  // namespace plenoflame
