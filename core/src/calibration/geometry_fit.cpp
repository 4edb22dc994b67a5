#include "calibration/geometry_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/seen_lines.h"
#include "math/levenberg_marquardt.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr int kMostFitSteps = 100;
constexpr double kFitConverged = 1e-10;   ///< relative change of the sum of squares
constexpr double kNotDetermined = 1e-9;   ///< least eigenvalue of the scaled normal matrix
constexpr double kLeastNoise2 = 1e-6;     ///< [pixel^2] no corner is known better
constexpr int kMostLooseRounds = 12;      ///< of standard deviations of loose values
constexpr double kLooseConverged = 0.03;  ///< relative change of such a deviation
constexpr double kBlurScale = 0.02, kBlurOffset = 0.03;  ///< deviations, the second in pixels
/// Number of an observation that is the blur of a corner.
constexpr std::size_t kBlurOfCorner = std::numeric_limits<std::size_t>::max();
constexpr Eigen::Index kDistanceOfPose = 5;     ///< of the 6 unknowns of a pose
constexpr Eigen::Index kUnknownsOfCorner = 10;  ///< 6 of the pose, outwards, 3 of the point

/// The fit searches for the distance of the plane whose image is distorted but sharp. The distance
/// is accepted if its relative error is below this value. Noise that looks like distortion
/// determines it to one half at best. Holding a distance of this error changes the picture by no
/// more than the noise of all corners.
constexpr double kKnownPlane = 0.1;

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

double rms(const std::vector<Vec2>& residuals, const std::vector<bool>& used) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (used[i]) sum += dot(residuals[i], residuals[i]), ++count;
  return count ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

}  // namespace

GeometryFit::GeometryFit(const CameraSpec& start, const GeometryObservations& seen)
    : spec_(start), seen_(&seen), used_(seen.corners.size(), true) {
  const std::vector<CornerObservation>& corners = seen_->corners;
  std::map<std::pair<double, double>, std::size_t> points;
  for (const CornerObservation& corner : corners) {
    pose_index_.emplace(corner.pose, 0);
    if (points.emplace(std::pair{corner.board.x, corner.board.y}, nominal_points_.size()).second)
      nominal_points_.push_back(corner.board);
  }
  std::size_t k = 0;
  for (auto& [pose, index] : pose_index_) index = k++;
  poses_.resize(pose_index_.size());
  points_.resize(nominal_points_.size());
  outwards_.resize(spec_.array.types.size());
  lens_radius_ = Camera(spec_).aperture().radius() / spec_.sensor.pixel_pitch;
  for (const MicrolensSpec& type : spec_.array.types)
    nominal_focal_lengths_.push_back(type.focal_length);
  blur_used_.resize(corners.size(), true);
  blur_residuals_.resize(corners.size());
  const Camera camera = open_camera(spec_);
  const double shrink = -camera.array_front() / -camera.sensor();
  for (const CornerObservation& corner : corners) {
    const Vec2 s = camera.sensor_point(corner.pixel.x, corner.pixel.y);
    lenses_.push_back(corner.lens.value_or(
        camera.lattice().nearest(camera.foot() + shrink * (s - camera.foot()))));
    type_of_.push_back(static_cast<std::size_t>(camera.lattice().type(lenses_.back())));
    pose_of_.push_back(pose_index_.at(corner.pose));
    point_of_.push_back(points.at({corner.board.x, corner.board.y}));
  }
}

void GeometryFit::put(const State& state) {
  spec_ = state.spec;
  poses_ = state.poses;
  outwards_ = state.outwards;
  points_ = state.points;
  blur_scale_ = state.blur_scale;
  blur_offset_ = state.blur_offset;
}

