#include "calibration/board_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr double kAlone = 0.98;      ///< least share of one microlens in the light of a pixel
constexpr double kLeastWhite = 0.3;  ///< share of white light below which pixels say nothing

MicroImages::Line difference(const MicroImages::Line& a, const MicroImages::Line& b) {
  return {a.position - b.position, a.slope - b.slope};
}

/// White light of a micro-image over the distance from its centre.
struct WhiteProfile {
  static constexpr double kStep = 0.25;  ///< [pixel]
  std::vector<double> values;
  WhiteProfile(const MarkFinder& finder, const MicroView& see) {
    MicroView straight = see;
    straight.lens = see.centre;
    do {
      const double r = kStep * static_cast<double>(values.size());
      values.push_back(finder.white(straight, see.centre + Vec2{r, 0}));
    } while (values.back() > 0);
  }
  double reach() const { return kStep * static_cast<double>(values.size() - 1); }
  double operator()(double r) const {
    const double at = r / kStep;
    const auto k = static_cast<std::size_t>(at);
    if (k + 1 >= values.size()) return 0;
    const double t = at - static_cast<double>(k);
    return (1 - t) * values[k] + t * values[k + 1];
  }
};

}  // namespace

BoardViews::BoardViews(const Image& light, const Image& white, const CameraSpec& spec, bool dots,
                       const Execution& execution)
    : camera_(spec), micro_(camera_, false, execution) {
  const SensorSpec& sensor = spec.sensor;
  if (light.width != sensor.columns || light.height != sensor.rows)
    throw InputError(fmt::format("the picture has {} x {} pixels, the camera's sensor {} x {}",
                                 light.width, light.height, sensor.columns, sensor.rows));
  divide(light, white);
  finder_.emplace(even_, dots, camera_.aperture(), sensor.pixel());
}

/// Finds the micro-images, and divides their light by white light where they are alone.
void BoardViews::divide(const Image& light, const Image& white) {
  const float nothing = std::numeric_limits<float>::quiet_NaN();
  even_ = Image(light.width, light.height);
  std::fill(even_.pixels.begin(), even_.pixels.end(), nothing);
  const Vec2 corner = camera_.sensor_point(0, 0);
  const Vec2 pixel = camera_.spec().sensor.pixel();
  const MarkFinder finder(even_, false, camera_.aperture(), pixel);
  std::vector<WhiteProfile> profiles;
  for (const LensIndex lens : camera_.lattice().within(-1.0 * corner, corner)) {
    LensView view;
    view.lens = lens;
    view.place = micro_.place(lens);
    if (view.place.dark || !look(view)) continue;
    const WhiteProfile& profile = profiles.emplace_back(finder, view.see);
    const double most = 0.5 * micro_.spacing() / pixel.x;
    while (view.see.visible < most && profile(view.see.visible) > kLeastWhite * profile(0))
      view.see.visible += WhiteProfile::kStep;
    views_.push_back(view);
  }
  const auto for_pixels = [&](double reach, const MicroView& see, const auto& use) {
    const Vec2 c = see.centre;
    for (int y = std::max(0, static_cast<int>(c.y - reach));
         y < std::min(light.height, static_cast<int>(c.y + reach) + 1); ++y)
      for (int x = std::max(0, static_cast<int>(c.x - reach));
           x < std::min(light.width, static_cast<int>(c.x + reach) + 1); ++x)
        if (const double r = length(Vec2{x + 0.5, y + 0.5} - c); r < reach) use(x, y, r);
  };
  Image total(light.width, light.height);
  for (std::size_t k = 0; k < views_.size(); ++k)
    for_pixels(profiles[k].reach(), views_[k].see, [&](int x, int y, double r) {
      total.at(x, y) += static_cast<float>(profiles[k](r));
    });
  for (std::size_t k = 0; k < views_.size(); ++k) {
    const MicroView& see = views_[k].see;
    for_pixels(see.visible, see, [&](int x, int y, double r) {
      const double own = profiles[k](r);
      if (own < kAlone * static_cast<double>(total.at(x, y))) return;
      const Vec2 tangent = (1 / see.distance) * (Vec2{x + 0.5, y + 0.5} - see.lens),
                 straight = (r / see.distance) * Vec2{1, 0};
      const double tilt = (1 + dot(straight, straight)) / (1 + dot(tangent, tangent));
      even_.at(x, y) =
          light.at(x, y) / (white.empty() ? static_cast<float>(own * tilt * tilt) : white.at(x, y));
    });
  }
}

