#include "render/beam_bounds.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {
namespace {

// Edge rays are traced at 25 fields, from 25 aim points in 16 directions: polygons inscribed in the
// true outline (2 % at most), and straight interpolation over the field.
constexpr double kMargin = 0.08;
// For what is taken to first order in cameras that are not aligned.
constexpr double kMisalignedMargin = 1.25;

}  // namespace

BeamBounds::BeamBounds(const Camera& camera, const std::vector<PupilTable>& tables,
                       const LitRegion& region)
    : region_(&region) {
  if (!region.bounded()) return;
  // Without array a beam belongs to a whole pixel, not to its centre.
  half_diagonal_ = camera.has_array() ? 0 : std::sqrt(0.5) * camera.spec().sensor.pixel_pitch;
  misaligned_ = camera.misaligned();
  if (misaligned_) {
    const Camera aligned = camera.aligned();
    const FirstOrder& lens = camera.lens_first_order();
    to_lens_ = camera.lens_pose().inverse();
    plane_ = camera.has_array() ? aligned.lens_place({0, 0}).z : aligned.sensor();
    pupil_ = camera.exit_pupil();
    pupil_radius_ = 0.5 * lens.exit_pupil_diameter;
    aperture_ = camera.has_array() ? 0.5 * camera.spec().array.diameter : half_diagonal_;
    tilt_ =
        std::tan(std::min(1.5, length(camera.spec().lens.tilt) +
                                   (camera.has_array() ? length(camera.spec().array.tilt) : 0)));
  }
  const double planes[2] = {region.near_plane(), region.far_plane()};
  for (const PupilTable& table : tables) {
    FieldTable field;
    field.step = table.field_step;
    for (const std::vector<Ray>& rays : table.edges) {
      // Between a field at which something passes and one at which nothing does there may be light;
      // where it goes is not known.
      Footprint footprint;
      if (rays.empty()) footprint.radius[0] = footprint.radius[1] = kInfinity;
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

Sight BeamBounds::look(int table, Vec3 place) const {
  if (!region_->bounded()) return Sight::filled;
  if (!misaligned_) return look(table, {place.x, place.y}, 0);
  if (!std::isfinite(pupil_)) return Sight::filled;
  const Vec3 p = to_lens_.point(place);
  const Vec2 off{p.x, p.y};
  const double to_pupil = pupil_ - p.z, scale = (pupil_ - plane_) / to_pupil;
  if (!(to_pupil > 0 && scale > 0)) return Sight::filled;
  const double steepest = (pupil_radius_ + length(off)) / to_pupil;
  const double room = (std::fabs(p.z - plane_) * pupil_radius_ / to_pupil +
                       aperture_ * tilt_ * steepest + aperture_ * std::fabs(scale - 1)) *
                      kMisalignedMargin;
  return look(table, scale * off, room);
}

Sight BeamBounds::look(int table, Vec2 place, double room) const {
  const FieldTable& field = fields_[static_cast<std::size_t>(table)];
  const double h = std::sqrt(dot(place, place));
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
    const double across = h > 0 ? std::sqrt(dot(centre[k], centre[k])) / h : along;
    radius =
        std::max(radius, std::max(a.radius[k], b.radius[k]) +
                             (1 + kMargin) * std::max(along, across) * (half_diagonal_ + room));
  }
  if (!region_->meets(centre, radius)) return Sight::nothing;
  return region_->is_filled(centre, radius) ? Sight::filled : Sight::some;
}

}  // namespace plenoflame
