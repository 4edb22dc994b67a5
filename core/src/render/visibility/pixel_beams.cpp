#include "render/visibility/pixel_beams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "camera/pupil/pupil_tracer.h"
#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

// Light between the traced rays may reach a little farther. This applies between directions, as a
// polygon of 16 corners lacks 2 % of its circle. It also applies between the aim points, which are
// at certain shares of the distance to the opening's edge.
constexpr double kMargin = 0.08;
constexpr int kDirections = 16;
constexpr double kShares[] = {0.5, 0.85, 0.95, 0.985, 1};
constexpr int kAzimuths = 5;  ///< azimuths of sensor points, over half a turn
/// Shares of the micro-image's radius. At its very middle, cuts hold for all azimuths and are wide.
constexpr double kFirstRing = 0.02, kLastRing = 0.99;
constexpr double kPoint = 0.01;           ///< share of a pixel: cuts are evaluated at points
constexpr double kSingleRounding = 1e-6;  ///< share of the distance, for single precision

/// The part of a microlens' aperture that a sensor point may see, in coordinates along the line
/// through the micro-image's centre and across (PupilCut).
class SeenAperture {
 public:
  /// @param distance from the micro-image's centre @param sensor from the microlens' centre
  /// @param e direction of the line
  SeenAperture(const PixelView& view, double distance, const ApertureDiscs& discs, Vec2 sensor,
               Vec2 e)
      : bound_(discs.bound),
        centre_(discs.far_centre(sensor)),
        radius_(discs.radius_at(sensor) + std::fabs(centre_.x * e.y - centre_.y * e.x)),
        along_(dot(centre_, e)),
        near_radius_(discs.near_radius +
                     std::fabs(discs.near_shift * (sensor.x * e.y - sensor.y * e.x))),
        near_along_(discs.near_shift * dot(sensor, e)),
        low_(std::max({-bound_, along_ - radius_, near_along_ - near_radius_})),
        high_(std::min({bound_, along_ + radius_, near_along_ + near_radius_})),
        is_cut_(!view.open) {
    if (!is_cut_) return;
    const PupilCut cut = cut_at(*view.column, static_cast<float>(distance));
    for (std::size_t k = 0; k < 4; ++k) cut_[k] = static_cast<double>(cut[k]);
    low_ = std::max(low_, -cut_[0]);
    high_ = std::min(high_, cut_[1]);
  }
  bool empty() const { return !(high_ > low_); }
  double low() const { return low_; }
  double high() const { return high_; }
  /// Half the chord across the line at p.
  double half_chord(double p) const {
    double square =
        std::min({bound_ * bound_ - p * p, radius_ * radius_ - (p - along_) * (p - along_),
                  near_radius_ * near_radius_ - (p - near_along_) * (p - near_along_)});
    if (is_cut_)
      square = std::min({square, (p + cut_[0]) * (cut_[2] - p), (cut_[1] - p) * (p + cut_[3])});
    return std::sqrt(std::max(0.0, square));
  }

 private:
  double bound_;
  Vec2 centre_;
  double radius_, along_, near_radius_, near_along_, low_, high_;
  bool is_cut_;
  std::array<double, 4> cut_{};
};

/// Requests rays from a sensor point to points of the visible part of the microlens' aperture.
void request_spot(const PupilNode& node, const ApertureDiscs& discs, double pixel, Vec2 v,
                  std::vector<PupilTracer::Request>& requests) {
  const double d = length(v);
  const Vec2 e = d > 0 ? (1 / d) * v : Vec2{1, 0}, sensor = Vec2{node.centre, 0} + v;
  const PixelView view = node.cuts.look(v, kPoint * pixel, {1, 0});
  const SeenAperture opening(view, d, discs, sensor, e);
  if (view.dark || opening.empty()) return;
  const double middle = 0.5 * (opening.low() + opening.high());
  for (int i = 0; i < kDirections; ++i) {
    const double turn = 2 * constants::pi * i / kDirections;
    const double p = middle + 0.5 * (opening.high() - opening.low()) * std::cos(turn);
    const double q = std::copysign(opening.half_chord(p), std::sin(turn));
    for (const double share : kShares) {
      const Vec2 u{middle + share * (p - middle), share * q};
      requests.push_back({sensor, {u.x * e.x - u.y * e.y, u.x * e.y + u.y * e.x}});
    }
  }
}

/// The straight line y = a + b x closest to some points, by least squares.
class Line {
 public:
  void add(double x, double y) {
    n_ += 1;
    x_ += x, y_ += y, xx_ += x * x, xy_ += x * y;
  }
  /// Tells whether the points are far enough apart to define the line.
  bool is_known() const { return scatter() > kLeastScatter * n_ * xx_; }
  double slope() const { return (n_ * xy_ - x_ * y_) / scatter(); }
  double at_zero() const { return (y_ - slope() * x_) / n_; }

