#include "plenoflame/camera/window_design.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "plenoflame/camera/design.h"

namespace plenoflame {
namespace {

constexpr double kNearAxis = 1e-3;  ///< distance of the rays, as a share of the pupil's radius

/// Distance along the first ray to the point where the two rays are closest [m].
double crossing(const Ray& a, const Ray& b) {
  const Vec3 apart = b.origin - a.origin;
  const double turned = dot(a.direction, b.direction);
  // sin^2 of the angle, without cancellation.
  const Vec3 sine = cross(a.direction, b.direction);
  const double along = dot(apart, a.direction) - turned * dot(apart, b.direction);
  return along / dot(sine, sine);
}

struct Section {
  double t;             ///< [m] along the first ray's stretch, to the crossing of both
  std::size_t stretch;  ///< the stretch that contains the crossing
};

std::optional<Section> meeting(const WindowPath& a, const WindowPath& b) {
  if (a.stopped || b.stopped || a.segments.size() != b.segments.size()) return std::nullopt;
  for (std::size_t k = 0; k < a.segments.size(); ++k) {
    const double t = crossing(a.segments[k].ray, b.segments[k].ray);
    if (t > 0 && t <= a.segments[k].far) return Section{t, k};
  }
  return std::nullopt;
}

}  // namespace

WindowDesign window_design(const Camera& camera, const WindowSet& windows, double object_distance,
                           double pupil_radius, double pupil_z) {
  WindowDesign design;
  const auto trace = [&](double x, double y) {
    // Starts at the plane of the front vertex, where rays from the pupil cross it.
    const double share = -pupil_z / (object_distance - pupil_z);
    const double front = pupil_z < 0 ? 1 - share : 1;
    const double z = pupil_z < 0 ? 0 : pupil_z;
    const Vec3 start{front * x, front * y, z};
    const Vec3 from = camera.to_world().point(start);
    const Vec3 to = camera.to_world().point({0, 0, object_distance});
    WindowPath path;
    windows.trace({from, normalize(to - from)}, path);
    return path;
  };
  const double h = kNearAxis * pupil_radius;
  const WindowPath axis = trace(0, 0);
  const WindowPath left = trace(-h, 0), right = trace(h, 0), up = trace(0, -h), down = trace(0, h);
  const std::optional<Section> x = meeting(left, right), y = meeting(up, down);
  if (axis.stopped || !x || !y || x->stretch != y->stretch) return design;
  if (axis.segments.size() <= x->stretch) return design;
  design.crossed = x->stretch > 0;
  const RigidTransform to_camera = camera.to_world().inverse();
  const auto z_of = [&](const WindowPath& path, const Section& section) {
    return to_camera.point(path.segments[section.stretch].ray.at(section.t)).z;
  };
  design.shift_x = z_of(left, *x) - object_distance;
  design.shift_y = z_of(up, *y) - object_distance;
  const AirSegment& chief = axis.segments[x->stretch];
  const Vec3 place = to_camera.point(chief.ray.at(0.5 * (x->t + y->t)));
  design.displacement = std::hypot(place.x, place.y);
  design.loss = 1 - chief.throughput;
  return design;
}

WindowDesign window_design(const Camera& camera, const WindowSet& windows) {
  const double distance = first_order_design(camera).object_distance;
  if (!std::isfinite(distance) || !(distance > 0)) return {};
  const FirstOrder& lens = camera.lens_first_order();
  double pupil = -lens.entrance_pupil, radius = 0.5 * lens.entrance_pupil_diameter;
  if (!std::isfinite(pupil) || !(radius > 0) || pupil >= distance) {
    pupil = 0;
    const auto& surfaces = camera.spec().lens.surfaces;
    radius = 0.5 * (surfaces.empty() ? camera.spec().lens.diameter : surfaces.front().diameter);
  }
  return window_design(camera, windows, distance, radius, pupil);
}

}  // namespace plenoflame
