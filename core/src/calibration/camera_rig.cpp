#include "plenoflame/calibration/camera_rig.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// Points of a board, in the frames of both cameras.
using PointPairs = std::vector<std::array<Eigen::Vector3d, 2>>;

Eigen::Vector3d eigen(Vec3 v) {
  return {v.x, v.y, v.z};
}

/// The rotation and translation that bring the second points closest to the first ones (Arun, Huang
/// and Blostein, IEEE PAMI 9 (1987) 698).
/// @param without a board that is left out; -1: none
RigidTransform closest(const std::vector<PointPairs>& boards, int without) {
  Eigen::Vector3d middle[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  double count = 0;
  const auto for_points = [&](const auto& use) {
    for (std::size_t b = 0; b < boards.size(); ++b)
      if (static_cast<int>(b) != without)
        for (const auto& pair : boards[b]) use(pair);
  };
  for_points([&](const auto& pair) {
    middle[0] += pair[0];
    middle[1] += pair[1];
    count += 1;
  });
  middle[0] /= count;
  middle[1] /= count;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for_points(
      [&](const auto& pair) { sum += (pair[1] - middle[1]) * (pair[0] - middle[0]).transpose(); });
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d v = svd.matrixV(), u = svd.matrixU();
  Eigen::Vector3d sign(1, 1, (v * u.transpose()).determinant() < 0 ? -1 : 1);
  const Eigen::Matrix3d r = v * sign.asDiagonal() * u.transpose();
  const Eigen::Vector3d t = middle[0] - r * middle[1];
  RigidTransform found;
  for (int k = 0; k < 3; ++k)
    found.rotation.rows[static_cast<std::size_t>(k)] = {r(k, 0), r(k, 1), r(k, 2)};
  found.translation = {t.x(), t.y(), t.z()};
  return found;
}

/// The angle of the rotation from one to the other.
double turn_between(const RigidTransform& a, const RigidTransform& b) {
  double squares = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 d = a.rotation.rows[k] - b.rotation.rows[k];
    squares += dot(d, d);
  }
  return 2 * std::asin(std::min(1.0, std::sqrt(squares / 8)));
}

}  // namespace

RelativePose register_cameras(const std::vector<RigidTransform>& first,
                              const std::vector<RigidTransform>& second, double size) {
  if (first.empty() || first.size() != second.size())
    throw InputError("cameras are registered by boards that both have seen, and there is none");
  std::vector<PointPairs> boards;
  for (std::size_t b = 0; b < first.size(); ++b) {
    PointPairs pairs;
    for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{size, 0, 0}, Vec3{0, size, 0}, Vec3{size, size, 0}})
      pairs.push_back({eigen(first[b].point(p)), eigen(second[b].point(p))});
    boards.push_back(pairs);
  }
  RelativePose found;
  found.to_first = closest(boards, -1);
  double squares = 0, count = 0;
  for (const PointPairs& board : boards) {
    double own = 0;
    for (const auto& pair : board) {
      const Vec3 moved = found.to_first.point({pair[1].x(), pair[1].y(), pair[1].z()});
      own += (eigen(moved) - pair[0]).squaredNorm();
    }
    found.apart.push_back(std::sqrt(own / static_cast<double>(board.size())));
    squares += own;
    count += static_cast<double>(board.size());
  }
  found.rms = std::sqrt(squares / count);
  // Leaving out one board after the other (jackknife; Efron and Stein, Ann. Stat. 9 (1981) 586).
  const auto n = static_cast<double>(boards.size());
  if (boards.size() < 2) return found;
  double places = 0, turns = 0;
  for (std::size_t b = 0; b < boards.size(); ++b) {
    const RigidTransform other = closest(boards, static_cast<int>(b));
    const Vec3 moved = other.translation - found.to_first.translation;
    places += dot(moved, moved);
    turns += std::pow(turn_between(other, found.to_first), 2);
  }
  found.place_error = std::sqrt((n - 1) / n * places);
  found.turn_error = std::sqrt((n - 1) / n * turns);
  return found;
}

}  // namespace plenoflame
