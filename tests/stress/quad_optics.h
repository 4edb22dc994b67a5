#pragma once
#include <cmath>
#include <limits>

#include "plenoflame/optics/ray_status.h"

/// Exact rays in 113-bit arithmetic, by the textbook: the quadratic equation of ray and sphere,
/// then Snell's law with the tangential part split off. Shares no formula with the library.
namespace plenoflame::test {

__extension__ typedef __float128 Quad;

/// Newton's iteration from the long double root: 64 correct bits become 113.
inline Quad quad_sqrt(Quad v) {
  if (!(v > 0)) return 0;
  Quad root = std::sqrt(static_cast<long double>(v));
  for (int i = 0; i < 2; ++i) root = (root + v / root) / 2;
  return root;
}

struct QuadVec {
  Quad x = 0, y = 0, z = 0;
  QuadVec() = default;
  QuadVec(Quad a, Quad b, Quad c) : x(a), y(b), z(c) {}
  QuadVec(Vec3 v) : x(v.x), y(v.y), z(v.z) {}  // NOLINT(google-explicit-constructor)
};
inline QuadVec operator+(QuadVec a, QuadVec b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline QuadVec operator-(QuadVec a, QuadVec b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline QuadVec operator*(Quad s, QuadVec a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline Quad dot(QuadVec a, QuadVec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline QuadVec unit(QuadVec a) {
  return (1 / quad_sqrt(dot(a, a))) * a;
}
inline double distance(QuadVec a, QuadVec b) {
  return static_cast<double>(quad_sqrt(dot(a - b, a - b)));
}

struct QuadRay {
  QuadVec origin, direction;  ///< direction of length 1
};

/// A ray's refraction at one surface.
struct QuadRefraction {
  RayStatus status = RayStatus::reached;
  Quad cos2_out = 1;  ///< of refraction; negative: total reflection
  Quad cos_in = 1;
  Quad height2 = 0;  ///< of the point, from the axis
};

/// Refracts at a surface with its vertex at z = `vertex` on the axis; radius > 0: the centre lies
/// at lower z. The ray ends up on the surface. @param before, behind indices along the ray's way
inline QuadRefraction quad_refract(QuadRay& ray, Quad vertex, double radius, double before,
                                   double behind) {
  QuadRefraction result;
  QuadVec normal{0, 0, 1};
  if (std::isinf(radius)) {
    ray.origin = ray.origin + ((vertex - ray.origin.z) / ray.direction.z) * ray.direction;
  } else {
    const QuadVec centre{0, 0, vertex - static_cast<Quad>(radius)};
    const QuadVec o = ray.origin - centre;
    const Quad b = dot(o, ray.direction);
    const Quad c = dot(o, o) - static_cast<Quad>(radius) * static_cast<Quad>(radius);
    const Quad discriminant = b * b - c;
    if (!(discriminant > 0)) {
      result.status = RayStatus::missed;
      return result;
    }
    const Quad root = quad_sqrt(discriminant);
    const QuadVec near = ray.origin + (-b - root) * ray.direction;
    const QuadVec far = ray.origin + (-b + root) * ray.direction;
    const Quad to_near = near.z > vertex ? near.z - vertex : vertex - near.z;
    const Quad to_far = far.z > vertex ? far.z - vertex : vertex - far.z;
    ray.origin = to_near < to_far ? near : far;
    normal = unit(ray.origin - centre);
  }
  if (dot(normal, ray.direction) < 0) normal = Quad(-1) * normal;
  result.height2 = ray.origin.x * ray.origin.x + ray.origin.y * ray.origin.y;
  result.cos_in = dot(normal, ray.direction);
  const Quad mu = static_cast<Quad>(before) / static_cast<Quad>(behind);
  const QuadVec across = mu * (ray.direction - result.cos_in * normal);
  result.cos2_out = 1 - dot(across, across);
  if (!(result.cos2_out > 0)) {
    result.status = RayStatus::total_internal_reflection;
    return result;
  }
  ray.direction = across + quad_sqrt(result.cos2_out) * normal;
  return result;
}

}  // namespace plenoflame::test
