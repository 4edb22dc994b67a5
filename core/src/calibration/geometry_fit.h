#pragma once
#include <Eigen/Dense>
#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "calibration/free_values.h"
#include "calibration/geometry_errors.h"
#include "plenoflame/calibration/geometry_calibration.h"
#include "plenoflame/camera/camera.h"

namespace plenoflame {

/// Observations of the boards and of white pictures.
struct GeometryObservations {
  std::vector<CornerObservation> corners;
  std::vector<CentreObservation> centres;
  std::optional<RadiiSlope> radii;
};

/// Standard deviations of values that are near zero. 0: the values are zero.
struct Looseness {
  double outwards = 0;  ///< displacement of corners outwards, over their offset; one for each type
  double board = 0;     ///< [m] distance of the board's points from their nominal places
};

/// Least squares over the camera, the poses and the loose values (Levenberg and Marquardt).
class GeometryFit {
 public:
  GeometryFit(const CameraSpec& start, const GeometryObservations& seen);

  /// Each board by a homography to the directions from the middle of the lens in which its corners
  /// are seen on the plane in focus.
  /// @throws InputError for a pose with too few corners
  void start_poses();

  /// @param free the camera's values that change @return count of steps
  int solve(const std::vector<const FreeValue*>& free, const Execution& execution);

  /// A distant board looks the same when it is tilted the other way (Schweighofer and Pinz, IEEE
  /// PAMI 28 (2006) 2024). A pose is turned over if this leaves smaller residuals.
  /// @return whether one was turned over
  bool turn_poses_over(const Execution& execution);

  /// Brings the corners' blur in, with the focal lengths of microlenses that have such corners.
  /// @param microlens GeometrySettings::microlens @return count of steps; 0: there is no blur
  int use_blur(double microlens, const Execution& execution);

  /// Solves with weights of the observations by what the fit leaves. @return count of steps
  int solve_weighted(const Execution& execution);

  /// Finds these loose values and their standard deviation. They remain zero if noise explains
  /// what they change. @param start the standard deviation to start with @return count of steps
  int loosen(double Looseness::*which, double start, const Execution& execution);

  /// @throws InputError naming the values between which the observations do not tell
  void check_determined() const;

  /// Marks corners that are far off. @return how many
  std::size_t leave_out(double times);

  /// True if the corners determine the plane of the distortion, one of these values, as the camera
  /// is now.
  bool knows_plane(const std::vector<const FreeValue*>& free);

  void put_plane(double distance) { spec_.lens.distortion.distance = distance; }
  double plane() const { return spec_.lens.distortion.distance; }
  double corner_rms() const;
  /// All squares, over those of noise.
  double misfit() const { return cost_ / noise2_; }
  /// Slope of radii, predicted - observed, in standard deviations. 0: there are no radii.
  double radii_conflict() const { return radii_residual_; }
  bool has_blur() const { return microlens_ > 0; }
  std::size_t types() const { return outwards_.size(); }

  /// @param pupil GeometrySettings::pupil
  GeometryCalibration result(int steps, double pupil);

  static double plane_in_focus(const Camera& camera);

 private:
  /// All that a step changes.
  struct State {
    CameraSpec spec;
    std::vector<RigidTransform> poses;
    std::vector<double> outwards;
    std::vector<Vec3> points;
    double blur_scale = 0, blur_offset = 0;
  };
  State state() const { return {spec_, poses_, outwards_, points_, blur_scale_, blur_offset_}; }
  void put(const State& state);

