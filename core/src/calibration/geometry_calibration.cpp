#include "plenoflame/calibration/geometry_calibration.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "calibration/free_values.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/camera/camera.h"

namespace plenoflame {
namespace {

constexpr int kMostFitSteps = 100;
constexpr double kFitConverged = 1e-10;  ///< relative change of the sum of squares
/// A pose that is turned over leaves less than this part of the squares, or stays as it was.
constexpr double kTurnedOver = 0.95;
constexpr int kMostTurns = 5;
constexpr double kNotDetermined = 1e-9;  ///< least eigenvalue of the scaled normal matrix

/// The plane of which the image is distorted but sharp is searched for where it would be known to
/// this part of its distance. Distortion that is noise tells it to a half at best; and where it
/// stays as it is, so much of it changes the picture by no more than the noise of all corners.
constexpr double kKnownPlane = 0.1;

/// The camera with its stop wide open: corners may be seen by rays that its own stop ends.
Camera open_camera(CameraSpec spec) {
  spec.lens.diameter *= 2;
  spec.array.diameter = spec.array.pitch;
  spec.array.diameter_y = 0;
  spec.array.aperture = ApertureShape::circular;
  spec.focus.mode = FocusMode::distance;
  return Camera(spec);
}

/// The straight line that is seen at a pixel through the middle of a microlens.
struct SeenLine {
  Vec2 place, slope;  ///< at z = 0, and dx/dz, dy/dz
  Vec2 at(double z) const { return place + z * slope; }
};

SeenLine seen_line(const Camera& camera, LensIndex lens, Vec2 sensor_point) {
  const Vec3 middle = camera.lens_place(lens);
  const Ray ray = camera.trace(sensor_point, lens, {middle.x, middle.y}).exit;
  const Vec2 slope{ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z};
  return {Vec2{ray.origin.x, ray.origin.y} - ray.origin.z * slope, slope};
}

/// The point at which that line meets the plane of the main lens, from its middle.
Vec2 at_main_lens(const Camera& camera, LensIndex lens, Vec2 sensor_point) {
  return camera.at_stop(sensor_point, lens)
      .value_or(Vec2{std::numeric_limits<double>::quiet_NaN(), 0});
}

/// Inverse of the derivative of a function of the sensor point, times -1 / pixel: what turns a miss
/// into pixels.
struct ToPixels {
  double xx = 0, xy = 0, yx = 0, yy = 0;
  Vec2 operator()(Vec2 miss) const {
    return {xx * miss.x + xy * miss.y, yx * miss.x + yy * miss.y};
  }
};

template <class Function>
ToPixels to_pixels(const Camera& camera, Vec2 s, const Function& f) {
  const Vec2 p = camera.spec().sensor.pixel();
  const double h = 0.01;
  const Vec2 u = (0.5 / h) * (f(s + Vec2{h * p.x, 0}) - f(s - Vec2{h * p.x, 0}));
  const Vec2 v = (0.5 / h) * (f(s + Vec2{0, h * p.y}) - f(s - Vec2{0, h * p.y}));
  const double determinant = u.x * v.y - v.x * u.y;
  // The picture is upside down on the sensor.
  const double k = -1 / determinant;
  return {k * v.y, -k * v.x, -k * u.y, k * u.x};
}

Mat3 turned_by(const Mat3& rotation, Vec3 w) {
  const double angle = length(w);
  if (angle == 0) return rotation;
  const Vec3 e = (1 / angle) * w;
  const double c = std::cos(angle), s = std::sin(angle), k = 1 - c;
  const Mat3 turn{{{{c + k * e.x * e.x, k * e.x * e.y - s * e.z, k * e.x * e.z + s * e.y},
                    {k * e.x * e.y + s * e.z, c + k * e.y * e.y, k * e.y * e.z - s * e.x},
                    {k * e.x * e.z - s * e.y, k * e.y * e.z + s * e.x, c + k * e.z * e.z}}}};
  return rotation * turn;
}

class GeometryFit {
 public:
  GeometryFit(const CameraSpec& start, const std::vector<CornerObservation>& corners,
              const std::vector<CentreObservation>& centres)
      : spec_(start), corners_(corners), centres_(centres), used_(corners.size(), true) {
    for (const CornerObservation& corner : corners)
      pose_index_.emplace(corner.pose, pose_index_.size());
    std::size_t k = 0;
    for (auto& [pose, index] : pose_index_) index = k++;
    poses_.resize(pose_index_.size());
    const Camera camera = open_camera(spec_);
    const double shrink = -camera.array_front() / -camera.sensor();
    for (const CornerObservation& corner : corners) {
      const Vec2 s = camera.sensor_point(corner.pixel.x, corner.pixel.y);
      lenses_.push_back(corner.lens.value_or(
          camera.lattice().nearest(camera.foot() + shrink * (s - camera.foot()))));
    }
  }

