#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/units.h"
#include "plenoflame/optics/first_order.h"
#include "plenoflame/optics/surface_shape.h"
#include "plenoflame/optics/window_set.h"
#include "plenoflame/scene/cameras.h"
#include "scene/schema/nearest.h"
#include "scene/validation/issues.h"

namespace plenoflame {
namespace {

std::string readable(double length) {
  return readable_quantity(length, Dimension::length);
}

/// @return whether the window is a body
bool check_shape(const WindowSpec& window, const std::string& path, const std::string& what,
                 Issues& issues) {
  const std::size_t before = issues.errors();
  const bool flat = window.shape == WindowShape::plate || window.shape == WindowShape::wedge;
  if (flat) {
    if (!(window.diameter > 0) && !(window.extent.x > 0 && window.extent.y > 0))
      issues.error(path, what + " needs a diameter, or an extent of two sides, above 0 m");
    const double half = 0.5 * (window.diameter > 0 ? window.diameter : window.extent.y);
    if (window.shape == WindowShape::wedge && !(half * std::tan(window.angle) < window.thickness))
      issues.error_among(
          {path + ".angle", path + ".thickness"},
          fmt::format("{} is a wedge that is {} thick in its middle and thinner by {} at its edge; "
                      "it needs more thickness or a smaller angle",
                      what, readable(window.thickness), readable(half * std::tan(window.angle))));
  } else {
    if (!(window.radius > window.thickness))
      issues.error_among({path + ".radius", path + ".thickness"},
                         fmt::format("{} has an outer radius of {}, which must be above the "
                                     "thickness of its wall, {}",
                                     what, readable(window.radius), readable(window.thickness)));
    if (!(window.height > 0)) issues.error(path + ".height", what + " needs a height above 0 m");
    if (window.shape == WindowShape::dome && window.height > 2 * window.radius)
      issues.error(path + ".height",
                   fmt::format("{} is a dome of height {}, which is more than twice its radius, {}",
                               what, readable(window.height), readable(window.radius)));
  }
  const struct {
    bool used;
    double value;
    const char* key;
  } figures[] = {{flat, window.diameter, "diameter"},
                 {flat, std::max(window.extent.x, window.extent.y), "extent"},
                 {window.shape == WindowShape::wedge, window.angle, "angle"},
                 {!flat, window.radius, "radius"},
                 {!flat, window.height, "height"}};
  for (const auto& figure : figures)
    if (!figure.used && figure.value != 0)
      issues.warning(
          path + "." + figure.key,
          fmt::format("{} is of another shape, so its {} is not used", what, figure.key));
  return issues.errors() == before;
}

/// The main lens as its enclosing cylinder, in the world, with the least length of the camera
/// behind it. No image of objects in front is nearer than a focal length.
struct Barrel {
  explicit Barrel(const CameraSpec& camera) : vertex(camera.position) {
    axis = normalize(camera.look_direction);
    right = normalize(cross(-camera.up, axis));
    down = cross(axis, right);
    radius = 0.5 * camera.lens.diameter;
    const auto& surfaces = camera.lens.surfaces;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const double half = 0.5 * surfaces[i].diameter;
      radius = i > 0 ? std::max(radius, half) : half;
      if (i + 1 < surfaces.size()) back += surfaces[i].thickness;
    }
    const double behind = first_order(camera.lens).back_focal_distance;
    body = back + (std::isfinite(behind) ? std::max(0.0, behind) : 0.0);
    if (!surfaces.empty()) front = reach_to_scene(surfaces[0]);
  }
  bool contains(Vec3 p) const {
    const Vec3 from = p - vertex;
    const double along = dot(from, axis);
    return along <= front && along >= -body && length(from - along * axis) <= radius;
  }
  /// True for a place behind the lens.
  bool is_behind(Vec3 p) const { return dot(p - vertex, axis) < -back; }
  std::vector<Vec3> points() const {
    constexpr int kRings = 24, kAround = 48, kAlong = 24;
    std::vector<Vec3> points;
    for (int ring = 0; ring <= kRings; ++ring)
      for (int k = 0; k < kAround; ++k) {
        const double turn = 2 * constants::pi * k / kAround, r = radius * ring / kRings;
        const Vec3 across = r * std::cos(turn) * right + r * std::sin(turn) * down;
        for (int i = 0; i <= kAlong; ++i) {
          if (ring < kRings && i > 0 && i < kAlong) continue;  // the cylinder's inside
          points.push_back(vertex + (front - (front + body) * i / kAlong) * axis + across);
        }
      }
    return points;
  }

