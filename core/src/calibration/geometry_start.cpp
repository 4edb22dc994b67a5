#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "calibration/geometry_fit.h"
#include "calibration/seen_lines.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// A pose that is turned over leaves less than this part of the squares, or stays as it was.
constexpr double kTurnedOver = 0.95;

}  // namespace

void GeometryFit::start_poses() {
  const Camera camera = open_camera(spec_);
  for (const auto& [pose, index] : pose_index_) {
    const auto count = std::count(pose_of_.begin(), pose_of_.end(), index);
    if (count < 8)
      throw InputError("pose " + std::to_string(pose) + " has " + std::to_string(count) +
                       " corners; at least 8 are needed");
    check_size(camera, pose, index);
    poses_[index] = homography_pose(camera, index);
  }
}

Vec2 GeometryFit::direction_of(const Camera& camera, std::size_t i) const {
  const double focus = plane_in_focus(camera);
  return (1 / focus) *
         (seen_line(camera, lenses_[i], found_at(camera, i)).at(focus) - spec_.lens.decentre);
}

void GeometryFit::check_size(const Camera& camera, int pose, std::size_t index) const {
  Vec2 board, seen;
  double board2 = 0, seen2 = 0, count = 0;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (pose_of_[i] != index) continue;
    const Vec2 b = seen_->corners[i].board, t = direction_of(camera, i);
    board = board + b, seen = seen + t;
    board2 += dot(b, b), seen2 += dot(t, t), count += 1;
  }
  const double spread = board2 - dot(board, board) / count;
  if (spread <= 1e-9 * board2) return;  // one point
  const double z = std::sqrt(spread / (seen2 - dot(seen, seen) / count));
  const double focus = plane_in_focus(camera), f = camera.ideal().focal_length;
  if (z > 0.1 * f && z < 100 * focus) return;
  throw InputError(fmt::format(
      "pose {}: by its size the board would be {:.2g} m from the lens, whose focal length is "
      "{:.3g} m and whose plane in focus is at {:.3g} m; x and y of the corners are in metres",
      pose, z, f, focus));
}

RigidTransform GeometryFit::homography_pose(const Camera& camera, std::size_t pose) const {
  double size = 0, count = 0;
  for (std::size_t i = 0; i < used_.size(); ++i)
    if (pose_of_[i] == pose) size += length(seen_->corners[i].board), ++count;
  size /= count;
  Eigen::Matrix<double, 9, 9> square = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (pose_of_[i] != pose) continue;
    const Vec2 board = seen_->corners[i].board, t = direction_of(camera, i);
    const Eigen::Vector3d b(board.x / size, board.y / size, 1);
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
  RigidTransform place;
  for (int k = 0; k < 3; ++k)
    place.rotation.rows[static_cast<std::size_t>(k)] = {r(k, 0), r(k, 1), r(k, 2)};
  place.translation = {t.x() + spec_.lens.decentre.x, t.y() + spec_.lens.decentre.y, t.z()};
  return place;
}

bool GeometryFit::turn_poses_over(const Execution& execution) {
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

/// Sum of squares of each pose's corners.
std::vector<double> GeometryFit::pose_costs() const {
  std::vector<double> costs(poses_.size());
  for (std::size_t i = 0; i < used_.size(); ++i)
    if (used_[i]) costs[pose_of_[i]] += dot(residuals_[i], residuals_[i]);
  return costs;
}

}  // namespace plenoflame
