#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plenoflame/base/units.h"
#include "plenoflame/camera/pupil_filters.h"
#include "plenoflame/radiometry/filter_points.h"
#include "plenoflame/scene/spectral.h"
#include "scene/schema/nearest.h"
#include "scene/validation/issues.h"

namespace plenoflame {
namespace {

constexpr double kNothing = 1e-5;  ///< of the stop's area

std::string path_of(std::size_t i) {
  return fmt::format("camera.pupil_filters[{}]", i);
}

std::string in_words(const PupilFilterSpec& filter, std::size_t i) {
  return filter.name.empty() ? fmt::format("pupil filter {}", i)
                             : "pupil filter " + quote_for_message(filter.name);
}

/// Tells whether the corners go around a convex figure, one way or the other.
bool is_convex(const std::vector<Vec2>& corners) {
  const std::size_t n = corners.size();
  int left = 0, right = 0;
  double turned = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 a = corners[(i + 1) % n] - corners[i];
    const Vec2 b = corners[(i + 2) % n] - corners[(i + 1) % n];
    const double cross = a.x * b.y - a.y * b.x;
    if (cross > 0) ++left;
    if (cross < 0) ++right;
    if (cross == 0) return false;
    turned += std::atan2(cross, dot(a, b));
  }
  return (left == 0 || right == 0) && std::fabs(turned) < 7;  // once around, not twice
}

/// @return whether the filter is sound by itself
bool check_filter(const PupilFilterSpec& filter, std::size_t i, Issues& issues) {
  const std::size_t errors = issues.errors();
  const std::string path = path_of(i), what = in_words(filter, i);
  if (filter.shape == PupilPartShape::sector && !(filter.inner < filter.outer))
    issues.error_among(
        {path + ".inner", path + ".outer"},
        fmt::format(
            "{} reaches from {:g} to {:g} radii of the stop; its outer radius must be larger", what,
            filter.inner, filter.outer));
  if (filter.shape == PupilPartShape::polygon && filter.corners.size() < 3)
    issues.error_among({path + ".corners", path + ".shape"},
                       what + " is a polygon and needs three corners or more");
  else if (filter.shape == PupilPartShape::polygon && !is_convex(filter.corners))
    issues.error(path + ".corners",
                 what +
                     " is not convex, or its corners are not listed around it; split it into "
                     "convex filters with the same transmission");
  if (!filter.transmission.empty())
    issues.expect(path + ".transmission", path + ".transmission",
                  [&] { static_cast<void>(parse_filter_points(filter.transmission)); });
  if (issues.errors() != errors) return false;
  if (PupilFilters({filter}).areas().front() < kNothing)
    issues.error_among({path + ".corners", path + ".inner", path},
                       what + " lies outside of the stop, whose radius is 1, and covers nothing");
  return issues.errors() == errors;
}

}  // namespace

void check_pupil_filters(const Scene& scene, Issues& issues) {
  const std::vector<PupilFilterSpec>& filters = scene.camera.pupil_filters;
  bool sound = true;
  for (std::size_t i = 0; i < filters.size(); ++i)
    sound = check_filter(filters[i], i, issues) && sound;
  for (std::size_t i = 0; i < filters.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (!filters[i].name.empty() && filters[i].name == filters[k].name)
        issues.error(path_of(i) + ".name",
                     fmt::format("pupil filters {} and {} are both named {}; names must differ", k,
                                 i, quote_for_message(filters[i].name)));
  if (!sound || filters.empty()) return;
  for (std::size_t i = 0; i < filters.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (overlap(filters[i], filters[k]))
        issues.error_among(
            {path_of(i) + ".angle", path_of(i) + ".extent", path_of(i) + ".corners",
             path_of(i) + ".inner", path_of(i) + ".outer", path_of(i)},
            fmt::format("{} and {} overlap; a part of the stop can have one filter only",
                        in_words(filters[k], k), in_words(filters[i], i)));
  if (issues.errors() > 0) return;
  // Something is left of each channel, through one part or another, unless the stop is opaque.
  if (PupilFilters(filters).areas().back() > kNothing) return;
  std::vector<std::size_t> dark;
  for (std::size_t c = 0; c < scene.channels.size(); ++c) {
    const ChannelSpec& channel = scene.channels[c];
    if (channel.kind == ChannelKind::curve && channel.curve.empty()) continue;
    const bool seen =
        std::any_of(filters.begin(), filters.end(), [&](const PupilFilterSpec& filter) {
          try {
            static_cast<void>(camera_response(scene, channel, filter.transmission));
            return true;
          } catch (const InputError&) {
            return false;  // not through this one
          }
        });
    if (!seen) dark.push_back(c);
  }
  for (const std::size_t c : dark) {
    const std::string path = fmt::format("channels[{}].kind", c);
    const std::string what =
        "no pupil filter transmits light of channel " + quote_for_message(scene.channels[c].name);
    if (dark.size() == scene.channels.size())
      issues.warning(path, what + ", so its picture is black");
    else
      issues.error(path, what);
  }
}

}  // namespace plenoflame
