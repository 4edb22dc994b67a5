#include "solids/shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

constexpr int kSide = 0, kBase = 1, kTop = 2;  ///< of cylinders; cones have no top

/// Roots of a t^2 + 2 b t + c = 0 in ascending order. The formula without cancellation is used
/// (Press et al., Numerical Recipes (1992), section 5.6).
/// @param discriminant b^2 - a c, computed as accurately as the caller can
int solve(double a, double b, double c, double discriminant, double (&t)[2]) {
  if (!(discriminant >= 0)) return 0;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  int count = 0;
  if (a != 0) t[count++] = q / a;
  if (q != 0) t[count++] = c / q;
  if (count == 2 && t[0] > t[1]) std::swap(t[0], t[1]);
  return count;
}

/// The parameter where a line meets the plane at z.
int flat_root(double z, double o, double d, double (&t)[2]) {
  if (d == 0) return 0;
  t[0] = (z - o) / d;
  return 1;
}

Vec3 component(int axis, double value) {
  return {axis == 0 ? value : 0, axis == 1 ? value : 0, axis == 2 ? value : 0};
}
double component(Vec3 v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

}  // namespace

Shape::Shape(const SolidSurfaceSpec& spec)
    : shape_(spec.shape),
      caps_(spec.caps),
      radius_(spec.radius),
      height_(spec.height),
      to_world_{rotation_xyz(spec.rotation), spec.position},
      to_local_(to_world_.inverse()) {
  if (shape_ == SolidShape::box) half_ = {0.5 * spec.size.x, 0.5 * spec.size.y, spec.size.z};
  if (shape_ == SolidShape::plane) half_ = {0.5 * spec.extent.x, 0.5 * spec.extent.y, 0};
}

int Shape::parts() const {
  switch (shape_) {
    case SolidShape::cylinder:
      return caps_ ? 3 : 1;
    case SolidShape::cone:
      return caps_ ? 2 : 1;
    case SolidShape::box:
      return 6;
    default:
      return 1;
  }
}

void Shape::roots(int part, Vec3 o, Vec3 d, double (&t)[2], int& count) const {
  count = 0;
  switch (shape_) {
    case SolidShape::sphere: {
      // The discriminant from the point nearest to the centre: Haines et al., Ray Tracing Gems
      // (2019), chapter 7.
      const double b = dot(o, d);
      const Vec3 nearest = o - b * d;
      const double c = dot(o, o) - radius_ * radius_;
      count = solve(1, b, c, radius_ * radius_ - dot(nearest, nearest), t);
      return;
    }
    case SolidShape::cylinder: {
      if (part != kSide) {
        count = flat_root(part == kBase ? 0 : height_, o.z, d.z, t);
        return;
      }
      const double a = d.x * d.x + d.y * d.y;
      if (a == 0) return;
      const double b = o.x * d.x + o.y * d.y;
      const double c = o.x * o.x + o.y * o.y - radius_ * radius_;
      // b^2 - a c = a r^2 - (o x d)_z^2, without cancellation of b^2.
      const double moment = o.x * d.y - o.y * d.x;
      count = solve(a, b, c, a * radius_ * radius_ - moment * moment, t);
      return;
    }
    case SolidShape::cone: {
      if (part != kSide) {
        count = flat_root(0, o.z, d.z, t);
        return;
      }
      // x^2 + y^2 = k^2 (h - z)^2.
      const double k = radius_ / height_, k2 = k * k, w = height_ - o.z;
      const double a = d.x * d.x + d.y * d.y - k2 * d.z * d.z;
      const double b = o.x * d.x + o.y * d.y + k2 * w * d.z;
      const double c = o.x * o.x + o.y * o.y - k2 * w * w;
      const double moment = o.x * d.y - o.y * d.x;
      const double u = o.x * d.z + w * d.x, v = o.y * d.z + w * d.y;
      count = solve(a, b, c, k2 * (u * u + v * v) - moment * moment, t);
      return;
    }
    case SolidShape::box: {
      const int axis = part / 2;
      const double low = axis == 2 ? 0 : -component(half_, axis);
      count = flat_root(part % 2 == 0 ? low : component(half_, axis), component(o, axis),
                        component(d, axis), t);
      return;
    }
    case SolidShape::disc:
    case SolidShape::plane:
      count = flat_root(0, o.z, d.z, t);
      return;
    case SolidShape::mesh:
      return;
  }
}

