#include "calibration/board_plane.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace plenoflame {
namespace {

constexpr int kDistanceBins = 240;

}  // namespace

BoardPlane BoardPlane::where_most_meet(const std::vector<Meeting>& meetings, double nearest,
                                       double farthest) {
  const double low = 1 / farthest, high = 1 / nearest;
  std::array<double, kDistanceBins> bins{};
  for (const Meeting& meeting : meetings) {
    const double at = (1 / meeting.z - low) / (high - low) * kDistanceBins;
    bins[static_cast<std::size_t>(std::clamp(at, 0.0, kDistanceBins - 1.0))] += 1;
  }
  constexpr int kSmooth = 3;
  double best = 0;
  int mode = 0;
  for (int k = kSmooth; k < kDistanceBins - kSmooth; ++k) {
    double sum = 0;
    for (int d = -kSmooth; d <= kSmooth; ++d) sum += bins[static_cast<std::size_t>(k + d)];
    if (sum > best) best = sum, mode = k;
  }
  BoardPlane plane{low + (mode + 0.5) * (high - low) / kDistanceBins, 0, 0};
  plane.fit(meetings, 0.25 * plane.near);
  return plane;
}

void BoardPlane::fit(const std::vector<Meeting>& meetings, double window) {
  for (int step = 0; step < 12; ++step) {
    Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    std::vector<double> off;
    for (const Meeting& meeting : meetings) {
      const Eigen::Vector3d row(1, meeting.direction.x, meeting.direction.y);
      const double rest = 1 / meeting.z - row.dot(Eigen::Vector3d(near, along, across));
      if (std::fabs(rest) > window) continue;
      off.push_back(std::fabs(rest));
      square += row * row.transpose();
      right += row * rest;
    }
    if (off.size() < kFewestPairs) return;
    const Eigen::Vector3d change = square.ldlt().solve(right);
    near += change(0);
    along += change(1);
    across += change(2);
    std::nth_element(off.begin(), off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2),
                     off.end());
    window = std::max(0.7 * window, std::min(window, 4 * off[off.size() / 2]));
  }
}

}  // namespace plenoflame
