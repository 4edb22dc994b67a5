#pragma once
#include <array>
#include <cmath>

namespace plenoflame {

struct Vec2 {
  double x = 0, y = 0;
  friend bool operator==(const Vec2&, const Vec2&) = default;
};

struct Vec3 {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

constexpr Vec2 operator+(Vec2 a, Vec2 b) {
  return {a.x + b.x, a.y + b.y};
}
constexpr Vec2 operator-(Vec2 a, Vec2 b) {
  return {a.x - b.x, a.y - b.y};
}
constexpr Vec2 operator*(double s, Vec2 a) {
  return {s * a.x, s * a.y};
}
constexpr double dot(Vec2 a, Vec2 b) {
  return a.x * b.x + a.y * b.y;
}
inline double length(Vec2 a) {
  return std::hypot(a.x, a.y);
}

constexpr Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr Vec3 operator-(Vec3 a) {
  return {-a.x, -a.y, -a.z};
}
constexpr Vec3 operator*(double s, Vec3 a) {
  return {s * a.x, s * a.y, s * a.z};
}
constexpr double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3 a) {
  return std::hypot(a.x, a.y, a.z);
}
inline Vec3 normalize(Vec3 a) {
  return (1.0 / length(a)) * a;
}

/// 3 x 3 matrix, row major.
struct Mat3 {
  std::array<Vec3, 3> rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  friend bool operator==(const Mat3&, const Mat3&) = default;
};

constexpr Vec3 operator*(const Mat3& m, Vec3 v) {
  return {dot(m.rows[0], v), dot(m.rows[1], v), dot(m.rows[2], v)};
}
constexpr Mat3 transpose(const Mat3& m) {
  const auto& r = m.rows;
  return {{{{r[0].x, r[1].x, r[2].x}, {r[0].y, r[1].y, r[2].y}, {r[0].z, r[1].z, r[2].z}}}};
}
constexpr Mat3 operator*(const Mat3& a, const Mat3& b) {
  const Mat3 t = transpose(b);
  Mat3 m;
  for (int i = 0; i < 3; ++i)
    m.rows[i] = {dot(a.rows[i], t.rows[0]), dot(a.rows[i], t.rows[1]), dot(a.rows[i], t.rows[2])};
  return m;
}

/// Rotation about x, then y, then z of the fixed (outer) axes, right-handed [rad].
Mat3 rotation_xyz(Vec3 angles);

/// Rotation and translation: outer = rotation * inner + translation.
struct RigidTransform {
  Mat3 rotation;
  Vec3 translation;
  constexpr Vec3 point(Vec3 p) const { return rotation * p + translation; }
  constexpr Vec3 direction(Vec3 d) const { return rotation * d; }
  constexpr RigidTransform inverse() const {
    const Mat3 t = transpose(rotation);
    return {t, -(t * translation)};
  }
  friend bool operator==(const RigidTransform&, const RigidTransform&) = default;
};

/// Half-open half line: points origin + t * direction; direction has length 1.
struct Ray {
  Vec3 origin;
  Vec3 direction;
  constexpr Vec3 at(double t) const { return origin + t * direction; }
};

/// Axis-aligned box; empty when any lower bound exceeds the upper one.
struct Box {
  Vec3 lower{1, 1, 1};
  Vec3 upper{-1, -1, -1};
  constexpr bool empty() const {
    return lower.x > upper.x || lower.y > upper.y || lower.z > upper.z;
  }
  friend bool operator==(const Box&, const Box&) = default;
};

}  // namespace plenoflame
