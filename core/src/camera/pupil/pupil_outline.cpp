#include "camera/pupil/pupil_outline.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

/// Length without the overflow guards of hypot. Squares of micrometres stay in the range of
/// numbers, and hypot takes a tenth of the time of the tables.
double quick_length(Vec2 v) {
  return std::sqrt(dot(v, v));
}

constexpr int kScan = 32;        ///< distances sampled along an azimuth
constexpr int kBisections = 10;  ///< halvings of a step between two of them
/// Radii of the rings, as shares of the disc's radius.
constexpr double kRingRadii[] = {0.2, 0.4, 0.6, 0.75, 0.88, 0.95, 1.0};
constexpr double kSlack = 0.001;  ///< share of the bound by which ends are moved outwards

/// From coordinates along and across an azimuth.
Vec2 turned(Vec2 v, Vec2 e) {
  return {v.x * e.x - v.y * e.y, v.x * e.y + v.y * e.x};
}

}  // namespace

PupilOutline::PupilOutline(PupilTracer& open, double h, double centre, double range,
                           const ApertureDiscs& discs)
    : centre_(centre), discs_(discs) {
  points_[0] = {};
  for (std::size_t i = 1; i < kPoints; ++i) {
    const double r = kRingRadii[(i - 1) / kSpokes];
    const double angle = 2 * constants::pi * static_cast<double>((i - 1) % kSpokes) / kSpokes;
    points_[i] = {r * std::cos(angle), r * std::sin(angle)};
  }
  for (std::size_t j = 0; j < PupilCuts::kAzimuths; ++j) {
    const double angle = constants::pi * static_cast<double>(j) / (PupilCuts::kAzimuths - 1);
    directions_[j] = {std::cos(angle), std::sin(angle)};
  }
  for (int azimuth = 0; azimuth < PupilCuts::kAzimuths; ++azimuth) {
    while (!search(open, h, azimuth, range)) range *= 1.5;
    const Grid& grid = grids_[static_cast<std::size_t>(azimuth)];
    double opens = kInfinity, closes = 0;
    for (std::size_t i = 0; i < kPoints; ++i) {
      const Interval& interval = grid[i];
      const bool some = interval.out >= interval.in;
      opens = std::min(opens, some && interval.in <= 0 ? interval.out : 0.0);
      double& end = ends_[static_cast<std::size_t>(azimuth)][i];
      end = some ? last_inside(azimuth, i) : 0;
      closes = std::max(closes, end);
    }
    opens_[static_cast<std::size_t>(azimuth)] = opens;
    closes_[static_cast<std::size_t>(azimuth)] = closes;
    if (closes > 0) dark_ = false;
  }
}

Vec2 PupilOutline::sensor_point(int azimuth, double distance) const {
  return Vec2{centre_, 0} + distance * directions_[static_cast<std::size_t>(azimuth)];
}

/// A point of the grid in the aim plane, in coordinates along and across the azimuth [m].
Vec2 PupilOutline::aim(int azimuth, double distance, std::size_t i) const {
  const Vec2 e = directions_[static_cast<std::size_t>(azimuth)],
             s = sensor_point(azimuth, distance);
  return discs_.far_centre({dot(s, e), s.y * e.x - s.x * e.y}) + discs_.radius_at(s) * points_[i];
}

/// Tells whether rays within the interval of a point also count for the reach of beams. Zones of a
/// lens focus at different distances. The points are the disc's middle, its edge and a ring inside.
bool PupilOutline::bounds_beam(std::size_t i) {
  const std::size_t ring = (i - 1) / kSpokes;
  return i == 0 || ring == 4 || ring == 6;
}

