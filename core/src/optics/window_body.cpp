#include "optics/window_body.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

/// Height of a dome's rim above the centre of the sphere [m].
double rim_of(const WindowSpec& spec) {
  return spec.radius - spec.height;
}

}  // namespace

WindowSet::Body::Body(const WindowSpec& spec)
    : spec_(spec),
      to_world_{rotation_xyz(spec.rotation), spec.position},
      to_local_(to_world_.inverse()) {
  const auto plane = [&](Vec3 normal, double offset, bool polished) {
    faces_.push_back({Kind::plane, polished, normal, offset, 0, false});
  };
  const auto round = [&](Kind kind, double radius, bool hollow, bool polished) {
    faces_.push_back({kind, polished, {}, 0, radius, hollow});
  };
  switch (spec.shape) {
    case WindowShape::plate:
    case WindowShape::wedge: {
      const double sine = spec.shape == WindowShape::wedge ? std::sin(spec.angle) : 0;
      const double cosine = spec.shape == WindowShape::wedge ? std::cos(spec.angle) : 1;
      plane({0, 0, -1}, 0, true);
      plane({0, -sine, cosine}, cosine * spec.thickness, true);
      if (spec.diameter > 0) {
        round(Kind::cylinder, 0.5 * spec.diameter, false, false);
      } else {
        plane({1, 0, 0}, 0.5 * spec.extent.x, false);
        plane({-1, 0, 0}, 0.5 * spec.extent.x, false);
        plane({0, 1, 0}, 0.5 * spec.extent.y, false);
        plane({0, -1, 0}, 0.5 * spec.extent.y, false);
      }
      break;
    }
    case WindowShape::tube:
      round(Kind::cylinder, spec.radius, false, true);
      round(Kind::cylinder, spec.radius - spec.thickness, true, true);
      plane({0, 0, -1}, 0, false);
      plane({0, 0, 1}, spec.height, false);
      break;
    case WindowShape::dome:
      round(Kind::sphere, spec.radius, false, true);
      round(Kind::sphere, spec.radius - spec.thickness, true, true);
      if (rim_of(spec) > -spec.radius) plane({0, 0, -1}, -rim_of(spec), false);
      break;
  }
  Vec3 lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};
  for (const std::vector<Vec3>& loop : outline())
    for (const Vec3 p : loop) {
      lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
      upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
    }
  centre_ = 0.5 * (lower + upper);
  // The outline between its points is less than a tenth farther out.
  reach_square_ = 1.21 * 0.25 * dot(upper - lower, upper - lower);
  if (spec.shape == WindowShape::dome) {
    centre_ = spec.position;
    reach_square_ = 1.01 * spec.radius * spec.radius;
  }
}

/// Distance of a point from a face on the air's side [m]; on the glass' side: below 0.
double WindowSet::Body::beyond(const Face& face, Vec3 p) {
  if (face.kind == Kind::plane) return dot(face.normal, p) - face.offset;
  const double out = (face.kind == Kind::cylinder ? std::hypot(p.x, p.y) : length(p)) - face.radius;
  return face.hollow ? -out : out;
}

WindowSet::Body::Hit WindowSet::Body::intersect(const Ray& world, int from, double far) const {
  const Ray ray{to_local_.point(world.origin), to_local_.direction(world.direction)};
  Hit hit{far, kNoFace};
  const auto offer = [&](double t, std::size_t number) {
    if (!(t > 0 && t < hit.t)) return;
    const Vec3 p = ray.at(t);
    for (std::size_t other = 0; other < faces_.size(); ++other)
      if (other != number && beyond(faces_[other], p) > 0) return;
    hit = {t, static_cast<int>(number)};
  };
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const Face& face = faces_[i];
    const bool starts_here = static_cast<int>(i) == from;
    if (face.kind == Kind::plane) {
      const double along = dot(face.normal, ray.direction);
      if (!starts_here && along != 0)
        offer((face.offset - dot(face.normal, ray.origin)) / along, i);
      continue;
    }
    Vec3 o = ray.origin, d = ray.direction;
    if (face.kind == Kind::cylinder) o.z = d.z = 0;
    const double a = dot(d, d);
    if (!(a > 0)) continue;
    // From the point nearest to the centre on: no large numbers are subtracted.
    const double middle = -dot(o, d) / a;
    const Vec3 nearest = o + middle * d;
    const double half_square = (face.radius * face.radius - dot(nearest, nearest)) / a;
    if (starts_here) {
      // Its own origin is one root: the other one lies as far beyond the middle.
      offer(2 * middle, i);
      continue;
    }
    if (!(half_square > 0)) continue;
    const double half = std::sqrt(half_square);
    offer(middle - half, i);
    offer(middle + half, i);
  }
  return hit;
}

Vec3 WindowSet::Body::normal(int number, Vec3 world) const {
  const Face& face = faces_[static_cast<std::size_t>(number)];
  if (face.kind == Kind::plane) return to_world_.direction(face.normal);
  Vec3 p = to_local_.point(world);
  if (face.kind == Kind::cylinder) p.z = 0;
  return to_world_.direction((face.hollow ? -1 : 1) * normalize(p));
}