int GeometryFit::solve(const std::vector<const FreeValue*>& free, const Execution& execution) {
  free_ = free;
  State best = state();
  NormalEquations<Eigen::Dynamic> here;
  const int steps = minimise(
      best, here,
      [&](const State& next) -> std::optional<NormalEquations<Eigen::Dynamic>> {
        if (execution.stop.stop_requested()) throw Cancelled();
        put(next);
        try {
          linearise();
        } catch (const InputError&) {  // a camera that cannot be
          return std::nullopt;
        }
        return NormalEquations<Eigen::Dynamic>{square_, -right_, cost_};
      },
      [&](const State& from, const Eigen::VectorXd& change) {
        put(from);
        apply(change);
        return state();
      },
      {kMostFitSteps, 1e-6, 1e6, kFitConverged});
  put(best);
  linearise();
  return steps;
}

void GeometryFit::update_noise() {
  double squares = 0, count = 0;
  for (std::size_t i = 0; i < used_.size(); ++i)
    if (used_[i]) squares += dot(residuals_[i], residuals_[i]), count += 2;
  const double freedom = count - static_cast<double>(first_of_outwards());
  noise2_ = std::max(kLeastNoise2, squares / std::max(1.0, freedom));
}

/// RMS of what the fit leaves of blur, over the stated deviations. 0: there is none.
double GeometryFit::blur_rms() const {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < used_.size(); ++i)
    if (has_blur(i)) sum += blur_residuals_[i] * blur_residuals_[i], count += 1;
  return count > 0 ? std::sqrt(sum / count) : 0;
}

int GeometryFit::loosen(double Looseness::*which, double start, const Execution& execution) {
  const State before = state();
  const Looseness held = looseness_;
  update_noise();
  linearise();
  const double known = known_chi2_, cost = cost_ - known * noise2_;
  looseness_.*which = start;
  int steps = 0;
  for (int round = 0; round < kMostLooseRounds; ++round) {
    update_noise();
    steps += solve(free_, execution);
    if (update_looseness() < kLooseConverged) break;
  }
  // Values that are noise leave less by their count, give or take its deviation.
  const double gain = (cost - cost_) / noise2_ + known;
  const double count = effective_.*which;
  if (gain > count + 3 * std::sqrt(2 * count)) return steps;
  looseness_ = held;
  put(before);
  update_noise();
  linearise();
  return steps;
}

/// One step to the standard deviations by which the observations are most probable. These are the
/// squares over the count of values that the observations determine (MacKay 1992, Neural
/// Computation 4, 415). @return the largest relative change
double GeometryFit::update_looseness() {
  const Eigen::MatrixXd inverse =
      square_.ldlt().solve(Eigen::MatrixXd::Identity(square_.rows(), square_.rows()));
  struct Group {
    double squares = 0, effective = 0;
  } outwards, board;
  for (const LooseValue& loose : loose_values()) {
    if (microlens_ > 0 && loose.unknown >= blur_scale()) continue;  // its deviation is given
    Group& group = loose.unknown < first_of_points() ? outwards : board;
    group.squares += loose.value * loose.value;
    group.effective += 1 - loose.weight * inverse(loose.unknown, loose.unknown);
  }
  double change = 0;
  const auto update = [&](double& deviation, const Group& group) {
    if (!(deviation > 0)) return;
    const double found = std::sqrt(group.squares / std::max(group.effective, 1e-3));
    const double next = std::clamp(found, 0.2 * deviation, 5 * deviation);
    change = std::max(change, std::fabs(next / deviation - 1));
    deviation = next;
  };
  update(looseness_.outwards, outwards);
  update(looseness_.board, board);
  effective_ = {outwards.effective, board.effective};
  return change;
}

void GeometryFit::check_determined() const {
  const Eigen::Index n = values();
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
                   "angles, " +
                   (seen_->centres.empty() ? "or centres of micro-images, " : "") +
                   "or search for fewer values");
}

std::size_t GeometryFit::leave_out(double times) {
  const double limit = times * corner_rms();
  std::size_t count = 0;
  for (std::size_t i = 0; i < used_.size(); ++i)
    if (used_[i] && !(length(residuals_[i]) <= limit)) {
      used_[i] = false;
      ++count;
    }
  return count;
}