/// Tells whether a point of a part's plane, cylinder or cone belongs to the part.
bool Shape::bounded(int part, Vec3 p) const {
  switch (shape_) {
    case SolidShape::cylinder:
      return part == kSide ? p.z >= 0 && p.z <= height_
                           : p.x * p.x + p.y * p.y <= radius_ * radius_;
    case SolidShape::cone:
      return part == kSide ? p.z >= 0 && p.z <= height_
                           : p.x * p.x + p.y * p.y <= radius_ * radius_;
    case SolidShape::disc:
      return p.x * p.x + p.y * p.y <= radius_ * radius_;
    case SolidShape::plane:
      return std::fabs(p.x) <= half_.x && std::fabs(p.y) <= half_.y;
    case SolidShape::box: {
      const int axis = part / 2;
      return (axis == 0 || std::fabs(p.x) <= half_.x) && (axis == 1 || std::fabs(p.y) <= half_.y) &&
             (axis == 2 || (p.z >= 0 && p.z <= half_.z));
    }
    default:
      return true;
  }
}

int Shape::intersect(const Ray& ray, double t_near, double t_far, int from, double& t) const {
  const Vec3 o = to_local_.point(ray.origin), d = to_local_.direction(ray.direction);
  const bool curved =
      shape_ == SolidShape::sphere || shape_ == SolidShape::cylinder || shape_ == SolidShape::cone;
  int found = kNoPart;
  for (int part = 0; part < parts(); ++part) {
    double root[2];
    int count = 0;
    roots(part, o, d, root, count);
    int skip = -1;
    if (part == from && count > 0) {
      if (!curved || part != kSide) continue;
      skip = count == 2 && std::fabs(root[1]) < std::fabs(root[0]) ? 1 : 0;
    }
    for (int i = 0; i < count; ++i) {
      if (i == skip || !(root[i] > t_near && root[i] < t_far)) continue;
      if (!bounded(part, o + root[i] * d)) continue;
      found = part;
      t_far = t = root[i];
    }
  }
  return found;
}

Vec3 Shape::normal(int part, Vec3 world) const {
  const Vec3 p = to_local_.point(world);
  Vec3 n{0, 0, 1};
  switch (shape_) {
    case SolidShape::sphere:
      n = p;
      break;
    case SolidShape::cylinder:
      n = part == kSide ? Vec3{p.x, p.y, 0} : Vec3{0, 0, part == kBase ? -1.0 : 1.0};
      break;
    case SolidShape::cone:
      n = part == kSide ? Vec3{height_ * p.x, height_ * p.y, radius_ * std::hypot(p.x, p.y)}
                        : Vec3{0, 0, -1};
      if (part == kSide && p.x == 0 && p.y == 0) n = {0, 0, 1};  // the tip
      break;
    case SolidShape::box:
      n = component(part / 2, part % 2 == 0 ? -1 : 1);
      break;
    default:
      break;
  }
  return normalize(to_world_.direction(n));
}

Vec2 Shape::coordinates(int part, Vec3 world) const {
  const Vec3 p = to_local_.point(world);
  switch (shape_) {
    case SolidShape::sphere:
      return {radius_ * std::atan2(p.y, p.x), radius_ * std::atan2(p.z, std::hypot(p.x, p.y))};
    case SolidShape::cylinder:
    case SolidShape::cone:
      if (part == kSide) return {radius_ * std::atan2(p.y, p.x), p.z - 0.5 * height_};
      return {p.x, p.y};
    case SolidShape::box:
      if (part / 2 == 0) return {p.y, p.z - 0.5 * half_.z};
      if (part / 2 == 1) return {p.x, p.z - 0.5 * half_.z};
      return {p.x, p.y};
    default:
      return {p.x, p.y};
  }
}

bool Shape::endless() const {
  return shape_ == SolidShape::plane && (std::isinf(half_.x) || std::isinf(half_.y));
}

