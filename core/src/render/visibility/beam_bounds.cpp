#include "render/visibility/beam_bounds.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {
namespace {

// Rays are traced from some aim points in some directions. The parts of the beam beyond them are a
// few per cent of its size. Near a focus, where aim and direction nearly cancel, they are up to 11
// %.
constexpr double kBoundMargin = 0.15;
// For first-order approximations in misaligned cameras.
constexpr double kMisalignedMargin = 1.25;

constexpr int kMostAround = 64;  ///< largest number of neighbourhoods along a side of the sensor
constexpr int kAcross = 8;       ///< smallest number of microlenses, or pixels, across one

}  // namespace

BeamBounds::BeamBounds(const Camera& camera, const std::vector<PupilTable>& tables,
                       const OccupiedRegion& region)
    : region_(&region) {
  // Edges in the tables are valid for a round lens.
  everywhere_ = !region.bounded() || !camera.lens_is_round();
  if (everywhere_) return;
  // Without array a beam starts from all places whose light a pixel records, including its corners.
  half_diagonal_ = camera.has_array() ? 0 : camera.spec().sensor.footprint_reach();
  misaligned_ = camera.misaligned();
  if (misaligned_) {
    const Camera aligned = camera.aligned();
    const FirstOrder& lens = camera.lens_first_order();
    to_lens_ = camera.lens_pose().inverse();
    plane_ = camera.has_array() ? aligned.lens_place({0, 0}).z : aligned.sensor();
    pupil_ = camera.exit_pupil();
    pupil_radius_ = 0.5 * lens.exit_pupil_diameter;
    aperture_ = camera.has_array() ? camera.aperture().radius() : half_diagonal_;
    tilt_ =
        std::tan(std::min(1.5, length(camera.spec().lens.tilt) +
                                   (camera.has_array() ? length(camera.spec().array.tilt) : 0)));
  }
  const double planes[2] = {region.near_plane(), region.far_plane()};
  for (const PupilTable& table : tables) {
    FieldTable field;
    field.step = table.field_step;
    for (const std::vector<Ray>& rays : table.edges) {
      // There may be light between a field with passing rays and a field without any. Its path is
      // unknown.
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
        footprint.radius[k] *= 1 + kBoundMargin;
      }
      field.nodes.push_back(footprint);
    }
    fields_.push_back(std::move(field));
  }
  if (!misaligned_) survey(camera);
}

void BeamBounds::survey(const Camera& camera) {
  const SensorSpec& sensor = camera.spec().sensor;
  const double pitch = camera.has_array() ? camera.spec().array.pitch : sensor.pixel().x;
  const Vec2 size = sensor.size();
  const auto count = [&](double length) {
    return static_cast<int>(std::clamp(length / (kAcross * pitch), 1.0, double{kMostAround}));
  };
  around_.columns = count(size.x);
  around_.rows = count(size.y);
  around_.lower = -0.5 * size;
  around_.scale = {around_.columns / size.x, around_.rows / size.y};
  const Vec2 cell{1 / around_.scale.x, 1 / around_.scale.y};
  for (const FieldTable& field : fields_)
    for (int row = 0; row < around_.rows; ++row)
      for (int column = 0; column < around_.columns; ++column)
        around_.dark.push_back(
            is_dark(field, around_.lower + Vec2{(column + 0.5) * cell.x, (row + 0.5) * cell.y},
                    (0.5 + kBoundMargin) * length(cell)));
}

/// Tells whether every place within `room` of the middle sees nothing.
bool BeamBounds::is_dark(const FieldTable& field, Vec2 middle, double room) const {
  const double h = length(middle);
  const double last = static_cast<double>(field.nodes.size() - 1);
  const auto node_at = [&](double at) {
    return static_cast<std::size_t>(std::clamp(at / field.step, 0.0, last - 1));
  };
  const std::size_t first = node_at(h - room), end = node_at(h + room) + 1;
  if (first == 0) return false;  // near the axis directions change too much
  const std::size_t i = node_at(h);
  const double t = std::min(h / field.step - static_cast<double>(i), 1.0);
  Vec2 centre[2];
  double radius = 0;
  for (int k = 0; k < 2; ++k) {
    const Footprint &a = field.nodes[i], &b = field.nodes[i + 1];
    centre[k] = ((a.centre[k] + t * (b.centre[k] - a.centre[k])) / h) * middle;
    // Largest rate at which the beam moves with its place, away from the axis and around it.
    double widest = 0, moves = 0;
    for (std::size_t node = first; node <= end; ++node) {
      const double at = field.nodes[node].centre[k];
      widest = std::max(widest, field.nodes[node].radius[k]);
      moves = std::max(moves, std::fabs(at) / (static_cast<double>(node) * field.step));
      if (node < end)
        moves = std::max(moves, std::fabs(field.nodes[node + 1].centre[k] - at) / field.step);
    }
    radius = std::max(radius, widest + (1 + kBoundMargin) * moves * (half_diagonal_ + room));
  }
  return !region_->meets(centre, radius);
}

bool BeamBounds::may_meet(int table, Vec3 place) const {
  if (everywhere_) return true;
  if (!misaligned_) return may_meet(table, {place.x, place.y}, 0);
  if (!std::isfinite(pupil_)) return true;
  const Vec3 p = to_lens_.point(place);
  const Vec2 off{p.x, p.y};
  const double to_pupil = pupil_ - p.z, scale = (pupil_ - plane_) / to_pupil;
  if (!(to_pupil > 0 && scale > 0)) return true;
  const double steepest = (pupil_radius_ + length(off)) / to_pupil;
  const double room = (std::fabs(p.z - plane_) * pupil_radius_ / to_pupil +
                       aperture_ * tilt_ * steepest + aperture_ * std::fabs(scale - 1)) *
                      kMisalignedMargin;
  return may_meet(table, scale * off, room);
}

bool BeamBounds::may_meet(int table, Vec2 place, double room) const {
  const FieldTable& field = fields_[static_cast<std::size_t>(table)];
  if (around_.columns > 0) {
    const double x = (place.x - around_.lower.x) * around_.scale.x;
    const double y = (place.y - around_.lower.y) * around_.scale.y;
    if (x >= 0 && y >= 0 && x < around_.columns && y < around_.rows &&
        around_.dark[static_cast<std::size_t>(
            (table * around_.rows + static_cast<int>(y)) * around_.columns + static_cast<int>(x))])
      return false;
  }
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
    // A pixel without array is as wide as its diagonal; its beam moves with its centre.
    const double along = std::fabs(b.centre[k] - a.centre[k]) / field.step;
    const double across = h > 0 ? std::sqrt(dot(centre[k], centre[k])) / h : along;
    radius = std::max(radius, std::max(a.radius[k], b.radius[k]) + (1 + kBoundMargin) *
                                                                       std::max(along, across) *
                                                                       (half_diagonal_ + room));
  }
  return region_->meets(centre, radius);
}

}  // namespace plenoflame
