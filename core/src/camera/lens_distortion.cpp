#include "plenoflame/camera/lens_distortion.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// Tangent of the largest direction that is checked, 79 degrees from the axis.
constexpr double kWidest = 5;
constexpr int kRadii = 500, kAzimuths = 16;
/// Smallest ratio of areas that is accepted: a map that folds soon after cannot be inverted
/// accurately.
constexpr double kLeastArea = 0.15;
constexpr double kInverseAccuracy = 1e-12;  ///< relative, after kSteps steps

/// Factor of u from the radial terms, and its derivative by r^2.
struct Radial {
  double factor, slope;
};

Radial radial(const DistortionSpec& d, double r2) {
  return {1 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3)), d.k1 + r2 * (2 * d.k2 + r2 * 3 * d.k3)};
}

/// The derivative of the map, a symmetrical matrix.
struct Derivative {
  double xx, xy, yy;
  double determinant() const { return xx * yy - xy * xy; }
};

Derivative derivative(const DistortionSpec& d, Vec2 u) {
  const auto [factor, slope] = radial(d, dot(u, u));
  return {factor + 2 * u.x * u.x * slope + 2 * d.p1 * u.y + 6 * d.p2 * u.x,
          2 * u.x * u.y * slope + 2 * d.p1 * u.x + 2 * d.p2 * u.y,
          factor + 2 * u.y * u.y * slope + 6 * d.p1 * u.y + 2 * d.p2 * u.x};
}

/// cos^4 of the angle with the axis. It is the ratio of solid angle times projected area to area
/// times the area of slopes.
double cosine4(Vec2 slope) {
  const double secant2 = 1 + dot(slope, slope);
  return 1 / (secant2 * secant2);
}

Vec2 slope_of(const Ray& ray) {
  return {ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z};
}

Vec2 place_at(const Ray& ray, double z) {
  const Vec3 p = ray.at((z - ray.origin.z) / ray.direction.z);
  return {p.x, p.y};
}

}  // namespace

LensDistortion::LensDistortion(const DistortionSpec& spec, double pupil)
    : present_(!spec.none()), spec_(spec), pupil_(pupil) {
  if (!present_) return;
  if (!std::isfinite(pupil))
    throw InputError(
        "camera.lens.distortion needs an entrance pupil, from whose middle directions count; that "
        "of this lens is infinitely far away");
  if (!(spec.distance > pupil))
    throw InputError(
        "camera.lens.distortion.distance puts the plane that stays sharp behind the entrance "
        "pupil; give a distance in front of the lens, or inf");
  per_distance_ = 1 / (spec.distance - pupil);
  limit_ = find_limit();
}

Vec2 LensDistortion::distorted(Vec2 u) const {
  const double r2 = dot(u, u), xy = 2 * u.x * u.y, factor = radial(spec_, r2).factor;
  return {factor * u.x + spec_.p1 * xy + spec_.p2 * (r2 + 2 * u.x * u.x),
          factor * u.y + spec_.p1 * (r2 + 2 * u.y * u.y) + spec_.p2 * xy};
}

double LensDistortion::area_ratio(Vec2 u) const {
  return derivative(spec_, u).determinant();
}

Vec2 LensDistortion::newton_step(Vec2 u, Vec2 v) const {
  const Derivative d = derivative(spec_, u);
  const Vec2 miss = v - distorted(u);
  const double inverse = 1 / d.determinant();
  return u +
         Vec2{inverse * (d.yy * miss.x - d.xy * miss.y), inverse * (d.xx * miss.y - d.xy * miss.x)};
}

std::optional<Vec2> LensDistortion::undistorted(Vec2 v) const {
  if (!(length(v) <= limit_)) return std::nullopt;
  Vec2 u = v;
  for (int step = 0; step < kSteps; ++step) {
    const Vec2 next = newton_step(u, v);
    if (next == u) break;
    u = next;
  }
  return u;
}

bool LensDistortion::is_well_behaved(double radius) const {
  for (int k = 0; k < kAzimuths; ++k) {
    const double angle = 2 * constants::pi * k / kAzimuths;
    const Vec2 u{radius * std::cos(angle), radius * std::sin(angle)};
    const Derivative d = derivative(spec_, u);
    if (!(d.determinant() > kLeastArea && d.xx + d.yy > 0)) return false;
    const Vec2 v = distorted(u);
    Vec2 back = v;
    for (int step = 0; step < kSteps; ++step) back = newton_step(back, v);
    if (!(length(back - u) <= kInverseAccuracy * radius)) return false;
  }
  return true;
}

void LensDistortion::restrict_to(double limit) {
  limit_ = std::min(limit_, limit);
}

double LensDistortion::largest_bend(double reach) const {
  constexpr int kRings = 32;
  constexpr double kBetween = 1.05;  // margin for directions between the samples
  double largest = 0;
  for (int i = 1; i <= kRings; ++i)
    for (int k = 0; k < kAzimuths; ++k) {
      const double angle = 2 * constants::pi * k / kAzimuths;
      const double radius = std::min(reach, limit_) * i / kRings;
      const Vec2 v{radius * std::cos(angle), radius * std::sin(angle)};
      if (const auto u = undistorted(v)) largest = std::max(largest, length(*u - v));
      // Outer directions may be longer than inner ones, so both ends of the map count.
      const Vec2 image = distorted(v);
      if (length(image) <= limit_) largest = std::max(largest, length(image - v));
    }
  return kBetween * largest;
}

double LensDistortion::find_limit() const {
  double limit = 0;
  for (int i = 1; i <= kRadii; ++i) {
    const double radius = kWidest * i / kRadii;
    if (!is_well_behaved(radius)) break;
    double least = kInfinity;
    for (int k = 0; k < kAzimuths; ++k) {
      const double angle = 2 * constants::pi * k / kAzimuths;
      least =
          std::min(least, length(distorted({radius * std::cos(angle), radius * std::sin(angle)})));
    }
    limit = std::max(limit, least);
  }
  return limit;
}

Vec2 LensDistortion::direction(const Ray& ray) const {
  return slope_of(ray) + per_distance_ * place_at(ray, pupil_);
}

bool LensDistortion::to_scene(Ray& ray) const {
  const Vec2 p = place_at(ray, pupil_);
  const auto u = undistorted(slope_of(ray) + per_distance_ * p);
  if (!u) return false;
  const Vec2 slope = *u - per_distance_ * p;
  ray = {{p.x, p.y, pupil_}, normalize({slope.x, slope.y, 1})};
  return true;
}

bool LensDistortion::to_lens(Ray& ray, double& ratio) const {
  const Vec2 p = place_at(ray, pupil_), outer = slope_of(ray);
  const Vec2 u = outer + per_distance_ * p, v = distorted(u);
  // Beyond the fold of the map, directions return to values within the limit.
  if (!(length(v) <= limit_) || !(derivative(spec_, u).determinant() > 0)) return false;
  const auto back = undistorted(v);
  if (!back || !(length(*back - u) <= 1e-6 * (1 + length(u)))) return false;
  const Vec2 inner = v - per_distance_ * p;
  ratio *= area_ratio(u) * cosine4(inner) / cosine4(outer);
  const double towards = ray.direction.z < 0 ? -1 : 1;
  ray = {{p.x, p.y, pupil_}, towards * normalize({inner.x, inner.y, 1})};
  return true;
}

}  // namespace plenoflame
