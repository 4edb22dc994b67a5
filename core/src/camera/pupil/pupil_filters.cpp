#include "plenoflame/camera/pupil_filters.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr int kOverlapRaster = 400;  ///< points along a radius
constexpr int kAreaRaster = 400;

double cross(Vec2 a, Vec2 b) {
  return a.x * b.y - a.y * b.x;
}

bool in_sector(const PupilFilterSpec& filter, Vec2 point, double margin) {
  const double radius = length(point);
  if (!(radius >= filter.inner + margin && radius <= filter.outer - margin)) return false;
  if (filter.extent <= 0 || filter.extent >= 2 * constants::pi) return true;
  double turned = std::fmod(std::atan2(point.y, point.x) - filter.angle, 2 * constants::pi);
  if (turned < 0) turned += 2 * constants::pi;
  const double room = margin > 0 ? margin / radius : 0;
  return turned >= room && turned <= filter.extent - room;
}

bool in_polygon(const std::vector<Vec2>& corners, Vec2 point, double margin) {
  // The polygon is convex, in either orientation of its corners.
  int left = 0, right = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 side = corners[(i + 1) % corners.size()] - corners[i];
    const double off = cross(side, point - corners[i]) / length(side);
    if (off > -margin && off < margin) return false;
    (off >= 0 ? left : right) += 1;
    if (off == 0 && margin == 0) right += 1;
  }
  const int sides = static_cast<int>(corners.size());
  return left == sides || right >= sides;
}

}  // namespace

bool covers(const PupilFilterSpec& filter, Vec2 point, double margin) {
  return filter.shape == PupilPartShape::sector ? in_sector(filter, point, margin)
                                                : in_polygon(filter.corners, point, margin);
}

bool overlap(const PupilFilterSpec& a, const PupilFilterSpec& b) {
  constexpr double kStep = 1.0 / kOverlapRaster;
  for (int i = -kOverlapRaster; i <= kOverlapRaster; ++i)
    for (int j = -kOverlapRaster; j <= kOverlapRaster; ++j) {
      const Vec2 point{kStep * i, kStep * j};
      if (length(point) <= 1 && covers(a, point, 1e-9) && covers(b, point, 1e-9)) return true;
    }
  return false;
}

int PupilFilters::part_at(Vec2 point) const {
  for (std::size_t i = 0; i < filters_.size(); ++i)
    if (covers(filters_[i], point)) return static_cast<int>(i);
  return static_cast<int>(filters_.size());
}

std::vector<double> PupilFilters::areas() const {
  std::vector<double> areas(static_cast<std::size_t>(parts()));
  double all = 0;
  for (int i = -kAreaRaster; i < kAreaRaster; ++i)
    for (int j = -kAreaRaster; j < kAreaRaster; ++j) {
      const Vec2 point{(i + 0.5) / kAreaRaster, (j + 0.5) / kAreaRaster};
      if (length(point) > 1) continue;
      areas[static_cast<std::size_t>(part_at(point))] += 1;
      all += 1;
    }
  for (double& area : areas) area /= all;
  return areas;
}

std::string PupilFilters::name(int part) const {
  const auto i = static_cast<std::size_t>(part);
  if (i >= filters_.size()) return "open";
  return filters_[i].name.empty() ? "filter " + std::to_string(part) : filters_[i].name;
}

std::vector<Vec2> parse_corners(std::string_view text) {
  std::vector<Vec2> corners;
  const auto fail = [&] {
    throw InputError(
        "corners are pairs of numbers with commas between them, in radii of the stop, as in "
        "\"0 0, 1 0, 1 1\"");
  };
  const char *at = text.data(), *const end = text.data() + text.size();
  const auto skip = [&] {
    while (at < end && (*at == ' ' || *at == '\t')) ++at;
  };
  const auto number = [&] {
    skip();
    double value = 0;
    if (at < end && *at == '+') ++at;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value)) fail();
    at = next;
    return value;
  };
  skip();
  while (at < end) {
    const double x = number();
    const double y = number();
    corners.push_back({x, y});
    skip();
    if (at == end) break;
    if (*at != ',') fail();
    ++at;
    skip();
    if (at == end) fail();
  }
  return corners;
}

std::string format_corners(const std::vector<Vec2>& corners) {
  std::string text;
  for (const Vec2 corner : corners)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", corner.x, corner.y);
  return text;
}

}  // namespace plenoflame
