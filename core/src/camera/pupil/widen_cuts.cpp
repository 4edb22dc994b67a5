#include "camera/pupil/widen_cuts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "camera/pupil/spread_points.h"
#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

constexpr int kEdgeBlocks = 4;      ///< of rays between two nodes, near the micro-image's edge
constexpr int kBlocks = 64;         ///< of rays between two nodes, over the whole micro-image
constexpr int kInsideBlocks = 24;   ///< the same inside of the cuts, where the series must hold
constexpr int kRaysTogether = 512;  ///< rays of one of these blocks
constexpr double kBeside = 0.02;    ///< share of the bound: distance of aim points outside of a cut
constexpr double kRoom = 1.2;       ///< factor on a missing length
constexpr double kMargin = 0.00075;    ///< share of the bound, for rays that were not traced
constexpr float kEdgeMargin = 0.002F;  ///< share of the cutoff distance of vignetting

/// Evenly spread numbers of [-1, 1], made denser towards the ends, where openings have corners.
double signed_root(double x) {
  return std::copysign(std::sqrt(std::fabs(x)), x);
}

/// Directions around the full circle.
class Circle {
 public:
  Circle() {
    for (std::size_t i = 0; i < kCount; ++i) {
      const double angle = 2 * constants::pi * (static_cast<double>(i) + 0.5) / kCount;
      directions_[i] = {std::cos(angle), std::sin(angle)};
    }
  }
  /// @param turn in [0, 1)
  Vec2 at(double turn) const { return directions_[static_cast<std::size_t>(turn * kCount)]; }

 private:
  static constexpr std::size_t kCount = 1024;
  std::array<Vec2, kCount> directions_;
};

/// The cuts of two neighbouring nodes, and cuts interpolated between them.
class Between {
 public:
  Between(PupilCuts& a, PupilCuts& b, double t)
      : a_(a), b_(b), cuts_(PupilCuts::mix(a, b, static_cast<float>(t))) {}
  const PupilCuts& cuts() const { return cuts_; }

  void widen_closes(const PupilCuts::Azimuth& azimuth, float by) {
    for (PupilCuts* table : {&a_, &b_, &cuts_})
      for (const int j : {azimuth.index, azimuth.index + 1})
        table->columns[static_cast<std::size_t>(j)].closes += by;
  }
  void widen(const PupilCuts::Azimuth& azimuth, float step, std::size_t side, float by) {
    const int k = std::min(static_cast<int>(step), PupilColumn::kSteps - 1);
    for (PupilCuts* table : {&a_, &b_, &cuts_})
      for (const int j : {azimuth.index, azimuth.index + 1}) {
        auto& cuts = table->columns[static_cast<std::size_t>(j)].cuts;
        cuts[static_cast<std::size_t>(k)][side] += by;
        cuts[static_cast<std::size_t>(k + 1)][side] += by;
      }
  }
  /// Widens the cuts to hold a passing ray at p and q. p counts from the end in question towards
  /// the other.
  void hold(const PupilCuts::Azimuth& azimuth, float step, std::size_t end, double p, double q,
            double bound) {
    const PupilCut cut = cuts_.at(azimuth).at(step);
    double from_end = p + static_cast<double>(cut[end]);
    double to_far = static_cast<double>(cut[end + 2]) - p;
    if (to_far < 1e-3 * bound) {
      const double by = kRoom * (1e-3 * bound - to_far);
      widen(azimuth, step, end + 2, static_cast<float>(by));
      to_far += by;
    }
    if (from_end >= 0 && from_end * to_far >= q * q) return;
    // Moves the end if the step is small, otherwise the far end of its circle.
    const double lacking = q * q / to_far - from_end;
    if (lacking < kBeside * bound || from_end < 1e-3 * bound) {
      const double by = kRoom * std::min(lacking, std::max(kBeside * bound, -from_end));
      widen(azimuth, step, end, static_cast<float>(by));
      from_end += by;
    }
    if (from_end * to_far < q * q)
      widen(azimuth, step, end + 2, static_cast<float>(kRoom * (q * q / from_end - to_far)));
  }

 private:
  PupilCuts &a_, &b_;
  PupilCuts cuts_;
};

/// The opening that a cut leaves, in coordinates along and across its line.
class Opening {
 public:
  explicit Opening(const PupilCut& cut)
      : low_(-static_cast<double>(cut[0])),
        high_(static_cast<double>(cut[1])),
        low_diameter_(static_cast<double>(cut[2]) - low_),
        high_diameter_(high_ + static_cast<double>(cut[3])) {}

  /// Half the extent across the line: the common part of two circles centred on the line.
  double half_width() const {
    const double a = 0.5 * low_diameter_, b = 0.5 * high_diameter_;
    if (!(a > 0 && b > 0)) return 0;
    const double from_a = low_ + a, from_b = high_ - b, apart = from_b - from_a;
    if (apart * apart + a * a <= b * b) return a;  // the top of one circle is inside the other
    if (apart * apart + b * b <= a * a) return b;
    const double foot = (apart * apart + a * a - b * b) / (2 * apart);
    return std::sqrt(std::max(0.0, a * a - foot * foot));
  }
  /// An aim point just outside, beside a point that is inside.
  double beside(double p, double q, double depth) const {
    const double low = low_at(q), high = high_at(q);
    if (p < low || p > high) return p;
    return p - low < high - p ? low - depth : high + depth;
  }
  double low_at(double q) const { return low_ + behind(low_diameter_, q); }
  double high_at(double q) const { return high_ - behind(high_diameter_, q); }

