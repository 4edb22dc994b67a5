#include "solids/polygon.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace plenoflame {
namespace {

/// Twice the signed area of a triangle.
double turn(Vec2 a, Vec2 b, Vec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon seen along its normal (Newell's: twice its area as a vector), so that it runs
/// counterclockwise.
std::vector<Vec2> flattened(const std::vector<Vec3>& corners) {
  Vec3 normal;
  for (std::size_t i = 0; i < corners.size(); ++i)
    normal =
        normal + cross(corners[i] - corners[0], corners[(i + 1) % corners.size()] - corners[0]);
  const double x = std::fabs(normal.x), y = std::fabs(normal.y), z = std::fabs(normal.z);
  std::vector<Vec2> flat;
  flat.reserve(corners.size());
  for (const Vec3& v : corners) {
    const Vec3 c = v - corners[0];
    // Along the axis that the normal is nearest to.
    Vec2 p = z >= x && z >= y ? Vec2{c.x, c.y} : y >= x ? Vec2{c.z, c.x} : Vec2{c.y, c.z};
    const double towards = z >= x && z >= y ? normal.z : y >= x ? normal.y : normal.x;
    if (towards < 0) std::swap(p.x, p.y);
    flat.push_back(p);
  }
  return flat;
}

/// Tells whether a corner can be cut off: it turns left, and no other corner lies within its
/// triangle.
bool is_ear(const std::vector<Vec2>& flat, const std::vector<std::uint32_t>& left, std::size_t i) {
  const std::size_t n = left.size();
  const Vec2 a = flat[left[(i + n - 1) % n]], b = flat[left[i]], c = flat[left[(i + 1) % n]];
  if (!(turn(a, b, c) > 0)) return false;
  for (std::size_t k = 2; k + 1 < n; ++k) {
    const Vec2 p = flat[left[(i + k) % n]];
    if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
  }
  return true;
}

}  // namespace

void cut_polygon(const std::vector<Vec3>& corners,
                 std::vector<std::array<std::uint32_t, 3>>& triangles) {
  triangles.clear();
  const auto count = static_cast<std::uint32_t>(corners.size());
  const auto fan = [&] {
    for (std::uint32_t k = 1; k + 1 < count; ++k) triangles.push_back({0, k, k + 1});
  };
  if (count == 3) return fan();
  const std::vector<Vec2> flat = flattened(corners);
  bool convex = true;
  for (std::size_t i = 0; i < flat.size(); ++i)
    convex = convex && turn(flat[i], flat[(i + 1) % count], flat[(i + 2) % count]) >= 0;
  if (convex) return fan();
  std::vector<std::uint32_t> left(count);
  for (std::uint32_t k = 0; k < count; ++k) left[k] = k;
  // Looking for the next ear from where the last one was: mostly near.
  for (std::size_t at = 0, looked = 0; left.size() > 3;) {
    const std::size_t n = left.size();
    at %= n;
    if (is_ear(flat, left, at)) {
      triangles.push_back({left[(at + n - 1) % n], left[at], left[(at + 1) % n]});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
      looked = 0;
      continue;
    }
    if (++looked == n) break;  // the polygon crosses itself
    ++at;
  }
  for (std::size_t k = 1; k + 1 < left.size(); ++k)
    triangles.push_back({left[0], left[k], left[k + 1]});
}

}  // namespace plenoflame