  /// Each board by a homography to the directions from the middle of the lens in which its corners
  /// are seen on the plane in focus.
  void start_poses() {
    const Camera camera = open_camera(spec_);
    const double focus = plane_in_focus(camera);
    for (const auto& [pose, index] : pose_index_) {
      Eigen::Matrix<double, 9, 9> square = Eigen::Matrix<double, 9, 9>::Zero();
      double size = 0;
      std::size_t count = 0;
      for (std::size_t i = 0; i < corners_.size(); ++i)
        if (corners_[i].pose == pose) size += length(corners_[i].board), ++count;
      if (count < 8)
        throw InputError("pose " + std::to_string(pose) + " has " + std::to_string(count) +
                         " corners; at least 8 are needed");
      size /= static_cast<double>(count);
      for (std::size_t i = 0; i < corners_.size(); ++i) {
        if (corners_[i].pose != pose) continue;
        const Vec2 s = camera.sensor_point(corners_[i].pixel.x, corners_[i].pixel.y);
        const Vec2 t =
            (1 / focus) * (seen_line(camera, lenses_[i], s).at(focus) - spec_.lens.decentre);
        const Eigen::Vector3d b(corners_[i].board.x / size, corners_[i].board.y / size, 1);
        Eigen::Matrix<double, 9, 1> row;
        row << b, Eigen::Vector3d::Zero(), -t.x * b;
        square += row * row.transpose();
        row << Eigen::Vector3d::Zero(), b, -t.y * b;
        square += row * row.transpose();
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(square);
      const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
      Eigen::Matrix3d m;
      m.row(0) = h.segment<3>(0).transpose();
      m.row(1) = h.segment<3>(3).transpose();
      m.row(2) = h.segment<3>(6).transpose();
      m.col(0) /= size;
      m.col(1) /= size;
      m *= 2 / (m.col(0).norm() + m.col(1).norm());
      if (m(2, 2) < 0) m = -m;
      const Eigen::Vector3d t = m.col(2);
      m.col(2) = m.col(0).cross(m.col(1));
      const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
      const Eigen::Matrix3d r = svd.matrixU() * svd.matrixV().transpose();
      RigidTransform& place = poses_[index];
      for (int k = 0; k < 3; ++k)
        place.rotation.rows[static_cast<std::size_t>(k)] = {r(k, 0), r(k, 1), r(k, 2)};
      place.translation = {t.x() + spec_.lens.decentre.x, t.y() + spec_.lens.decentre.y, t.z()};
    }
  }

  /// Least squares over poses and these values of the camera.
  int solve(const std::vector<const FreeValue*>& free, const Execution& execution) {
    free_ = free;
    double damping = 1e-6, cost = 0;
    linearise();
    cost = cost_;
    int step = 0;
    for (; step < kMostFitSteps; ++step) {
      if (execution.stop.stop_requested()) throw Cancelled();
      const auto spec = spec_;
      const auto poses = poses_;
      const Eigen::MatrixXd square = square_;
      const Eigen::VectorXd right = right_;
      bool better = false;
      for (int attempt = 0; attempt < 12 && !better; ++attempt) {
        Eigen::MatrixXd damped = square;
        damped.diagonal() *= 1 + damping;
        apply(-damped.ldlt().solve(right));
        bool sound = true;
        try {
          linearise();
        } catch (const InputError&) {  // a camera that cannot be
          sound = false;
        }
        better = sound && std::isfinite(cost_) && cost_ <= cost;
        if (better) break;
        spec_ = spec;
        poses_ = poses;
        damping *= 10;
      }
      if (!better) {
        linearise();
        break;
      }
      damping = std::max(1e-12, 0.1 * damping);
      const double change = cost - cost_;
      cost = cost_;
      if (change <= kFitConverged * cost) break;
    }
    return step;
  }

  /// A board far away looks the same when it is tilted the other way (Schweighofer and Pinz, IEEE
  /// PAMI 28 (2006) 2024): each pose becomes the other one where that leaves less.
  /// @return whether one did
  bool turn_poses_over(const Execution& execution) {
    const std::vector<RigidTransform> poses = poses_;
    const std::vector<double> costs = pose_costs();
    for (RigidTransform& pose : poses_) {
      const Vec3 view = normalize(pose.translation);
      const auto& r = pose.rotation.rows;
      const auto mirrored = [&](Vec3 v) { return v - (2 * dot(view, v)) * view; };
      const Vec3 x = mirrored({r[0].x, r[1].x, r[2].x}), y = mirrored({r[0].y, r[1].y, r[2].y}),
                 z = cross(x, y);
      pose.rotation.rows = {Vec3{x.x, y.x, z.x}, Vec3{x.y, y.y, z.y}, Vec3{x.z, y.z, z.z}};
    }
    solve({}, execution);
    const std::vector<double> other = pose_costs();
    bool any = false;
    for (std::size_t p = 0; p < poses.size(); ++p)
      if (other[p] < kTurnedOver * costs[p])
        any = true;
      else
        poses_[p] = poses[p];
    linearise();
    return any;
  }

  /// @throws InputError naming the values between which the observations do not tell
  void check_determined() const {
    const auto n = static_cast<Eigen::Index>(free_.size());
    if (n == 0) return;
    const Eigen::Index rest = square_.rows() - n;
    const Eigen::MatrixXd cc = square_.topLeftCorner(n, n), cp = square_.topRightCorner(n, rest),
                          pp = square_.bottomRightCorner(rest, rest);
    Eigen::MatrixXd reduced = cc - cp * pp.ldlt().solve(cp.transpose());
    Eigen::VectorXd scale(n);
    for (Eigen::Index i = 0; i < n; ++i) scale(i) = cc(i, i) > 0 ? 1 / std::sqrt(cc(i, i)) : 0;
    reduced = scale.asDiagonal() * reduced * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(0.5 *
                                                                (reduced + reduced.transpose()));
    if (solver.eigenvalues()(0) > kNotDetermined) return;
    const Eigen::VectorXd worst = solver.eigenvectors().col(0);
    std::string names;
    for (Eigen::Index i = 0; i < n; ++i)
      if (std::fabs(worst(i)) > 0.2 * worst.cwiseAbs().maxCoeff() || cc(i, i) == 0) {
        if (!names.empty()) names.append(", ");
        names.append(free_[static_cast<std::size_t>(i)]->key);
      }
    throw InputError("the observations do not determine " + names +
                     " (together, where there are several): give more poses at other distances and "
                     "angles, or centres of micro-images, or search for fewer values");
  }

  /// Marks corners that are far off. @return how many
  std::size_t leave_out(double times) {
    const double limit = times * corner_rms();
    std::size_t count = 0;
    for (std::size_t i = 0; i < corners_.size(); ++i)
      if (used_[i] && !(length(residuals_[i]) <= limit)) {
        used_[i] = false;
        ++count;
      }
    return count;
  }

  double corner_rms() const { return rms(residuals_, used_); }

  /// True if the corners determine the plane of the distortion, one of these values, as the camera
  /// is now.
  bool knows_plane(const std::vector<const FreeValue*>& free) {
    free_ = free;
    linearise();
    for (const CalibratedValue& value : result(0).values)
      if (value.key.ends_with(".distance"))
        return std::isfinite(value.error) && value.error > 0 &&
               value.error < kKnownPlane * value.value;
    return false;
  }

  void put_plane(double distance) { spec_.lens.distortion.distance = distance; }
  double plane() const { return spec_.lens.distortion.distance; }

  GeometryCalibration result(int steps) const {
    GeometryCalibration result;
    result.camera = spec_;
    result.corner_rms = corner_rms();
    result.centre_rms = rms(centre_residuals_, std::vector<bool>(centres_.size(), true));
    result.centres = centres_.size();
    result.residuals = residuals_;
    for (std::size_t i = 0; i < used_.size(); ++i) {
      result.corners += used_[i] ? 1 : 0;
      if (!used_[i])
        result.residuals[i] = {std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::quiet_NaN()};
    }
    result.left_out = used_.size() - result.corners;
    result.steps = steps;
    for (const auto& [pose, index] : pose_index_) {
      std::vector<bool> own(corners_.size());
      for (std::size_t i = 0; i < own.size(); ++i) own[i] = used_[i] && corners_[i].pose == pose;
      result.poses.push_back({pose, poses_[index], rms(residuals_, own)});
    }
    const double count = 2.0 * static_cast<double>(result.corners + result.centres);
    const double freedom = count - static_cast<double>(square_.rows());
    const Eigen::MatrixXd covariance =
        (cost_ / freedom) *
        square_.ldlt().solve(Eigen::MatrixXd::Identity(square_.rows(), square_.rows()));
    CameraSpec copy = spec_;
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      result.values.push_back({free_[i]->key, free_[i]->of(copy),
                               units_[i] * std::sqrt(std::max(0.0, covariance(k, k)))});
      std::vector<double>& row = result.covariance.emplace_back();
      for (std::size_t j = 0; j < free_.size(); ++j)
        row.push_back(units_[i] * units_[j] * covariance(k, static_cast<Eigen::Index>(j)));
    }
    return result;
  }