  Vec3 vertex, axis, right, down;
  double radius = 0, front = 0, back = 0, body = 0;
};

void check_camera_beside(const Scene& scene, const WindowSet& windows, Issues& issues) {
  const Barrel barrel(scene.camera);
  std::vector<bool> said(scene.windows.size());
  const auto say = [&](std::size_t w, Vec3 p) {
    if (said[w]) return;
    said[w] = true;
    issues.error(fmt::format("windows[{}].position", w),
                 fmt::format("{} reaches into {}{}; move one of them",
                             window_name(scene.windows, w), camera_in_words(scene.camera),
                             barrel.is_behind(p) ? ", behind its main lens" : "'s main lens"));
  };
  for (const Vec3 p : barrel.points())
    if (const int w = windows.glass_at(p); w >= 0) say(static_cast<std::size_t>(w), p);
  for (std::size_t w = 0; w < scene.windows.size(); ++w) {
    const std::vector<Vec3> points = windows.points_of(static_cast<int>(w));
    const auto inside =
        std::find_if(points.begin(), points.end(), [&](Vec3 p) { return barrel.contains(p); });
    if (inside != points.end()) say(w, *inside);
  }
}

void check_windows_apart(const Scene& scene, Issues& issues) {
  const std::size_t count = scene.windows.size();
  std::vector<std::vector<bool>> said(count, std::vector<bool>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const WindowSet one({scene.windows[i]});
    const std::vector<Vec3> points = one.points_of(0);
    for (std::size_t other = 0; other < count; ++other) {
      const std::size_t low = std::min(i, other), high = std::max(i, other);
      if (other == i || said[low][high]) continue;
      const WindowSet second({scene.windows[other]});
      if (!std::any_of(points.begin(), points.end(),
                       [&](Vec3 p) { return second.glass_at(p) >= 0; }))
        continue;
      said[low][high] = true;
      issues.error(fmt::format("windows[{}].position", high),
                   fmt::format("{} and {} reach into each other; there must be air between them",
                               window_name(scene.windows, low), window_name(scene.windows, high)));
    }
  }
}

}  // namespace

void check_windows(const Scene& scene, Issues& issues) {
  bool sound = true;
  for (std::size_t i = 0; i < scene.windows.size(); ++i)
    sound = check_shape(scene.windows[i], fmt::format("windows[{}]", i),
                        window_name(scene.windows, i), issues) &&
            sound;
  for (std::size_t i = 0; i < scene.windows.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (!scene.windows[i].name.empty() && scene.windows[i].name == scene.windows[k].name)
        issues.error(fmt::format("windows[{}].name", i),
                     fmt::format("windows {} and {} are both named {}; names must differ", k, i,
                                 quote_for_message(scene.windows[i].name)));
  if (scene.windows.empty() || !sound || issues.errors() > 0) return;
  check_windows_apart(scene, issues);
  check_camera_beside(scene, WindowSet(scene.windows), issues);
  bool lit = false;
  for (const SolidSurfaceSpec& surface : scene.surfaces)
    lit = lit ||
          (surface.material.kind == MaterialKind::lambertian && surface.material.reflectivity > 0);
  for (const FlameSpec& flame : scene.flames) lit = lit || flame.scattering.present();
  if (lit)
    issues.warning("windows",
                   "windows refract only rays of the camera: light from sources to surfaces and "
                   "scattering flames passes them straight and without loss",
                   IssueCode::straight_light);
}

}  // namespace plenoflame