 private:
  /// For a circle between two ends on the line: its distance behind them at q.
  static double behind(double diameter, double q) {
    const double root = diameter * diameter - 4 * q * q;
    return root > 0 ? 2 * q * q / (diameter + std::sqrt(root)) : 0.5 * diameter;
  }
  double low_, high_, low_diameter_, high_diameter_;
};

}  // namespace

Crossed widen_pair(PupilTracer& own, const PupilTable& table, std::size_t i,
                   std::vector<PupilCuts>& cuts) {
  const Circle circle;
  SpreadPoints spread(i * (kEdgeBlocks + kBlocks) * kRaysTogether);
  std::vector<PupilTracer::Request> requests(kRaysTogether);
  const PupilNode &a = table.nodes[i], &b = table.nodes[i + 1];
  if (a.dark() || b.dark()) return {};
  double stop2 = 0, far2 = 0;
  const int inside_blocks = a.stop.known() && b.stop.known() ? kInsideBlocks : 0;
  for (int block = 0; block < kEdgeBlocks + kBlocks + inside_blocks; ++block) {
    const bool edge = block < kEdgeBlocks, inside = block >= kEdgeBlocks + kBlocks;
    const double t = edge     ? (block + 0.5) / kEdgeBlocks
                     : inside ? (block - kEdgeBlocks - kBlocks + 0.5) / kInsideBlocks
                              : (block - kEdgeBlocks + 0.5) / kBlocks;
    Between between(cuts[i], cuts[i + 1], t);
    const StopMap stop = StopMap::mix(a.stop, b.stop, t);
    const double centre = a.centre + t * (b.centre - a.centre);
    const double reach = std::max(a.outer_radius, b.outer_radius);
    // Every second ray is aimed at the opening itself, which may be small. An example is a
    // stopped-down lens seen through a microlens that is out of focus.
    bool close = false;
    for (PupilTracer::Request& request : requests) {
      spread.step();
      close = inside || !close;
      const double inner = edge ? 0.7 : 0.0, outer = edge ? 1.15 : 1.0;
      const double distance =
          reach * std::sqrt(inner * inner + spread[0] * (outer * outer - inner * inner));
      const double r = table.discs.bound * std::sqrt(spread[2]);
      const Vec2 e = circle.at(spread[1]), turn = circle.at(spread[3]);
      double p = r * turn.x, q = r * turn.y;
      if (!edge || close) {
        const ColumnBetween column = between.cuts().at(PupilCuts::azimuth(static_cast<float>(e.x)));
        const Opening opening(column.at(column.step_at(static_cast<float>(distance))));
        const double room = kBeside * table.discs.bound, away = spread[3] * spread[3];
        if (close) {
          q = signed_root(2 * spread[2] - 1) *
              std::min(opening.half_width() + room, table.discs.bound);
          const double low = opening.low_at(q), high = opening.high_at(q);
          const double part = 2 * spread[3] - 1;  // the side, and the distance beside it
          const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
          p = edge     ? middle + part * (half + room)
              : inside ? middle + std::cbrt(part) * half  // most of them close to the ends
                       : (part < 0 ? low + part * room : high + part * room);
        } else {  // the table already holds everything there
          p = opening.beside(p, q, away * room);
        }
      }
      request = {Vec2{centre, 0} + distance * e, {p * e.x - q * e.y, p * e.y + q * e.x}};
    }
    const double h = (static_cast<double>(i) + t) * table.field_step;
    own.trace(h, requests, [&](std::size_t index, bool passes, const Ray&) {
      if (!passes) return;
      const auto& [sensor, aim] = requests[index];
      const Vec2 at_face = table.at_far_face.at(sensor, aim);
      far2 = std::max(far2, dot(at_face, at_face));
      if (stop.known()) {
        const Vec2 at_stop = stop.at(table.at_pupil.at(sensor, aim));
        stop2 = std::max(stop2, dot(at_stop, at_stop));
      }
      const Vec2 w = requests[index].s - Vec2{centre, 0}, u = requests[index].u;
      const double distance = std::sqrt(dot(w, w));
      if (!(distance > 0)) return;
      const Vec2 e = (1 / distance) * w;
      const auto cosine = static_cast<float>(e.x), d = static_cast<float>(distance);
      const PupilCuts::Azimuth azimuth = PupilCuts::azimuth(cosine);
      const ColumnBetween column = between.cuts().at(azimuth);
      const double beyond = distance - static_cast<double>(column.closes());
      if (beyond > 0) between.widen_closes(azimuth, static_cast<float>(kRoom * beyond));
      if (edge) return;
      const double p = dot(u, e), q = u.y * e.x - u.x * e.y;
      const float step = column.step_at(d);
      between.hold(azimuth, step, 0, p, q, table.discs.bound);
      between.hold(azimuth, step, 1, -p, q, table.discs.bound);
    });
  }
  return {std::sqrt(stop2), std::sqrt(far2)};
}

void add_margin(const PupilTable& table, std::vector<PupilCuts>& cuts) {
  const auto margin = static_cast<float>(kMargin * table.discs.bound);
  for (PupilCuts& node : cuts)
    for (PupilColumn& column : node.columns) {
      column.closes += margin;
      for (PupilCut& cut : column.cuts)
        for (float& side : cut) side += margin;
    }
}

void add_edge_margin(std::vector<PupilCuts>& cuts) {
  for (PupilCuts& node : cuts)
    for (PupilColumn& column : node.columns)
      column = column.reaching((1 + kEdgeMargin) * column.closes);
}

}  // namespace plenoflame