  static double plane_in_focus(const Camera& camera) {
    const double f = camera.ideal().focal_length;
    const double distance = 1 / (1 / f - 1 / camera.lens_distance());
    return distance > 0 && std::isfinite(distance) ? distance : 1e3 * f;
  }

 private:
  static double rms(const std::vector<Vec2>& residuals, const std::vector<bool>& used) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < residuals.size(); ++i)
      if (used[i]) sum += dot(residuals[i], residuals[i]), ++count;
    return count ? std::sqrt(sum / static_cast<double>(count)) : 0;
  }

  /// Sum of squares of each pose's corners.
  std::vector<double> pose_costs() const {
    std::vector<double> costs(poses_.size());
    for (std::size_t i = 0; i < corners_.size(); ++i)
      if (used_[i]) costs[pose_index_.at(corners_[i].pose)] += dot(residuals_[i], residuals_[i]);
    return costs;
  }

  Vec3 in_camera(std::size_t i) const {
    const RigidTransform& pose = poses_[pose_index_.at(corners_[i].pose)];
    return pose.point({corners_[i].board.x, corners_[i].board.y, 0});
  }

  Vec2 corner_miss(const Camera& camera, std::size_t i, Vec3 corner) const {
    const Vec2 s = camera.sensor_point(corners_[i].pixel.x, corners_[i].pixel.y);
    return seen_line(camera, lenses_[i], s).at(corner.z) - Vec2{corner.x, corner.y};
  }

