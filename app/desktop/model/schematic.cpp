#include "model/schematic.h"

#include <algorithm>

namespace plenoflame::desktop {

Schematic::Schematic(const Vec3& origin, const Vec3& axis, std::vector<std::array<double, 2>> parts,
                     double longest)
    : origin_(origin), axis_(axis) {
  parts.push_back({0, 0});  // the origin stays
  std::sort(parts.begin(), parts.end());
  double end = parts.front()[1];
  for (const auto& part : parts) {
    if (part[0] - end > longest) gaps_.push_back({end, part[0], 0, 0});
    end = std::max(end, part[1]);
  }
  // A gap holds all of its shortening: what lies beyond it is moved by as much.
  double moved = 0;
  for (auto gap = gaps_.rbegin(); gap != gaps_.rend(); ++gap) {  // behind the origin
    if (gap->end > 0) continue;
    gap->drawn_end = gap->end + moved;
    moved += gap->end - gap->begin - longest;
    gap->drawn_begin = gap->begin + moved;
  }
  moved = 0;
  for (Gap& gap : gaps_) {
    if (gap.end <= 0) continue;
    gap.drawn_begin = gap.begin - moved;
    moved += gap.end - gap.begin - longest;
    gap.drawn_end = gap.end - moved;
  }
}

double Schematic::drawn(double along) const {
  double to = along;
  for (const Gap& gap : gaps_) {
    const double share = std::clamp((along - gap.begin) / (gap.end - gap.begin), 0.0, 1.0);
    const double lost = (gap.end - gap.begin) - (gap.drawn_end - gap.drawn_begin);
    to += gap.end <= 0 ? (1 - share) * lost : -share * lost;
  }
  return to;
}

Vec3 Schematic::place(const Vec3& world) const {
  if (is_to_scale()) return world;
  const double along = dot(world - origin_, axis_);
  return world + (drawn(along) - along) * axis_;
}

std::vector<Vec3> Schematic::line(const Vec3& from, const Vec3& to) const {
  const double begin = dot(from - origin_, axis_), end = dot(to - origin_, axis_);
  std::vector<double> shares;
  for (const Gap& gap : gaps_)
    for (const double corner : {gap.begin, gap.end})
      if ((corner - begin) * (corner - end) < 0) shares.push_back((corner - begin) / (end - begin));
  std::sort(shares.begin(), shares.end());
  shares.push_back(1);
  std::vector<Vec3> points;
  for (const double share : shares) points.push_back(place(from + share * (to - from)));
  return points;
}

}  // namespace plenoflame::desktop