/// Fills one grid. @return false when a ray passes at the largest distance that was sampled
bool PupilOutline::search(PupilTracer& open, double h, int azimuth, double range) {
  const Vec2 e = directions_[static_cast<std::size_t>(azimuth)];
  Grid& grid = grids_[static_cast<std::size_t>(azimuth)];
  std::array<Vec2, kPoints> points;  // of the unit disc
  for (std::size_t i = 0; i < kPoints; ++i) points[i] = turned(points_[i], e);
  const auto request = [&](std::size_t i, double distance) {
    const Vec2 s = Vec2{centre_, 0} + distance * e;
    return PupilTracer::Request{s, discs_.far_centre(s) + discs_.radius_at(s) * points[i]};
  };
  const auto distance_of = [range](std::size_t k) {
    return range * static_cast<double>(k) / kScan;
  };
  std::vector<PupilTracer::Request> requests;
  for (std::size_t i = 0; i < kPoints; ++i)
    for (std::size_t k = 0; k <= kScan; ++k) requests.push_back(request(i, distance_of(k)));
  std::array<int, kPoints> first, last;
  first.fill(-1);
  last.fill(-1);
  std::vector<Ray> within;
  open.trace(h, requests, [&](std::size_t index, bool passes, const Ray& ray) {
    if (!passes) return;
    const std::size_t i = index / (kScan + 1);
    const int k = static_cast<int>(index % (kScan + 1));
    if (first[i] < 0) first[i] = k;
    last[i] = k;
    if (bounds_beam(i) && k % 2 == 0) within.push_back(ray);
  });
  if (*std::max_element(last.begin(), last.end()) == kScan) return false;
  beam_rays_.insert(beam_rays_.end(), within.begin(), within.end());
  // Both ends of every interval, between the last passing point and the first blocked one.
  struct End {
    std::size_t point;
    bool outer;
    double passes, stops;
    Ray ray;
  };
  std::vector<End> ends;
  for (std::size_t i = 0; i < kPoints; ++i) {
    grid[i] = {};
    if (first[i] < 0) continue;
    const double begin = distance_of(static_cast<std::size_t>(first[i])),
                 end = distance_of(static_cast<std::size_t>(last[i]));
    const double step = range / kScan;
    grid[i] = {begin, end};
    ends.push_back({i, true, end, end + step, {}});
    if (first[i] > 0) ends.push_back({i, false, begin, begin - step, {}});
  }
  for (int halving = 0; halving < kBisections; ++halving) {
    requests.clear();
    for (const End& end : ends)
      requests.push_back(request(end.point, 0.5 * (end.passes + end.stops)));
    open.trace(h, requests, [&](std::size_t index, bool passes, const Ray& ray) {
      End& end = ends[index];
      (passes ? end.passes : end.stops) = 0.5 * (end.passes + end.stops);
      if (passes) end.ray = ray;
    });
  }
  for (const End& end : ends) {
    (end.outer ? grid[end.point].out : grid[end.point].in) = end.stops;
    if (end.outer && end.ray.direction.z != 0) beam_rays_.push_back(end.ray);
  }
  return true;
}

/// The largest distance in a point's interval at which the point is also inside the bound [m].
double PupilOutline::last_inside(int azimuth, std::size_t i) const {
  const Interval& interval = grids_[static_cast<std::size_t>(azimuth)][i];
  const auto inside = [&](double distance) {
    return quick_length(aim(azimuth, distance, i)) <= discs_.bound;
  };
  if (inside(interval.out)) return interval.out;
  double lo = interval.in, hi = interval.out;
  if (!inside(lo)) return 0;
  for (int k = 0; k < 30; ++k) {
    const double middle = 0.5 * (lo + hi);
    (inside(middle) ? lo : hi) = middle;
  }
  return hi;
}

