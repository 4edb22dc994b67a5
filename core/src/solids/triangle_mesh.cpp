#include "solids/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

double largest(Vec3 v) {
  return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}
double taxicab(Vec3 v) {
  return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

}  // namespace

TriangleMesh::TriangleMesh(MeshData data, const RigidTransform& to_world, double unit, Vec3 centre)
    : triangles_(std::move(data.triangles)), texture_(std::move(data.texture)) {
  vertices_.reserve(data.vertices.size());
  for (const Vec3& v : data.vertices) {
    const Vec3 p = to_world.point(unit * v) - centre;
    vertices_.push_back(
        {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  }
  double sum = 0;
  cumulative_area_.reserve(triangles_.size());
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    const auto c = corners(i);
    sum += 0.5 * length(cross(c[1] - c[0], c[2] - c[0]));
    cumulative_area_.push_back(sum);
  }
}

bool TriangleMesh::plane_crossing(std::uint32_t triangle, const Ray& ray, double& t) const {
  const auto c = corners(triangle);
  const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
  const double towards = dot(n, ray.direction);
  if (towards == 0) return false;
  const double distance = dot(n, c[0] - ray.origin);
  // The origin lies on its own surface up to a few roundings of its coordinates, and this
  // expression adds a few more. They are at most 8 units of 2^-53 of the largest term (Higham,
  // Accuracy and Stability of Numerical Algorithms, 2nd ed., section 3.1).
  const double bound = 8 * 0x1p-53 * taxicab(n) * (largest(c[0]) + largest(ray.origin));
  if (std::fabs(distance) <= bound) return false;
  t = distance / towards;
  return true;
}

Vec3 TriangleMesh::normal(std::uint32_t triangle) const {
  const auto c = corners(triangle);
  return normalize(cross(c[1] - c[0], c[2] - c[0]));
}

Vec2 TriangleMesh::texture_at(std::uint32_t triangle, Vec3 point) const {
  if (texture_.empty()) return {};
  const auto c = corners(triangle);
  const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
  const double all = dot(n, n);
  const double u = dot(n, cross(c[2] - c[1], point - c[1])) / all;
  const double v = dot(n, cross(c[0] - c[2], point - c[2])) / all;
  const Triangle& t = triangles_[triangle];
  return u * texture_[t[0]] + v * texture_[t[1]] + (1 - u - v) * texture_[t[2]];
}

Vec3 TriangleMesh::draw(double choice, double u, double v, std::uint32_t& triangle) const {
  const auto at =
      std::upper_bound(cumulative_area_.begin(), cumulative_area_.end(), choice * area());
  triangle = static_cast<std::uint32_t>(std::min<std::ptrdiff_t>(
      at - cumulative_area_.begin(), static_cast<std::ptrdiff_t>(triangles_.size()) - 1));
  const auto c = corners(triangle);
  const double s = std::sqrt(u);
  return (1 - s) * c[0] + s * (1 - v) * c[1] + s * v * c[2];
}

double TriangleMesh::winding_number(Vec3 point) const {
  double sum = 0;
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    // Solid angle of a triangle: van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125.
    auto r = corners(i);
    for (Vec3& v : r) v = v - point;
    const double l0 = length(r[0]), l1 = length(r[1]), l2 = length(r[2]);
    sum += 2 * std::atan2(dot(r[0], cross(r[1], r[2])), l0 * l1 * l2 + dot(r[0], r[1]) * l2 +
                                                            dot(r[0], r[2]) * l1 +
                                                            dot(r[1], r[2]) * l0);
  }
  return sum / (4 * constants::pi);
}

Box TriangleMesh::bounds() const {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Box box{{inf, inf, inf}, {-inf, -inf, -inf}};
  for (const Triangle& t : triangles_)
    for (const std::uint32_t index : t) {
      const Vec3 v = vertex(index);
      box.lower = {std::min(box.lower.x, v.x), std::min(box.lower.y, v.y),
                   std::min(box.lower.z, v.z)};
      box.upper = {std::max(box.upper.x, v.x), std::max(box.upper.y, v.y),
                   std::max(box.upper.z, v.z)};
    }
  return box;
}

}  // namespace plenoflame