  /// Residuals and normal equations where the camera and the poses are now.
  void linearise() {
    const Camera camera = open_camera(spec_);
    const std::size_t n = free_.size();
    std::vector<Camera> moved;
    units_.clear();
    for (const FreeValue* value : free_) {
      CameraSpec spec = spec_;
      units_.push_back(value->scale(spec_));
      value->of(spec) += value->step * units_.back();
      moved.push_back(open_camera(spec));
    }
    const auto size = static_cast<Eigen::Index>(n + 6 * poses_.size());
    square_ = Eigen::MatrixXd::Zero(size, size);
    right_ = Eigen::VectorXd::Zero(size);
    cost_ = 0;
    residuals_.assign(corners_.size(), {});
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Vec3 corner = in_camera(i);
      const Vec2 s = camera.sensor_point(corners_[i].pixel.x, corners_[i].pixel.y);
      const ToPixels pixels = to_pixels(
          camera, s, [&](Vec2 at) { return seen_line(camera, lenses_[i], at).at(corner.z); });
      const Vec2 miss = corner_miss(camera, i, corner);
      residuals_[i] = pixels(miss);
      if (!used_[i]) continue;
      Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, static_cast<Eigen::Index>(n + 6));
      const auto put = [&](std::size_t column, Vec2 change) {
        const Vec2 p = pixels(change);
        rows.col(static_cast<Eigen::Index>(column)) << p.x, p.y;
      };
      for (std::size_t k = 0; k < n; ++k)
        put(k, (1 / free_[k]->step) * (corner_miss(moved[k], i, corner) - miss));
      const std::size_t pose = pose_index_.at(corners_[i].pose);
      const Vec2 slope = seen_line(camera, lenses_[i], s).slope;
      const Vec3 v{corners_[i].board.x, corners_[i].board.y, 0};
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 e{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
        const Vec3 turned = poses_[pose].rotation * cross(e, v);
        put(n + k, turned.z * slope - Vec2{turned.x, turned.y});
        put(n + 3 + k, e.z * slope - Vec2{e.x, e.y});
      }
      add(rows, residuals_[i], n, n + 6 * pose, 6);
    }
    centre_residuals_.assign(centres_.size(), {});
    for (std::size_t i = 0; i < centres_.size(); ++i) {
      const LensIndex lens = centres_[i].lens;
      const Vec2 s = camera.sensor_point(centres_[i].pixel.x, centres_[i].pixel.y);
      const auto miss_of = [&](const Camera& c, Vec2 at) { return at_main_lens(c, lens, at); };
      const ToPixels pixels = to_pixels(camera, s, [&](Vec2 at) { return miss_of(camera, at); });
      const Vec2 miss = miss_of(camera, s);
      centre_residuals_[i] = pixels(miss);
      Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, static_cast<Eigen::Index>(n));
      for (std::size_t k = 0; k < n; ++k) {
        const Vec2 p = pixels((1 / free_[k]->step) * (miss_of(moved[k], s) - miss));
        rows.col(static_cast<Eigen::Index>(k)) << p.x, p.y;
      }
      add(rows, centre_residuals_[i], n, 0, 0);
    }
  }

  void add(const Eigen::Matrix<double, 2, Eigen::Dynamic>& rows, Vec2 residual, std::size_t n,
           std::size_t pose, std::size_t pose_size) {
    const Eigen::Vector2d r(residual.x, residual.y);
    const Eigen::MatrixXd square = rows.transpose() * rows;
    const Eigen::VectorXd right = rows.transpose() * r;
    const auto a = static_cast<Eigen::Index>(n), b = static_cast<Eigen::Index>(pose),
               c = static_cast<Eigen::Index>(pose_size);
    square_.topLeftCorner(a, a) += square.topLeftCorner(a, a);
    right_.head(a) += right.head(a);
    if (c > 0) {
      square_.block(0, b, a, c) += square.topRightCorner(a, c);
      square_.block(b, 0, c, a) += square.bottomLeftCorner(c, a);
      square_.block(b, b, c, c) += square.bottomRightCorner(c, c);
      right_.segment(b, c) += right.tail(c);
    }
    cost_ += r.squaredNorm();
  }

  void apply(const Eigen::VectorXd& change) {
    for (std::size_t k = 0; k < free_.size(); ++k)
      free_[k]->of(spec_) += units_[k] * change(static_cast<Eigen::Index>(k));
    for (std::size_t p = 0; p < poses_.size(); ++p) {
      const auto at = static_cast<Eigen::Index>(free_.size() + 6 * p);
      poses_[p].rotation =
          turned_by(poses_[p].rotation, {change(at), change(at + 1), change(at + 2)});
      poses_[p].translation =
          poses_[p].translation + Vec3{change(at + 3), change(at + 4), change(at + 5)};
    }
  }

  CameraSpec spec_;
  const std::vector<CornerObservation>& corners_;
  const std::vector<CentreObservation>& centres_;
  std::vector<LensIndex> lenses_;
  std::vector<bool> used_;
  std::map<int, std::size_t> pose_index_;
  std::vector<RigidTransform> poses_;
  std::vector<const FreeValue*> free_;
  std::vector<double> units_;
  Eigen::MatrixXd square_;
  Eigen::VectorXd right_;
  double cost_ = 0;
  std::vector<Vec2> residuals_, centre_residuals_;
};

}  // namespace