double GeometryFit::corner_rms() const {
  return rms(residuals_, used_);
}

bool GeometryFit::knows_plane(const std::vector<const FreeValue*>& free) {
  free_ = free;
  linearise();
  const auto plane = std::find_if(free.begin(), free.end(), is_plane) - free.begin();
  const auto used = static_cast<double>(std::count(used_.begin(), used_.end(), true));
  const double freedom =
      2 * (used + static_cast<double>(seen_->centres.size())) - static_cast<double>(square_.rows());
  const Eigen::VectorXd unit = Eigen::VectorXd::Unit(square_.rows(), plane);
  const double variance = cost_ / freedom * unit.dot(square_.ldlt().solve(unit));
  return variance > 0 && std::sqrt(variance) * units_[static_cast<std::size_t>(plane)] <
                             kKnownPlane * spec_.lens.distortion.distance;
}

GeometryCalibration GeometryFit::result(int steps, double pupil) {
  GeometryCalibration result;
  result.camera = spec_;
  result.corner_rms = corner_rms();
  result.centre_rms = rms(centre_residuals_, std::vector<bool>(seen_->centres.size(), true));
  result.centres = seen_->centres.size();
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
    std::vector<bool> own(used_.size());
    for (std::size_t i = 0; i < own.size(); ++i) own[i] = used_[i] && pose_of_[i] == index;
    result.poses.push_back({pose, poses_[index], rms(residuals_, own)});
  }
  if (looseness_.board > 0)
    for (std::size_t k = 0; k < points_.size(); ++k)
      result.board.push_back({nominal_points_[k], points_[k]});
  result.board_deviation = looseness_.board;
  FittedPoints fitted;
  fitted.points = fitted_points();
  fitted.square = square_;
  fitted.values = values();
  fitted.loose = loose_values();
  fitted.known = known_rows_;
  for (std::size_t p = 0; p < poses_.size(); ++p)
    fitted.others.push_back(first_of_pose(p) + kDistanceOfPose);
  fitted.noise2 = noise2_;
  if (seen_->radii) {
    // The cone of light behind a lens whose pupil lies elsewhere, by image distance and f-number.
    const double magnification = spec_.focus.lens_distance / spec_.lens.focal_length - 1;
    fitted.radii_by_pupil = -magnification * std::sqrt(noise2_) / seen_->radii->relative_error;
    result.radii = {seen_->radii->slope, slope_of_radii(spec_), seen_->radii->relative_error, 0};
  }
  const OutwardsDisplacement outwards = outwards_displacement(fitted.points, types());
  result.outwards = outwards.by_type;
  for (std::size_t t = 0; t < outwards_.size(); ++t) result.outwards[t] += outwards_[t];
  result.outwards_scatter = std::hypot(outwards.scatter, looseness_.outwards);
  const Eigen::MatrixXd covariance = geometry_covariance(fitted, result.outwards_scatter, pupil);
  for (std::size_t p = 0; p < poses_.size(); ++p) {
    const Eigen::Index k = values() + static_cast<Eigen::Index>(p);
    result.poses[p].distance_error = std::sqrt(std::max(0.0, covariance(k, k)));
  }
  if (microlens_ > 0) {
    result.blur = BlurMatch{0, blur_rms(), microlens_change_, 0};
    for (std::size_t i = 0; i < used_.size(); ++i) result.blur->corners += has_blur(i) ? 1 : 0;
  }
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

