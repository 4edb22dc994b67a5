// Observations beside the places of corners and centres: blur, radii, and nominal values.
#include <algorithm>
#include <cmath>

#include "calibration/geometry_fit.h"

namespace plenoflame {
namespace {

constexpr double kMeanOutwards = 1e-4;  ///< by which the sum over types may differ from 0
constexpr double kBlurOutlier = 6;      ///< standard deviations
constexpr int kWeightRounds = 2;

}  // namespace

bool GeometryFit::has_blur(std::size_t i) const {
  return microlens_ > 0 && used_[i] && blur_used_[i] && seen_->corners[i].blur_error > 0;
}

/// Blur of a point of the scene by the lens equation alone [pixel].
double GeometryFit::predicted_blur(const CameraSpec& spec, std::size_t i) const {
  const double image = 1 / (1 / spec.lens.focal_length - 1 / in_camera(i).z);
  const double b = spec.array.sensor_distance;
  return lens_radius_ * (1 - b / spec.array.types[type_of_[i]].focal_length +
                         b / (spec.focus.lens_distance - image));
}

FittedPoint GeometryFit::row_of_blur(std::size_t i, const std::vector<Camera>& moved) const {
  const Eigen::Index n = values();
  FittedPoint point;
  point.rows.setZero(2, n + 11);
  point.pose = pose_of_[i];
  point.lens = lenses_[i];
  point.type = type_of_[i];
  const double observed = seen_->corners[i].blur, error = seen_->corners[i].blur_error,
               weight = std::sqrt(noise2_) / (blur_excess_ * error), scale = 1 + blur_scale_,
               blur = predicted_blur(spec_, i);
  point.residual = {weight * (scale * blur + blur_offset_ - observed), 0};
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto at = static_cast<std::size_t>(k);
    point.rows(0, k) =
        weight * scale / free_[at]->step * (predicted_blur(moved[at].spec(), i) - blur);
  }
  const double z = in_camera(i).z, image = 1 / (1 / spec_.lens.focal_length - 1 / z),
               from_image = spec_.focus.lens_distance - image;
  // The image comes nearer to the lens as the point moves away.
  const double by_z = -weight * scale * lens_radius_ * spec_.array.sensor_distance *
                      std::pow(image / (z * from_image), 2);
  const Mat3& rotation = poses_[point.pose].rotation;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Vec3 e{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
    point.rows(0, n + k) = by_z * (rotation * cross(e, on_board(i))).z;
    point.rows(0, n + 3 + k) = by_z * e.z;
    point.rows(0, n + 6 + k) = by_z * (rotation * e).z;
  }
  point.rows(0, n + 9) = weight * blur;
  point.rows(0, n + 10) = weight;
  point.blocks = {{0, 0, n}, {n, first_of_pose(point.pose), 6}, {n + 9, blur_scale(), 2}};
  if (looseness_.board > 0)
    point.blocks.push_back(
        {n + 6, first_of_points() + 3 * static_cast<Eigen::Index>(point_of_[i]), 3});
  return point;
}

/// Adds an observation of the camera. @param residual over its deviation @param value (camera) ->
/// it
template <class Function>
void GeometryFit::add_known(double residual, double deviation, const Function& value) {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(unknowns());
  const double here = value(spec_);
  for (std::size_t k = 0; k < free_.size(); ++k) {
    CameraSpec moved = spec_;
    free_[k]->of(moved) += free_[k]->step * units_[k];
    row(static_cast<Eigen::Index>(k)) = (value(moved) - here) / (free_[k]->step * deviation);
  }
  row *= std::sqrt(noise2_);
  square_ += row * row.transpose();
  right_ += std::sqrt(noise2_) * residual * row;
  cost_ += noise2_ * residual * residual;
  known_chi2_ += residual * residual;
  known_rows_.push_back(row);
}

/// Adds what is known of the loose values, of the radii and of the microlenses.
void GeometryFit::add_all_known() {
  known_rows_.clear();
  for (const LooseValue& loose : loose_values()) {
    square_(loose.unknown, loose.unknown) += loose.weight;
    right_(loose.unknown) += loose.weight * loose.value;
    cost_ += loose.weight * loose.value * loose.value;
  }
  if (seen_->radii) {
    const double slope = seen_->radii->slope, error = seen_->radii->relative_error;
    radii_residual_ = (slope_of_radii(spec_) / slope - 1) / error;
    add_known(radii_residual_, error * slope, slope_of_radii);
  }
  if (microlens_ > 0) {
    const auto change = [&](const CameraSpec& spec) {
      double sum = 0;
      for (const std::size_t t : blur_types_)
        sum += std::log(spec.array.types[t].focal_length / nominal_focal_lengths_[t]);
      return sum / static_cast<double>(blur_types_.size());
    };
    add_known(change(spec_) / microlens_, microlens_, change);
  }
  if (looseness_.outwards == 0 || seen_->radii || microlens_ > 0) return;
  // A common displacement outwards is equivalent to a longer sensor distance.
  const auto count = static_cast<Eigen::Index>(outwards_.size());
  const double weight = noise2_ / (kMeanOutwards * kMeanOutwards);
  const Eigen::Index at = first_of_outwards();
  double sum = 0;
  for (const double outwards : outwards_) sum += outwards;
  square_.block(at, at, count, count).array() += weight;
  right_.segment(at, count).array() += weight * sum;
  cost_ += weight * sum * sum;
}

int GeometryFit::use_blur(double microlens, const Execution& execution) {
  // The types' focal lengths by the mean blur of their corners.
  std::vector<double> sum(types()), weights(types());
  const double b = spec_.array.sensor_distance;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    const CornerObservation& corner = seen_->corners[i];
    if (!used_[i] || !(corner.blur_error > 0)) continue;
    const std::size_t t = type_of_[i];
    const double weight = 1 / (corner.blur_error * corner.blur_error);
    sum[t] += weight * ((predicted_blur(spec_, i) - corner.blur) / lens_radius_ +
                        b / spec_.array.types[t].focal_length);
    weights[t] += weight;
  }
  for (std::size_t t = 0; t < types(); ++t) {
    const double found = b * weights[t] / sum[t];
    if (!(found > 0 && std::isfinite(found))) {
      for (std::size_t i = 0; i < used_.size(); ++i)
        if (type_of_[i] == t) blur_used_[i] = false;
      continue;
    }
    microlens_change_ += std::log(found / nominal_focal_lengths_[t]);
    spec_.array.types[t].focal_length = found;
    free_.push_back(microlens_value(t));
    blur_types_.push_back(t);
  }
  if (blur_types_.empty()) return 0;
  microlens_change_ /= static_cast<double>(blur_types_.size());
  microlens_ = microlens;
  int steps = solve_weighted(execution);
  for (std::size_t i = 0; i < used_.size(); ++i)
    blur_used_[i] = blur_used_[i] && std::fabs(blur_residuals_[i]) < kBlurOutlier * blur_excess_;
  return steps + solve_weighted(execution);
}

int GeometryFit::solve_weighted(const Execution& execution) {
  int steps = 0;
  const auto weigh = [&] {
    update_noise();
    blur_excess_ = std::max(1.0, blur_rms());
  };
  for (int round = 0; round < kWeightRounds; ++round) {
    weigh();
    steps += solve(free_, execution);
  }
  weigh();
  linearise();
  return steps;
}

}  // namespace plenoflame