/// Traces the rays of a microlens. @return false where light does not pass
bool BoardViews::look(LensView& view) const {
  const Vec2 pixel = camera_.spec().sensor.pixel(), s = view.place.centre;
  const Vec3 middle = camera_.lens_place(view.lens);
  view.at_lens = {middle.x, middle.y};
  const Vec2 beside = view.at_lens + Vec2{pixel.x, 0};
  const auto [x, y] = camera_.image_point(s);
  view.see.centre = {x, y};
  const auto [lens_x, lens_y] = camera_.image_point(view.at_lens);
  view.see.lens = {lens_x, lens_y};
  view.see.distance = (middle.z - camera_.sensor()) / pixel.x;
  view.see.radius = view.place.radius / pixel.x;
  view.middle = micro_.chief_ray(view.place, s);
  view.beside = difference(micro_.chief_ray(view.place, s + Vec2{pixel.x, 0}), view.middle);
  const auto line_through = [&](Vec2 aim) -> std::optional<MicroImages::Line> {
    const Camera::Path path = camera_.trace(s, view.lens, aim);
    if (path.status.status != RayStatus::reached) return std::nullopt;
    const Vec3 o = path.exit.origin, d = path.exit.direction;
    const Vec2 slope{d.x / d.z, d.y / d.z};
    return MicroImages::Line{Vec2{o.x, o.y} - o.z * slope, slope};
  };
  const auto here = line_through(view.at_lens), there = line_through(beside);
  const auto stop = camera_.at_stop(s, view.lens, view.at_lens),
             stop_beside = camera_.at_stop(s, view.lens, beside),
             stop_shifted = camera_.at_stop(s + Vec2{pixel.x, 0}, view.lens, view.at_lens);
  if (!here || !there || !stop || !stop_beside || !stop_shifted) return false;
  view.beside_lens = difference(*there, *here);
  view.see.stop = -(stop_beside->x - stop->x) / (stop_shifted->x - stop->x);
  return true;
}

SeenMark BoardViews::seen_at(std::size_t view, const BoardMark& mark) const {
  const LensView& through = views_[view];
  const Vec2 s = camera_.sensor_point(mark.pixel.x, mark.pixel.y);
  const MicroImages::Line line = micro_.chief_ray(through.place, s);
  const Vec2 right{camera_.spec().sensor.pixel().x, 0};
  return {view, through.lens, mark, line,
          difference(micro_.chief_ray(through.place, s + right), line)};
}

double BoardViews::in_focus() const {
  const double f = camera_.lens_first_order().focal_length;
  const double z = 1 / (1 / f - 1 / camera_.lens_distance());
  return z > 0 && std::isfinite(z) ? z : 1e3 * f;
}

std::string BoardViews::where_seen(double cell) const {
  constexpr double kLeast = 6;  // pixels
  // A pixel's width at a distance grows from 0 in the plane in focus on.
  const double focus = in_focus(), pixel = length(views_[views_.size() / 2].beside.slope);
  const double reach = cell / (kLeast * pixel);
  return fmt::format(
      "squares of {:.3g} mm have {:g} pixels at {:.3g} m and at {:.3g} m, and more towards the "
      "plane in focus at {:.3g} m",
      1e3 * cell, kLeast, std::max(0.0, focus - reach), focus + reach, focus);
}

Vec2 BoardViews::pixel_of(const LensView& view, Vec3 point) const {
  const Vec2 per_pixel = at_depth(view.beside, point.z), size = camera_.spec().sensor.pixel();
  const double scale = size.x / per_pixel.x;
  Vec2 s = view.place.centre;
  MicroImages::Line line = view.middle;
  for (int step = 0; step < 3; ++step) {
    s = s + scale * (Vec2{point.x, point.y} - at_depth(line, point.z));
    const auto [x, y] = camera_.image_point(s);
    if (length(Vec2{x, y} - view.see.centre) > 1.5 * view.see.radius) return {x, y};
    if (step < 2) line = micro_.chief_ray(view.place, s);
  }
  const auto [x, y] = camera_.image_point(s);
  return {x, y};
}

}  // namespace plenoflame
