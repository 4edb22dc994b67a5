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
                       const LitRegion& region)
    : region_(&region) {
  if (!region.bounded()) return;
  // Without array a beam belongs to a whole pixel, not to its centre.
  half_diagonal_ = camera.has_array() ? 0 : std::sqrt(0.5) * camera.spec().sensor.pixel_pitch;
  const double planes[2] = {region.near_plane(), region.far_plane()};
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
  if (!region_->bounded()) return true;
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
    // A pixel without array is as wide as its diagonal; what it sees moves with the centre.
    const double along = std::fabs(b.centre[k] - a.centre[k]) / field.step;
    const double across = h > 0 ? length(centre[k]) / h : along;
    radius = std::max(radius, std::max(a.radius[k], b.radius[k]) +
                                  (1 + kMargin) * std::max(along, across) * half_diagonal_);
  }
  return region_->meets(centre, radius);
}

}  // namespace plenoflame