std::vector<FittedPoint> GeometryFit::fitted_points() {
  const Camera camera = open_camera(spec_);
  // A pupil elsewhere moves the centres; where there are none, the pitch was found from such.
  const bool is_told = !seen_->centres.empty() || is_free("camera.array.pitch");
  CameraSpec stretched = spec_;
  const double step = 1e-6, part = spec_.array.sensor_distance / spec_.focus.lens_distance;
  stretched.array.pitch *= 1 + step * part;
  const Camera with_pitch = open_camera(stretched);
  std::vector<FittedPoint> points;
  each_row([&](std::size_t i, const FittedPoint& row) {
    FittedPoint& point = points.emplace_back(row);
    if (i == kBlurOfCorner) return;
    const bool is_corner = point.pose != kNoPose;
    const std::size_t centre = i - used_.size();
    const Vec2 pixel = is_corner ? seen_->corners[i].pixel : seen_->centres[centre].pixel;
    point.lens = is_corner ? lenses_[i] : seen_->centres[centre].lens;
    point.type = static_cast<std::size_t>(camera.lattice().type(point.lens));
    const Vec2 s = camera.sensor_point(pixel.x, pixel.y);
    if (!is_corner) {
      const Vec3 place = camera.lens_place(point.lens);
      point.by_pupil = to_pixels(camera, s, [&](Vec2 at) {
        return at_main_lens(camera, point.lens, at);
      })(Vec2{place.x, place.y} - camera.foot());
      return;
    }
    const Vec2 from_middle = place_of(camera, i, s) - middle_of(camera, point.lens),
               size = spec_.sensor.pixel();
    point.offset = {-from_middle.x / size.x, -from_middle.y / size.y};
    if (is_told) return;
    point.by_pupil = to_pixels(camera, s, [&](Vec2 at) {
      return seen_line(camera, lenses_[i], at).at(in_camera(i).z);
    })((1 / step) * (corner_miss(with_pitch, i, s) - corner_miss(camera, i, s)));
  });
  return points;
}

std::vector<LooseValue> GeometryFit::loose_values() const {
  std::vector<LooseValue> values;
  const double noise = std::sqrt(noise2_);
  const auto add = [&](Eigen::Index unknown, double deviation, double value) {
    values.push_back({unknown, std::pow(noise / deviation, 2), value});
  };
  if (looseness_.outwards > 0)
    for (std::size_t t = 0; t < outwards_.size(); ++t)
      add(first_of_outwards() + static_cast<Eigen::Index>(t), looseness_.outwards, outwards_[t]);
  if (looseness_.board > 0)
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const Eigen::Index at = first_of_points() + 3 * static_cast<Eigen::Index>(k);
      add(at, looseness_.board, points_[k].x);
      add(at + 1, looseness_.board, points_[k].y);
      add(at + 2, looseness_.board, points_[k].z);
    }
  if (microlens_ > 0) {
    add(blur_scale(), kBlurScale, blur_scale_);
    add(blur_scale() + 1, kBlurOffset, blur_offset_);
  }
  return values;
}

double GeometryFit::plane_in_focus(const Camera& camera) {
  const double f = camera.ideal().focal_length;
  const double distance = 1 / (1 / f - 1 / camera.lens_distance());
  return distance > 0 && std::isfinite(distance) ? distance : 1e3 * f;
}

bool GeometryFit::is_free(const char* key) const {
  return std::any_of(free_.begin(), free_.end(),
                     [&](const FreeValue* value) { return std::string(value->key) == key; });
}

Vec3 GeometryFit::on_board(std::size_t i) const {
  const Vec2 nominal = seen_->corners[i].board;
  return Vec3{nominal.x, nominal.y, 0} + points_[point_of_[i]];
}

Vec2 GeometryFit::middle_of(const Camera& camera, LensIndex lens) const {
  const Vec3 place = camera.lens_place(lens);
  const double grow = camera.sensor() / camera.array_front();
  return camera.foot() + grow * (Vec2{place.x, place.y} - camera.foot());
}

Vec2 GeometryFit::found_at(const Camera& camera, std::size_t i) const {
  const Vec2 pixel = seen_->corners[i].pixel;
  return camera.sensor_point(pixel.x, pixel.y);
}

/// The sensor point at which a corner would be found without its displacement outwards.
Vec2 GeometryFit::place_of(const Camera& camera, std::size_t i, Vec2 found) const {
  const double outwards = outwards_[type_of_[i]];
  if (outwards == 0) return found;
  const Vec2 middle = middle_of(camera, lenses_[i]);
  return middle + (1 / (1 + outwards)) * (found - middle);
}