  /// @throws InputError for a board of another unit
  void check_size(const Camera& camera, int pose, std::size_t index) const;
  /// Direction in which a corner is seen from the middle of the lens, if it is in focus.
  Vec2 direction_of(const Camera& camera, std::size_t i) const;
  RigidTransform homography_pose(const Camera& camera, std::size_t pose) const;
  std::vector<FittedPoint> fitted_points();
  std::vector<LooseValue> loose_values() const;
  double update_looseness();
  std::vector<double> pose_costs() const;
  Vec3 on_board(std::size_t i) const;
  Vec3 in_camera(std::size_t i) const { return poses_[pose_of_[i]].point(on_board(i)); }
  Vec2 middle_of(const Camera& camera, LensIndex lens) const;
  Vec2 found_at(const Camera& camera, std::size_t i) const;
  Vec2 place_of(const Camera& camera, std::size_t i, Vec2 found) const;
  Vec2 corner_miss(const Camera& camera, std::size_t i, Vec2 found) const;
  bool is_free(const char* key) const;
  void linearise();
  template <class Function>
  void add_known(double residual, double deviation, const Function& value);
  void add_all_known();
  void add(const FittedPoint& point);
  void update_noise();
  double blur_rms() const;
  bool has_blur(std::size_t i) const;
  double predicted_blur(const CameraSpec& spec, std::size_t i) const;
  FittedPoint row_of_blur(std::size_t i, const std::vector<Camera>& moved) const;
  void apply(const Eigen::VectorXd& change);
  FittedPoint row_of_corner(std::size_t i, const Camera& camera, const std::vector<Camera>& moved);
  FittedPoint row_of_centre(std::size_t i, const Camera& camera, const std::vector<Camera>& moved);
  /// Finds the residuals. Calls take(observation, row) for each used corner, its blur, and each
  /// centre, whose numbers come after the corners'.
  template <class Take>
  void each_row(const Take& take);

  Eigen::Index values() const { return static_cast<Eigen::Index>(free_.size()); }
  Eigen::Index first_of_pose(std::size_t pose) const {
    return values() + 6 * static_cast<Eigen::Index>(pose);
  }
  Eigen::Index first_of_outwards() const { return first_of_pose(poses_.size()); }
  Eigen::Index first_of_points() const {
    return first_of_outwards() +
           (looseness_.outwards > 0 ? static_cast<Eigen::Index>(outwards_.size()) : 0);
  }
  Eigen::Index blur_scale() const {
    return first_of_points() +
           (looseness_.board > 0 ? 3 * static_cast<Eigen::Index>(points_.size()) : 0);
  }
  Eigen::Index unknowns() const { return blur_scale() + (microlens_ > 0 ? 2 : 0); }

  CameraSpec spec_;
  const GeometryObservations* seen_;
  std::vector<LensIndex> lenses_;
  std::vector<std::size_t> type_of_, pose_of_, point_of_;  ///< of each corner
  std::vector<bool> used_;
  std::map<int, std::size_t> pose_index_;
  std::vector<Vec2> nominal_points_;
  std::vector<RigidTransform> poses_;
  std::vector<double> outwards_;  ///< of each type
  std::vector<Vec3> points_;      ///< [m] of each point of the board from its nominal place
  /// By which all blur exceeds that of the microlenses' apertures: a share, and [pixel].
  double blur_scale_ = 0, blur_offset_ = 0;
  double lens_radius_ = 0;  ///< [pixel]
  double microlens_ = 0;    ///< GeometrySettings::microlens; 0: blur is not used yet
  double blur_excess_ = 1;  ///< deviations of blur over the stated ones, before loose values
  std::vector<std::size_t> blur_types_;        ///< types of microlenses with such corners
  double microlens_change_ = 0;                ///< BlurMatch::change by places and blur alone
  std::vector<double> nominal_focal_lengths_;  ///< [m] of each type
  std::vector<bool> blur_used_;
  std::vector<double> blur_residuals_;  ///< over the stated deviations
  Looseness looseness_;
  std::vector<const FreeValue*> free_;
  std::vector<double> units_;
  Eigen::MatrixXd square_;
  Eigen::VectorXd right_;
  /// known_chi2_: the part of the cost that is not in pixels, over its variance
  double cost_ = 0, known_chi2_ = 0, noise2_ = 1, radii_residual_ = 0;
  std::vector<Eigen::VectorXd> known_rows_;
  Looseness effective_;  ///< counts of loose values that the observations determine
  std::vector<Vec2> residuals_, centre_residuals_;
};

}  // namespace plenoflame