 private:
  static constexpr double kLeastScatter = 1e-3;
  double scatter() const { return n_ * xx_ - x_ * x_; }
  double n_ = 0, x_ = 0, y_ = 0, xx_ = 0, xy_ = 0;
};

}  // namespace

PixelBeams::Map PixelBeams::Map::mixed(const Map& other, double t) const {
  Map map;
  for (std::size_t k = 0; k < 2; ++k) {
    map.centre[k] = centre[k] + t * (other.centre[k] - centre[k]);
    map.along[k] = along[k] + t * (other.along[k] - along[k]);
    map.across[k] = across[k] + t * (other.across[k] - across[k]);
  }
  return map;
}

std::unique_ptr<const PixelBeams> PixelBeams::make(const Camera& camera,
                                                   const std::vector<PupilTable>& tables,
                                                   const OccupiedRegion& region) {
  if (!camera.has_array() || camera.misaligned() || !camera.lens_is_round() || !region.bounded())
    return nullptr;
  return std::unique_ptr<const PixelBeams>(new PixelBeams(camera, tables, region));
}

PixelBeams::PixelBeams(const Camera& camera, const std::vector<PupilTable>& tables,
                       const OccupiedRegion& region)
    : camera_(camera.with_circles()),
      region_(region),
      planes_{region.near_plane(), region.far_plane()},
      half_diagonal_(camera.spec().sensor.footprint_reach()) {
  for (const PupilTable& pupils : tables) {
    tables_.emplace_back();
    tables_.back().pupils = &pupils;
    tables_.back().intervals = std::vector<Interval>(pupils.nodes.size() - 1);
  }
}

/// The spots of sensor points in rings around the micro-image's centre, at one field.
struct PixelBeams::Spot {
  std::size_t ring;
  Vec2 w;                                 ///< sensor point, in units of `outer`
  std::vector<std::array<Vec2, 2>> rays;  ///< crossings with the two planes
};

std::vector<PixelBeams::Spot> PixelBeams::spots(int table, double h, double outer) const {
  const PupilTable& pupils = *tables_[static_cast<std::size_t>(table)].pupils;
  const PupilNode node = pupils.at(h);
  std::vector<Spot> spots;
  std::vector<PupilTracer::Request> requests;
  std::vector<std::size_t> spot_of;
  for (std::size_t ring = 0; ring < kRings; ++ring)
    for (int i = 0; i < kAzimuths; ++i) {
      const double angle = constants::pi * i / (kAzimuths - 1);
      const double r = std::clamp(static_cast<double>(ring) / (kRings - 1), kFirstRing, kLastRing);
      spots.push_back({ring, {r * std::cos(angle), r * std::sin(angle)}, {}});
      request_spot(node, pupils.discs, camera_.spec().sensor.pixel_pitch, outer * spots.back().w,
                   requests);
      spot_of.resize(requests.size(), spots.size() - 1);
    }
  PupilTracer tracer(camera_, table, false);
  tracer.trace(h, requests, [&](std::size_t index, bool passes, const Ray& ray) {
    if (!passes) return;
    std::array<Vec2, 2> crossing;
    for (std::size_t k = 0; k < 2; ++k) {
      const Vec3 p = ray.at((planes_[k] - ray.origin.z) / ray.direction.z);
      crossing[k] = {p.x, p.y};
    }
    spots[spot_of[index]].rays.push_back(crossing);
  });
  std::erase_if(spots, [](const Spot& spot) { return spot.rays.empty(); });
  return spots;
}

/// Fits the map to all rays. Returns nothing for too few rays, at fields with almost no light.
std::optional<PixelBeams::Map> PixelBeams::map_of(const std::vector<Spot>& spots) {
  Map map;
  for (std::size_t k = 0; k < 2; ++k) {
    Line along, across;
    for (const Spot& spot : spots)
      for (const auto& ray : spot.rays) {
        along.add(spot.w.x, ray[k].x);
        // With its mirror image, so that the line goes through 0.
        across.add(spot.w.y, ray[k].y);
        across.add(-spot.w.y, -ray[k].y);
      }
    if (!along.is_known() || !across.is_known()) return std::nullopt;
    map.centre[k] = along.at_zero();
    map.along[k] = along.slope();
    map.across[k] = across.slope();
  }
  return map;
}

