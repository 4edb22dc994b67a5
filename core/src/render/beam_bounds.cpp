#include "render/beam_bounds.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {
namespace {

// Edge rays are traced at 25 fields, from 25 aim points in 16 directions: polygons inscribed in the
// true outline (2 % at most), and straight interpolation over the field.
constexpr double kMargin = 0.08;

}  // namespace

BeamBounds::BeamBounds(const Camera& camera, const std::vector<PupilTable>& tables,
                       const Box& box) {
  const RigidTransform to_camera = camera.to_world().inverse();
  Vec3 lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p = to_camera.point({(corner & 1) ? box.upper.x : box.lower.x,
                                    (corner & 2) ? box.upper.y : box.lower.y,
                                    (corner & 4) ? box.upper.z : box.lower.z});
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  lower_ = {lower.x, lower.y};
  upper_ = {upper.x, upper.y};
  always_ = !(lower.z > 0) || !std::isfinite(upper.z);
  if (always_) return;
  // Without array a beam belongs to a whole pixel, not to its centre.
  half_diagonal_ = camera.has_array() ? 0 : std::sqrt(0.5) * camera.spec().sensor.pixel_pitch;
  const double planes[2] = {lower.z, upper.z};
  for (const PupilTable& table : tables) {
    FieldTable field;
    field.step = table.field_step;
    for (const std::vector<Ray>& rays : table.edges) {
      // Beyond the last field that anything passes at, pupil tables go on as there.
      Footprint footprint = rays.empty() && !field.nodes.empty() ? field.nodes.back() : Footprint{};
      for (int k = 0; k < 2; ++k) {
        double lo = kInfinity, hi = -kInfinity;
        std::vector<Vec2> points;
        for (const Ray& ray : rays) {
          const Vec3 p = ray.at((planes[k] - ray.origin.z) / ray.direction.z);
          points.push_back({p.x, p.y});
          lo = std::min(lo, p.x);
          hi = std::max(hi, p.x);
        }
        if (points.empty()) continue;
        footprint.centre[k] = 0.5 * (lo + hi);
        for (const Vec2 p : points)
          footprint.radius[k] =
              std::max(footprint.radius[k], length(p - Vec2{footprint.centre[k], 0}));
        footprint.radius[k] *= 1 + kMargin;
      }
      field.nodes.push_back(footprint);
    }
    fields_.push_back(std::move(field));
  }
}

bool BeamBounds::may_meet(int table, Vec2 place) const {
  if (always_) return true;
  const FieldTable& field = fields_[static_cast<std::size_t>(table)];
  const double h = length(place);
  const auto last = field.nodes.size() - 1;
  const double at = std::min(h / field.step, static_cast<double>(last));
  const std::size_t i = std::min(static_cast<std::size_t>(at), last - 1);
  const double t = at - static_cast<double>(i);
  const Footprint& a = field.nodes[i];
  const Footprint& b = field.nodes[i + 1];
  const Vec2 outwards = h > 0 ? (1.0 / h) * place : Vec2{1, 0};
  Vec2 centre[2];
  double radius = 0;
  for (int k = 0; k < 2; ++k) {
    centre[k] = (a.centre[k] + t * (b.centre[k] - a.centre[k])) * outwards;
    // Half of what the centre moves between nodes covers its curvature.
    const double along = std::fabs(b.centre[k] - a.centre[k]) / field.step;
    const double across = h > 0 ? length(centre[k]) / h : along;
    radius = std::max(radius, std::max(a.radius[k], b.radius[k]) +
                                  (1 + kMargin) * std::max(along, across) * half_diagonal_);
  }
  // The beam lies in the hull of both footprints: a capsule. Distance of its axis from the
  // rectangle, bounded by testing the axis' own bounding rectangle first, then its normal.
  const Vec2 lo{std::min(centre[0].x, centre[1].x) - radius,
                std::min(centre[0].y, centre[1].y) - radius};
  const Vec2 hi{std::max(centre[0].x, centre[1].x) + radius,
                std::max(centre[0].y, centre[1].y) + radius};
  if (lo.x > upper_.x || hi.x < lower_.x || lo.y > upper_.y || hi.y < lower_.y) return false;
  const Vec2 axis = centre[1] - centre[0];
  const double axis_length = length(axis);
  if (!(axis_length > 0)) return true;
  const Vec2 normal{-axis.y / axis_length, axis.x / axis_length};
  const double offset = dot(normal, centre[0]);
  double low = kInfinity, high = -kInfinity;
  for (const Vec2 corner : {lower_, Vec2{upper_.x, lower_.y}, Vec2{lower_.x, upper_.y}, upper_}) {
    const double d = dot(normal, corner) - offset;
    low = std::min(low, d);
    high = std::max(high, d);
  }
  return low <= radius && high >= -radius;
}

}  // namespace plenoflame