Box Shape::bounds() const {
  Vec3 low, high;  // own frame
  switch (shape_) {
    case SolidShape::sphere:
      low = {-radius_, -radius_, -radius_};
      high = -low;
      break;
    case SolidShape::cylinder:
    case SolidShape::cone:
    case SolidShape::disc:
      low = {-radius_, -radius_, 0};
      high = {radius_, radius_, shape_ == SolidShape::disc ? 0 : height_};
      break;
    default:
      low = {-half_.x, -half_.y, 0};
      high = half_;
      break;
  }
  if (endless()) return {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
  const Vec3 centre = to_world_.point(0.5 * (low + high)), half = 0.5 * (high - low);
  const auto reach = [&](Vec3 row) {
    return std::fabs(row.x) * half.x + std::fabs(row.y) * half.y + std::fabs(row.z) * half.z;
  };
  const auto& rows = to_world_.rotation.rows;
  const Vec3 extent =
      shape_ == SolidShape::sphere ? half : Vec3{reach(rows[0]), reach(rows[1]), reach(rows[2])};
  return {centre - extent, centre + extent};
}

double Shape::feature_size() const {
  switch (shape_) {
    case SolidShape::sphere:
    case SolidShape::disc:
      return radius_;
    case SolidShape::cylinder:
    case SolidShape::cone:
      return std::min(radius_, height_);
    case SolidShape::box:
      return std::min({half_.x, half_.y, half_.z});
    default:
      return std::min(half_.x, half_.y);
  }
}

bool Shape::contains(Vec3 world) const {
  const Vec3 p = to_local_.point(world);
  const double across = std::hypot(p.x, p.y);
  switch (shape_) {
    case SolidShape::sphere:
      return length(p) < radius_;
    case SolidShape::cylinder:
      return caps_ && across < radius_ && p.z > 0 && p.z < height_;
    case SolidShape::cone:
      return caps_ && p.z > 0 && across * height_ < radius_ * (height_ - p.z);
    case SolidShape::box:
      return std::fabs(p.x) < half_.x && std::fabs(p.y) < half_.y && p.z > 0 && p.z < half_.z;
    default:
      return false;
  }
}

double Shape::part_area(int part) const {
  const double disc = constants::pi * radius_ * radius_;
  switch (shape_) {
    case SolidShape::sphere:
      return 4 * disc;
    case SolidShape::cylinder:
      return part == kSide ? 2 * constants::pi * radius_ * height_ : disc;
    case SolidShape::cone:
      return part == kSide ? constants::pi * radius_ * std::hypot(radius_, height_) : disc;
    case SolidShape::disc:
      return disc;
    case SolidShape::plane:
      return 4 * half_.x * half_.y;
    case SolidShape::box: {
      const Vec3 side{2 * half_.x, 2 * half_.y, half_.z};
      return part / 2 == 0 ? side.y * side.z : part / 2 == 1 ? side.x * side.z : side.x * side.y;
    }
    case SolidShape::mesh:
      break;
  }
  return 0;
}

double Shape::area() const {
  double sum = 0;
  for (int part = 0; part < parts(); ++part) sum += part_area(part);
  return sum;
}

Vec3 Shape::draw(double choice, double u, double v, int& part) const {
  double left = choice * area();
  part = 0;
  while (part + 1 < parts() && left >= part_area(part)) left -= part_area(part++);
  const double azimuth = 2 * constants::pi * v, x = std::cos(azimuth), y = std::sin(azimuth);
  Vec3 p;
  switch (shape_) {
    case SolidShape::sphere: {
      const double z = 2 * u - 1, across = 2 * std::sqrt(u * (1 - u));
      p = radius_ * Vec3{across * x, across * y, z};
      break;
    }
    case SolidShape::cylinder:
    case SolidShape::cone:
    case SolidShape::disc: {
      const double r = radius_ * std::sqrt(u);
      if (shape_ == SolidShape::disc || part != kSide)
        p = {r * x, r * y, part == kTop ? height_ : 0};
      else if (shape_ == SolidShape::cylinder)
        p = {radius_ * x, radius_ * y, u * height_};
      else
        p = {r * x, r * y, height_ * (1 - std::sqrt(u))};
      break;
    }
    case SolidShape::plane:
      p = {(2 * u - 1) * half_.x, (2 * v - 1) * half_.y, 0};
      break;
    case SolidShape::box: {
      const Vec3 low{-half_.x, -half_.y, 0};
      const Vec3 q{(2 * (part / 2 == 0 ? 0 : u) - 1) * half_.x,
                   (2 * (part / 2 == 0 ? u : v) - 1) * half_.y, v * half_.z};
      const int axis = part / 2;
      const double at = part % 2 == 0 ? component(low, axis) : component(half_, axis);
      p = {axis == 0 ? at : q.x, axis == 1 ? at : q.y, axis == 2 ? at : q.z};
      break;
    }
    case SolidShape::mesh:
      break;
  }
  return to_world_.point(p);
}

}  // namespace plenoflame
