#include "plenoflame/inverse/axis_fit.h"

#include <Eigen/Dense>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr double kLit = 5;  ///< deviations above which a pixel counts
constexpr int kSteps = 20;
/// Directions below this share of the largest curvature are held, because the pictures do not
/// determine them. One camera measures its own depth only by the divergence of its rays: the square
/// of its field of view. Flames that are not round add to this curvature.
constexpr double kHeld = 1e-2;
constexpr double kSettled = 1e-9;

struct LitRay {
  Vec3 origin, direction;
  double weight;
};

std::vector<LitRay> lit_rays(const CameraRays& rays, const MeasuredRows& measured) {
  std::vector<LitRay> lit;
  for (std::size_t i = 0; i < rays.rows.size(); ++i) {
    if (!(measured.deviation[i] > 0) || !(measured.flux[i] > kLit * measured.deviation[i]))
      continue;
    Vec3 origin, direction;
    double sum = 0;
    for (std::size_t r = rays.rows[i].begin; r < rays.end_of(i); ++r) {
      origin = origin + rays.rays[r].weight * rays.rays[r].origin;
      direction = direction + rays.rays[r].weight * rays.rays[r].direction;
      sum += rays.rays[r].weight;
    }
    if (sum > 0) lit.push_back({(1 / sum) * origin, normalize(direction), measured.flux[i]});
  }
  return lit;
}

}  // namespace

FlameAxis fit_axis(const CameraRays& rays, const MeasuredRows& measured, const FlameAxis& start) {
  const std::vector<LitRay> lit = lit_rays(rays, measured);
  if (lit.empty()) throw InputError("no pixel is bright enough to tell where the axis is");
  FlameAxis axis = start;
  axis.direction = normalize(start.direction);
  const Vec3 w = axis.direction;
  const Vec3 aside = std::fabs(w.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalize(aside - dot(aside, w) * w), v = cross(w, u);
  // A rotation about the base by the light's height moves as much as a shift.
  double reach = 0, weights = 0;
  for (const LitRay& ray : lit) {
    const double along = dot(ray.origin - start.base, ray.direction);
    const double height = dot(ray.origin - along * ray.direction - start.base, w);
    reach += ray.weight * height * height;
    weights += ray.weight;
  }
  reach = std::sqrt(reach / weights);
  if (!(reach > 0)) reach = 1e-3;
  const auto moved = [&](const Eigen::Vector4d& p) {
    FlameAxis result = start;
    result.base = start.base + p[0] * u + p[1] * v;
    result.direction = normalize(w + (p[2] / reach) * u + (p[3] / reach) * v);
    return result;
  };
  const auto distance = [](const FlameAxis& a, const LitRay& ray) {
    const Vec3 normal = cross(ray.direction, a.direction);
    const double size = length(normal);
    return size > 0 ? dot(a.base - ray.origin, normal) / size : 0;
  };
  Eigen::Vector4d p = Eigen::Vector4d::Zero();
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    const double h = 1e-5 * reach;
    for (const LitRay& ray : lit) {
      Eigen::Vector4d slope;
      for (int k = 0; k < 4; ++k) {
        Eigen::Vector4d up = p, down = p;
        up[k] += h;
        down[k] -= h;
        slope[k] = (distance(moved(up), ray) - distance(moved(down), ray)) / (2 * h);
      }
      normal += ray.weight * slope * slope.transpose();
      right -= ray.weight * distance(moved(p), ray) * slope;
    }
    // Directions that the pictures do not determine stay unchanged.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> parts(normal);
    Eigen::Vector4d change = Eigen::Vector4d::Zero();
    for (int k = 0; k < 4; ++k) {
      if (!(parts.eigenvalues()[k] > kHeld * parts.eigenvalues()[3])) continue;
      const Eigen::Vector4d direction = parts.eigenvectors().col(k);
      change += direction * (direction.dot(right) / parts.eigenvalues()[k]);
    }
    p += change;
    if (change.norm() < kSettled * reach) break;
  }
  axis = moved(p);
  double squares = 0;
  for (const LitRay& ray : lit) squares += ray.weight * std::pow(distance(axis, ray), 2);
  axis.spread = std::sqrt(squares / weights);
  return axis;
}

}  // namespace plenoflame