bool WindowSet::Body::contains(Vec3 world) const {
  const Vec3 p = to_local_.point(world);
  return std::all_of(faces_.begin(), faces_.end(),
                     [&](const Face& face) { return beyond(face, p) <= 0; });
}

bool WindowSet::Body::may_meet(const Ray& world) const {
  const Vec3 to_centre = centre_ - world.origin;
  const double ahead = dot(to_centre, world.direction), square = dot(to_centre, to_centre);
  if (ahead < 0 && square > reach_square_) return false;
  return square - ahead * ahead <= reach_square_;
}

/// A point of the glass, in the world. @param u, v over the faces @param w through the wall; all
/// from 0 to 1
Vec3 WindowSet::Body::point_of(double u, double v, double w) const {
  const double turn = 2 * constants::pi * u;
  Vec3 p;
  switch (spec_.shape) {
    case WindowShape::plate:
    case WindowShape::wedge: {
      if (spec_.diameter > 0)
        p = {0.5 * spec_.diameter * v * std::cos(turn), 0.5 * spec_.diameter * v * std::sin(turn),
             0};
      else
        p = {(u - 0.5) * spec_.extent.x, (v - 0.5) * spec_.extent.y, 0};
      const double rise = spec_.shape == WindowShape::wedge ? std::tan(spec_.angle) : 0;
      p.z = w * (spec_.thickness + rise * p.y);
      break;
    }
    case WindowShape::tube: {
      const double r = spec_.radius - w * spec_.thickness;
      p = {r * std::cos(turn), r * std::sin(turn), v * spec_.height};
      break;
    }
    case WindowShape::dome: {
      const double r = spec_.radius - w * spec_.thickness;
      const double polar = v * std::acos(std::clamp(rim_of(spec_) / r, -1.0, 1.0));
      p = {r * std::sin(polar) * std::cos(turn), r * std::sin(polar) * std::sin(turn),
           r * std::cos(polar)};
      break;
    }
  }
  return to_world_.point(p);
}

std::array<int, 3> WindowSet::Body::counts() const {
  double across = std::max(spec_.extent.x, spec_.extent.y);
  if (spec_.diameter > 0) across = constants::pi * spec_.diameter;
  if (spec_.shape == WindowShape::tube || spec_.shape == WindowShape::dome)
    across = std::max(2 * constants::pi * spec_.radius, spec_.height);
  const auto most = static_cast<int>(std::clamp(2 * across / spec_.thickness, 24.0, 400.0));
  return {most, spec_.shape == WindowShape::dome ? most / 2 + 1 : most, 3};
}

std::vector<Vec3> WindowSet::Body::points() const {
  const auto [nu, nv, nw] = counts();
  std::vector<Vec3> points;
  points.reserve(static_cast<std::size_t>(nu) * static_cast<std::size_t>(nv) *
                 static_cast<std::size_t>(nw));
  for (int u = 0; u < nu; ++u)
    for (int v = 0; v < nv; ++v)
      for (int w = 0; w < nw; ++w)
        points.push_back(point_of(u / (nu - 1.0), v / (nv - 1.0), w / (nw - 1.0)));
  return points;
}

std::vector<std::vector<Vec3>> WindowSet::Body::outline() const {
  constexpr int kSteps = 72;
  std::vector<std::vector<Vec3>> loops;
  const bool flat = spec_.shape == WindowShape::plate || spec_.shape == WindowShape::wedge;
  const bool square = flat && !(spec_.diameter > 0);
  // Around, at both faces; bodies with an axis also along four lines from end to end.
  for (const double w : {0.0, 1.0}) {
    if (square) {
      loops.push_back({point_of(0, 0, w), point_of(1, 0, w), point_of(1, 1, w), point_of(0, 1, w),
                       point_of(0, 0, w)});
      continue;
    }
    for (const double v : {0.0, 1.0}) {
      if (v == 0 && spec_.shape != WindowShape::tube) continue;
      loops.emplace_back();
      for (int i = 0; i <= kSteps; ++i)
        loops.back().push_back(point_of(static_cast<double>(i) / kSteps, v, w));
    }
    if (flat) continue;
    for (const double u : {0.0, 0.25, 0.5, 0.75}) {
      loops.emplace_back();
      for (int i = 0; i <= kSteps; ++i)
        loops.back().push_back(point_of(u, static_cast<double>(i) / kSteps, w));
    }
  }
  if (!flat) return loops;
  for (const double u : {0.0, 0.25, 0.5, 0.75}) {
    const double x = square && u >= 0.5 ? 1 : 0;
    const double y = square && (u == 0.25 || u == 0.75) ? 1 : 0;
    loops.push_back(square ? std::vector{point_of(x, y, 0), point_of(x, y, 1)}
                           : std::vector{point_of(u, 1, 0), point_of(u, 1, 1)});
  }
  return loops;
}

}  // namespace plenoflame