/// By which the line that is seen at a sensor point misses a corner.
Vec2 GeometryFit::corner_miss(const Camera& camera, std::size_t i, Vec2 found) const {
  const Vec3 corner = in_camera(i);
  return seen_line(camera, lenses_[i], place_of(camera, i, found)).at(corner.z) -
         Vec2{corner.x, corner.y};
}

FittedPoint GeometryFit::row_of_corner(std::size_t i, const Camera& camera,
                                       const std::vector<Camera>& moved) {
  FittedPoint point;
  const Eigen::Index n = values();
  point.rows.setZero(2, n + kUnknownsOfCorner);
  point.pose = pose_of_[i];
  const double z = in_camera(i).z;
  const Vec2 found = found_at(camera, i), size = spec_.sensor.pixel();
  // Pixels where the corner was found are those of its undisplaced place, stretched.
  const double stretch = 1 + outwards_[type_of_[i]];
  const auto pixels_at = [&](Vec2 place) {
    return to_pixels(camera, place_of(camera, i, place),
                     [&](Vec2 at) { return seen_line(camera, lenses_[i], at).at(z); });
  };
  const auto nearer = [&](Vec2 place, const ToPixels& pixels) {
    const Vec2 p = stretch * pixels(corner_miss(camera, i, place));
    return place + Vec2{size.x * p.x, size.y * p.y};
  };
  // Derivatives are those of the predicted place. At the found one their errors would be in
  // proportion to the residuals, and the least squares elsewhere.
  const Vec2 near = nearer(found, pixels_at(found));
  const ToPixels pixels = pixels_at(near);
  const Vec2 predicted = nearer(near, pixels);
  point.residual = {(predicted.x - found.x) / size.x, (predicted.y - found.y) / size.y};
  if (!used_[i]) return point;
  const Vec2 s = place_of(camera, i, predicted), miss = corner_miss(camera, i, predicted);
  const auto put = [&](Eigen::Index column, Vec2 change) {
    const Vec2 p = stretch * pixels(change);
    point.rows.col(column) << p.x, p.y;
  };
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto at = static_cast<std::size_t>(k);
    put(k, (1 / free_[at]->step) * (corner_miss(moved[at], i, predicted) - miss));
  }
  const Vec2 slope = seen_line(camera, lenses_[i], s).slope;
  const Mat3& rotation = poses_[point.pose].rotation;
  const auto by = [&](Vec3 move) { return move.z * slope - Vec2{move.x, move.y}; };
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Vec3 e{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
    put(n + k, by(rotation * cross(e, on_board(i))));
    put(n + 3 + k, by(e));
    put(n + 7 + k, by(rotation * e));
  }
  const Vec2 out = s - middle_of(camera, lenses_[i]);
  point.rows.col(n + 6) << out.x / size.x, out.y / size.y;
  point.blocks = {{0, 0, n}, {n, first_of_pose(point.pose), 6}};
  if (looseness_.outwards > 0)
    point.blocks.push_back(
        {n + 6, first_of_outwards() + static_cast<Eigen::Index>(type_of_[i]), 1});
  if (looseness_.board > 0)
    point.blocks.push_back(
        {n + 7, first_of_points() + 3 * static_cast<Eigen::Index>(point_of_[i]), 3});
  return point;
}

FittedPoint GeometryFit::row_of_centre(std::size_t i, const Camera& camera,
                                       const std::vector<Camera>& moved) {
  FittedPoint point;
  const LensIndex lens = seen_->centres[i].lens;
  const Vec2 pixel = seen_->centres[i].pixel, s = camera.sensor_point(pixel.x, pixel.y);
  const ToPixels pixels =
      to_pixels(camera, s, [&](Vec2 at) { return at_main_lens(camera, lens, at); });
  point.residual = pixels(at_main_lens(camera, lens, s));
  point.rows.setZero(2, values());
  const Vec2 size = spec_.sensor.pixel(),
             predicted = s + Vec2{size.x * point.residual.x, size.y * point.residual.y},
             miss = at_main_lens(camera, lens, predicted);
  for (std::size_t k = 0; k < free_.size(); ++k) {
    const Vec2 p = pixels((1 / free_[k]->step) * (at_main_lens(moved[k], lens, predicted) - miss));
    point.rows.col(static_cast<Eigen::Index>(k)) << p.x, p.y;
  }
  point.blocks = {{0, 0, values()}};
  return point;
}

