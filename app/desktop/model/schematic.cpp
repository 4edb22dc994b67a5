#include "model/schematic.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/camera/camera.h"

namespace plenoflame::desktop {
namespace {

constexpr double kGapShare = 0.8;      ///< of a drawn gap, in sizes of what is beside the axis
constexpr double kMarginShare = 0.08;  ///< around each part, of the same
constexpr double kRoomShare = 1.3;     ///< between the axes of two cameras, in their widths
constexpr double kGapGrowth = 1.3;     ///< of the gaps, until there is room

/// The things before a camera, seen along its axis.
struct Before {
  std::vector<std::array<double, 2>> stretches;  ///< [m] from the camera
  double size = 0;                               ///< [m] of the widest, across the axis
  bool ahead = true;                             ///< all of them are
};

Before things_before(const CameraOnAxis& camera, const std::vector<ThingSeen>& things) {
  Before before;
  for (const ThingSeen& thing : things) {
    std::array<double, 2> stretch{1e300, -1e300};
    double size = 0;
    for (const Vec3& corner : thing.corners) {
      const Vec3 way = corner - camera.position;
      const double along = dot(way, camera.axis);
      stretch = {std::min(stretch[0], along), std::max(stretch[1], along)};
      size = std::max(size, 2 * length(way - along * camera.axis));
    }
    if (stretch[0] > stretch[1]) continue;
    if (thing.flat && stretch[1] - stretch[0] > 0.5 * size) continue;
    before.ahead &= stretch[0] > 0;
    before.stretches.push_back(stretch);
    if (!thing.flat) before.size = std::max(before.size, size);
  }
  return before;
}

/// @param gap [sizes] that empty stretches have @param stay the things do, and not the camera
Schematic shortened_axis(const CameraOnAxis& camera, const Before& before, double gap, bool stay) {
  if (!before.ahead || (stay && before.stretches.empty())) return {};
  const double size = std::max(camera.width, before.size), margin = kMarginShare * size;
  std::vector<std::array<double, 2>> parts = before.stretches;
  double origin = 0;
  if (stay) {  // all that stands between the first and the last thing
    std::array<double, 2> whole = parts.front();
    for (const auto& part : parts)
      whole = {std::min(whole[0], part[0]), std::max(whole[1], part[1])};
    parts = {whole};
    origin = 0.5 * (whole[0] + whole[1]);
  }
  parts.push_back({camera.lens_back, 0});
  parts.push_back({camera.sensor, camera.array_front});
  for (auto& part : parts) part = {part[0] - margin - origin, part[1] + margin - origin};
  return {camera.position + origin * camera.axis, camera.axis, parts, gap * size};
}

/// True if no two cameras are drawn in each other's place; those that stay have the room they had.
bool have_room(const std::vector<CameraOnAxis>& cameras, const std::vector<Schematic>& drawings) {
  for (std::size_t i = 0; i < cameras.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      if (drawings[i].is_to_scale() && drawings[k].is_to_scale()) continue;
      const double apart =
          length(drawings[i].place(cameras[i].position) - drawings[k].place(cameras[k].position));
      if (apart < kRoomShare * std::max(cameras[i].width, cameras[k].width)) return false;
    }
  return true;
}

}  // namespace

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
  // A gap holds all of its shortening: things beyond it move by the same length.
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

CameraOnAxis::CameraOnAxis(const Camera& camera)
    : position(camera.spec().position),
      axis(normalize(camera.spec().look_direction)),
      sensor(camera.sensor()),
      width(std::max(camera.lens_first_order().entrance_pupil_diameter,
                     camera.spec().sensor.size().x)) {
  for (const SurfaceSpec& surface : camera.spec().lens.surfaces) lens_back -= surface.thickness;
  array_front = camera.spec().array.present ? camera.array_front() : sensor;
}

std::vector<Schematic> shortened_axes(const std::vector<CameraOnAxis>& cameras,
                                      const std::vector<ThingSeen>& things) {
  std::vector<Before> before;
  for (const CameraOnAxis& camera : cameras) before.push_back(things_before(camera, things));
  const bool several = cameras.size() > 1;
  std::vector<Schematic> drawings;
  for (double gap = kGapShare;; gap *= kGapGrowth) {
    drawings.clear();
    bool shortened = false;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      drawings.push_back(shortened_axis(cameras[i], before[i], gap, several));
      shortened |= !drawings.back().is_to_scale();
    }
    if (!several || !shortened || have_room(cameras, drawings)) return drawings;
  }
}

}  // namespace plenoflame::desktop