namespace {

/// @throws InputError where what was seen lies neither on the sensor nor within a micro-image of
/// it, whose edge may cut off the part where the centre or, with noise, a corner is
void check_on_sensor(const CameraSpec& camera, const std::string& what, Vec2 pixel) {
  const SensorSpec& sensor = camera.sensor;
  const Vec2 margin{camera.array.pitch / sensor.pixel().x, camera.array.pitch / sensor.pixel().y};
  if (pixel.x >= -margin.x && pixel.y >= -margin.y && pixel.x <= sensor.columns + margin.x &&
      pixel.y <= sensor.rows + margin.y)
    return;
  throw InputError(
      fmt::format("{} at column {:.6g}, row {:.6g} does not lie on the camera's sensor of {} x {} "
                  "pixels: is it another camera's?",
                  what, pixel.x, pixel.y, sensor.columns, sensor.rows));
}

/// @param free what was searched for @param rms_of_start with the poses alone
/// @throws InputError where lengths ran away, or the camera to start with explains more
void check_plausible(const CameraSpec& start, const std::vector<const FreeValue*>& free,
                     double rms_of_start, const GeometryCalibration& found) {
  constexpr double kMost = 2;  // times, or a half: values to start with are those of a data sheet
  const char* const what_to_do =
      "give more poses at other distances and angles, or centres of micro-images, search for fewer "
      "values, or check whether the corners are this camera's";
  CameraSpec before = start, after = found.camera;
  for (const FreeValue* value : free) {
    const std::string key = value->key;
    if (!key.ends_with("focal_length") && !key.ends_with("lens_distance") &&
        !key.ends_with("sensor_distance") && !key.ends_with("pitch"))
      continue;
    const double from = value->of(before), to = value->of(after);
    if (to > from / kMost && to < from * kMost) continue;
    throw InputError(fmt::format("the fit ran away: {} went from {} to {}; {}", key,
                                 readable_quantity(from, Dimension::length),
                                 readable_quantity(to, Dimension::length), what_to_do));
  }
  if (found.corner_rms > rms_of_start)
    throw InputError(fmt::format(
        "the camera that was found leaves {:.3g} pixels RMS of the corners, the one to start with "
        "{:.3g}; {}",
        found.corner_rms, rms_of_start, what_to_do));
}

}  // namespace