void PixelBeams::trace(int table, std::size_t i, Interval& interval) const {
  const PupilTable& pupils = *tables_[static_cast<std::size_t>(table)].pupils;
  interval.radii.fill(kInfinity);
  const PupilNode &a = pupils.nodes[i], &b = pupils.nodes[i + 1];
  if (a.dark() || b.dark()) return;
  interval.outer = std::max(a.outer_radius, b.outer_radius);
  std::array<std::vector<Spot>, 3> of_fields;
  for (int step = 0; step < 3; ++step)
    of_fields[step] =
        spots(table, (static_cast<double>(i) + 0.5 * step) * pupils.field_step, interval.outer);
  const std::optional<Map> from = map_of(of_fields[0]), to = map_of(of_fields[2]);
  if (!from || !to || of_fields[1].empty()) return;
  interval.ends[0] = *from;
  interval.ends[1] = *to;
  std::array<double, kRings> radii{};
  const double half = half_diagonal_ / interval.outer;
  for (int step = 0; step < 3; ++step) {
    const Map map = interval.ends[0].mixed(interval.ends[1], 0.5 * step);
    for (const Spot& spot : of_fields[step])
      for (std::size_t k = 0; k < 2; ++k) {
        const Vec2 middle = map.at(k, spot.w);
        double& radius = radii[spot.ring];
        // Displacement of the middle within a pixel.
        const double pixel = half * std::max(std::fabs(map.along[k]), std::fabs(map.across[k]));
        for (const auto& ray : spot.rays)
          radius = std::max(radius, (1 + kMargin) * (length(ray[k] - middle) + pixel) +
                                        kSingleRounding * (length(ray[k]) + planes_[1]));
      }
  }
  const double widest = *std::max_element(radii.begin(), radii.end());
  for (double& radius : radii)
    if (!(radius > 0)) radius = widest;  // no ray of this ring passed
  if (!(widest > 0)) return;
  interval.radii = radii;
}

PixelBeam PixelBeams::of(int table, Vec2 place) const {
  Table& rows = tables_[static_cast<std::size_t>(table)];
  const double h = length(place);
  const auto last = static_cast<double>(rows.intervals.size());
  const double at = std::min(h / rows.pupils->field_step, last);
  const std::size_t i = std::min(static_cast<std::size_t>(at), rows.intervals.size() - 1);
  const double t = at - static_cast<double>(i);
  Interval& interval = rows.intervals[i];
  std::call_once(interval.once, [&] { trace(table, i, interval); });
  PixelBeam beam;
  beam.region_ = &region_;
  beam.interval_ = &interval;
  const Map map = interval.ends[0].mixed(interval.ends[1], t);
  const Vec2 e = beam.field_ = h > 0 ? (1 / h) * place : Vec2{1, 0};
  const PupilNode &a = rows.pupils->nodes[i], &b = rows.pupils->nodes[i + 1];
  beam.centre_ = a.centre + t * (b.centre - a.centre);
  beam.half_ = half_diagonal_;
  for (std::size_t k = 0; k < 2; ++k) {
    const double along = map.along[k] / interval.outer, across = map.across[k] / interval.outer;
    const double turned = (along - across) * e.x * e.y;
    beam.planes_[k] = {(map.centre[k] - along * beam.centre_) * e,
                       {along * e.x * e.x + across * e.y * e.y, turned},
                       {turned, along * e.y * e.y + across * e.x * e.x}};
  }
  const auto& [near, far] = beam.planes_;
  beam.between_ = {0.5 * (near.foot + far.foot), 0.5 * (near.by_x + far.by_x),
                   0.5 * (near.by_y + far.by_y)};
  return beam;
}

bool PixelBeam::is_surrounded() const {
  const double r = interval_->outer, across = r * std::numbers::sqrt2 / 2;
  const Vec2 centre = centre_ * field_;
  for (const Vec2 rim : {Vec2{r, 0},
                         {across, across},
                         {0, r},
                         {-across, across},
                         {-r, 0},
                         {-across, -across},
                         {0, -r},
                         {across, -across}})
    if (!region_->holds(between_.at(centre + rim))) return false;
  return true;
}

bool PixelBeam::may_meet(Vec2 pixel) const {
  if (region_->holds(between_.at(pixel))) return true;
  const Vec2 at[2]{planes_[0].at(pixel), planes_[1].at(pixel)};
  const Vec2 v = pixel - centre_ * field_;
  const double to_unit = 1 / interval_->outer, d = std::sqrt(dot(v, v));
  // The rings around the pixel.
  constexpr double kLast = PixelBeams::kRings - 1;
  const auto ring = [&](double distance) {
    return static_cast<std::size_t>(std::clamp(distance * to_unit * kLast, 0.0, kLast));
  };
  double radius = 0;
  const std::size_t outermost = std::min(ring(d + half_) + 1, interval_->radii.size() - 1);
  for (std::size_t r = ring(d - half_); r <= outermost; ++r)
    radius = std::max(radius, interval_->radii[r]);
  return region_->meets(at, radius);
}

}  // namespace plenoflame