PupilCut PupilOutline::cut(int azimuth, double distance) const {
  const Grid& grid = grids_[static_cast<std::size_t>(azimuth)];
  std::array<bool, kPoints> member;
  std::array<double, kPoints> inside;
  std::array<Vec2, kPoints> aims;
  std::vector<Vec2> outline;
  for (std::size_t i = 0; i < kPoints; ++i) {
    aims[i] = aim(azimuth, distance, i);
    inside[i] = discs_.bound - quick_length(aims[i]);
    member[i] = inside[i] > 0 && grid[i].in <= distance && distance <= grid[i].out;
    if (member[i]) outline.push_back(aims[i]);
  }
  // The place where an edge of the grid leaves the open region: the nearest of the three limits.
  const auto cross = [&](std::size_t a, std::size_t b) {
    if (member[a] == member[b]) return;
    if (member[b]) std::swap(a, b);
    double way = 1;
    if (grid[b].out >= grid[b].in) {
      if (grid[b].out < distance)
        way = std::min(way, (grid[a].out - distance) / (grid[a].out - grid[b].out));
      if (grid[b].in > distance)
        way = std::min(way, (distance - grid[a].in) / (grid[b].in - grid[a].in));
    }
    if (inside[b] <= 0) way = std::min(way, inside[a] / (inside[a] - inside[b]));
    const Vec2 p = aims[a], q = aims[b];
    outline.push_back(p + way * (q - p));
  };
  for (std::size_t ring = 0; ring < kRings; ++ring)
    for (std::size_t spoke = 0; spoke < kSpokes; ++spoke) {
      const std::size_t here = 1 + ring * kSpokes + spoke;
      cross(here, ring == 0 ? 0 : here - kSpokes);
      cross(here, 1 + ring * kSpokes + (spoke + 1) % kSpokes);
    }
  const double bound = discs_.bound;
  if (outline.empty()) {  // nearly closed: the point that closes last
    std::size_t last = 0;
    for (std::size_t i = 1; i < kPoints; ++i)
      if (grid[i].out > grid[last].out) last = i;
    outline.push_back(aims[last]);
  }
  double low = kInfinity, high = -kInfinity;
  for (const Vec2 p : outline) {
    low = std::min(low, p.x);
    high = std::max(high, p.x);
  }
  low = std::max(low - kSlack * bound, -bound);
  high = std::min(high + kSlack * bound, bound);
  double low_far = -bound, high_far = bound;
  for (const Vec2 p : outline) {
    const double from_low = std::max(p.x - low, 1e-6 * bound),
                 from_high = std::max(high - p.x, 1e-6 * bound);
    low_far = std::max(low_far, p.x + p.y * p.y / from_low);
    high_far = std::min(high_far, p.x - p.y * p.y / from_high);
  }
  const double limit = 100 * bound;
  return {static_cast<float>(-low), static_cast<float>(high),
          static_cast<float>(std::min(limit, low_far + kSlack * (low_far - low))),
          static_cast<float>(std::min(limit, -high_far + kSlack * (high - high_far)))};
}

void PupilOutline::fill_cuts(PupilCuts& cuts) const {
  const auto bound = static_cast<float>(discs_.bound);
  for (std::size_t j = 0; j < PupilCuts::kAzimuths; ++j) {
    PupilColumn& column = cuts.columns[j];
    // Until the stop begins to cut, the aperture may be anywhere in its bound.
    column.cuts[0] = {bound, bound, bound, bound};
    const double opens = static_cast<double>(column.opens),
                 closes = static_cast<double>(column.closes);
    for (std::size_t k = 1; k <= PupilColumn::kSteps; ++k) {
      const double part = static_cast<double>(k) / PupilColumn::kSteps;
      const double distance = std::min(opens + part * (closes - opens), closes_[j]);
      column.cuts[k] = cut(static_cast<int>(j), distance);
    }
    // At the end of vignetting almost nothing is open, and the fitted circles are unreliable.
    for (const std::size_t side : {2u, 3u})
      column.cuts.back()[side] =
          std::max(column.cuts.back()[side], column.cuts[PupilColumn::kSteps - 1][side]);
  }
}

double PupilOutline::opened(double distance) const {
  double seen = 0, all = 0;
  for (std::size_t azimuth = 0; azimuth < PupilCuts::kAzimuths; ++azimuth) {
    const bool end = azimuth == 0 || azimuth == PupilCuts::kAzimuths - 1;
    for (std::size_t i = 0; i < kPoints; ++i) {
      const std::size_t ring = i == 0 ? 0 : (i - 1) / kSpokes;
      const double outer =
          ring + 1 < kRings ? 0.5 * (kRingRadii[ring] + kRingRadii[ring + 1]) : 1.0;
      const double inner =
          ring > 0 ? 0.5 * (kRingRadii[ring] + kRingRadii[ring - 1]) : 0.5 * kRingRadii[0];
      const double area = i == 0 ? inner * inner * kSpokes : outer * outer - inner * inner;
      const double weight = area * (end ? 0.5 : 1.0);
      all += weight;
      const double from = std::max(grids_[azimuth][i].in, 0.0);
      seen += weight * std::max(std::min(distance, ends_[azimuth][i]) - from, 0.0);
    }
  }
  return seen / all;
}

}  // namespace plenoflame