GeometryCalibration calibrate_geometry(const CameraSpec& start,
                                       const std::vector<CornerObservation>& corners,
                                       const std::vector<CentreObservation>& centres,
                                       const GeometrySettings& settings,
                                       const Execution& execution) {
  if (!(start.lens.model == LensModel::ideal && start.lens.surfaces.empty() &&
        start.array.present && start.array.model == LensModel::ideal))
    throw InputError(
        "calibrate geometry starts from a camera with a thin ideal main lens and ideal "
        "microlenses; "
        "give one (camera import writes such)");
  if (corners.empty()) throw InputError("there is no corner among the observations");
  for (const CornerObservation& corner : corners)
    check_on_sensor(start, fmt::format("a corner of pose {}", corner.pose), corner.pixel);
  for (const CentreObservation& centre : centres)
    check_on_sensor(start, "a micro-image's centre", centre.pixel);
  const Camera camera(start);
  CameraSpec spec = start;
  spec.focus.mode = FocusMode::distance;
  spec.focus.lens_distance = camera.lens_distance();
  spec.array.measured_from = ArrayReference::principal_plane;
  spec.array.sensor_distance = camera.microlenses()[0].sensor_distance;
  spec.array.spacing_error = 0;
  const std::vector<const FreeValue*> free = chosen_values(settings, !centres.empty());
  const auto plane = std::find_if(free.begin(), free.end(), is_plane);
  const bool finds_plane = plane != free.end();
  // Distortion that is not there yet begins with the plane in focus.
  if (spec.lens.distortion.none() || (finds_plane && !std::isfinite(spec.lens.distortion.distance)))
    spec.lens.distortion.distance = GeometryFit::plane_in_focus(camera);
  GeometryFit fit(spec, corners, centres);
  fit.start_poses();
  fit.solve({}, execution);
  fit.turn_poses_over(execution);
  const double rms_of_start = fit.corner_rms();
  // Without distortion nothing tells of its plane: that comes last.
  std::vector<const FreeValue*> found = free;
  if (finds_plane) found.erase(found.begin() + (plane - free.begin()));
  int steps = fit.solve(found, execution);
  // A better camera tells more about the poses.
  for (int round = 0; round < kMostTurns && fit.turn_poses_over(execution); ++round)
    steps += fit.solve(found, execution);
  steps += fit.solve(found, execution);
  fit.check_determined();
  const auto solve_all = [&] {
    steps += fit.solve(found, execution);
    if (!finds_plane) return;
    const double before = fit.plane();
    const bool is_asked_for =
        std::find(settings.free.begin(), settings.free.end(), (*plane)->key) != settings.free.end();
    if (is_asked_for || fit.knows_plane(free)) {
      steps += fit.solve(free, execution);
      if (is_asked_for || fit.knows_plane(free)) return;
      fit.put_plane(before);
    }
    steps += fit.solve(found, execution);
  };
  if (finds_plane) solve_all();
  if (settings.outlier > 0 && fit.leave_out(settings.outlier) > 0) solve_all();
  fit.check_determined();
  GeometryCalibration result = fit.result(steps);
  check_plausible(spec, found, rms_of_start, result);
  result.camera.array.diameter = std::min(start.array.diameter, result.camera.array.pitch);
  return result;
}

}  // namespace plenoflame