template <class Take>
void GeometryFit::each_row(const Take& take) {
  const Camera camera = open_camera(spec_);
  std::vector<Camera> moved;
  units_.clear();
  for (const FreeValue* value : free_) {
    CameraSpec spec = spec_;
    units_.push_back(value->scale(spec_));
    value->of(spec) += value->step * units_.back();
    moved.push_back(open_camera(spec));
  }
  residuals_.assign(used_.size(), {});
  for (std::size_t i = 0; i < used_.size(); ++i) {
    const FittedPoint row = row_of_corner(i, camera, moved);
    residuals_[i] = row.residual;
    if (used_[i]) take(i, row);
    if (!has_blur(i)) continue;
    const FittedPoint blur = row_of_blur(i, moved);
    blur_residuals_[i] = blur.residual.x * blur_excess_ / std::sqrt(noise2_);
    take(kBlurOfCorner, blur);
  }
  centre_residuals_.assign(seen_->centres.size(), {});
  for (std::size_t i = 0; i < seen_->centres.size(); ++i) {
    const FittedPoint row = row_of_centre(i, camera, moved);
    centre_residuals_[i] = row.residual;
    take(used_.size() + i, row);
  }
}

/// Residuals and normal equations where all unknowns are now.
void GeometryFit::linearise() {
  square_ = Eigen::MatrixXd::Zero(unknowns(), unknowns());
  right_ = Eigen::VectorXd::Zero(unknowns());
  cost_ = 0;
  known_chi2_ = 0;
  each_row([&](std::size_t i, const FittedPoint& row) {
    add(row);
    if (i == kBlurOfCorner) known_chi2_ += dot(row.residual, row.residual) / noise2_;
  });
  add_all_known();
}

void GeometryFit::add(const FittedPoint& point) {
  const Eigen::Vector2d r(point.residual.x, point.residual.y);
  for (const FittedPoint::Block& a : point.blocks) {
    const auto left = point.rows.middleCols(a.column, a.count).transpose();
    right_.segment(a.unknown, a.count) += left * r;
    for (const FittedPoint::Block& b : point.blocks)
      square_.block(a.unknown, b.unknown, a.count, b.count) +=
          left * point.rows.middleCols(b.column, b.count);
  }
  cost_ += r.squaredNorm();
}

void GeometryFit::apply(const Eigen::VectorXd& change) {
  for (std::size_t k = 0; k < free_.size(); ++k)
    free_[k]->of(spec_) += units_[k] * change(static_cast<Eigen::Index>(k));
  const auto three = [&](Eigen::Index at) {
    return Vec3{change(at), change(at + 1), change(at + 2)};
  };
  for (std::size_t p = 0; p < poses_.size(); ++p) {
    const Eigen::Index at = first_of_pose(p);
    poses_[p].rotation = turned_by(poses_[p].rotation, three(at));
    poses_[p].translation = poses_[p].translation + three(at + 3);
  }
  if (microlens_ > 0) {
    blur_scale_ += change(blur_scale());
    blur_offset_ += change(blur_scale() + 1);
  }
  if (looseness_.outwards > 0)
    for (std::size_t t = 0; t < outwards_.size(); ++t)
      outwards_[t] += change(first_of_outwards() + static_cast<Eigen::Index>(t));
  if (looseness_.board > 0)
    for (std::size_t k = 0; k < points_.size(); ++k)
      points_[k] = points_[k] + three(first_of_points() + 3 * static_cast<Eigen::Index>(k));
}

}  // namespace plenoflame
