#include "render/endless_planes.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"
#include "render/surface_light.h"

namespace plenoflame {
namespace {

constexpr double kShare = 1.0 / 3;  ///< of the points, by each of the three ways

/// 1 - cos of an angle.
double versine_of(double tangent) {
  const double secant = std::hypot(1.0, tangent);
  return tangent * tangent / (secant * (1 + secant));
}

double front_radius(const MainLensSpec& lens) {
  return 0.5 * (lens.surfaces.empty() ? lens.diameter : lens.surfaces.front().diameter);
}

}  // namespace

EndlessPlanes::EndlessPlanes(const CompiledScene& scene, Vec3 centre, double radius,
                             double field_versine)
    : axis_(scene.camera.to_world().direction({0, 0, 1})) {
  if (!scene.surfaces) return;
  const Vec3 camera = scene.camera.to_world().translation;
  const SensorSpec& sensor = scene.camera.spec().sensor;
  const double corner = 0.5 * sensor.pixel_pitch * std::hypot(sensor.columns, sensor.rows);
  const double image = scene.camera.rear_vertex() - scene.camera.sensor() -
                       scene.camera.lens_first_order().rear_principal;
  cones_[0] = {camera, versine_of(1.2 * corner / image)};
  // What leaves the whole front under the angles of the field comes from a point behind it.
  const double tangent = std::sqrt(field_versine * (2 - field_versine)) / (1 - field_versine);
  cones_[1] = {camera - (front_radius(scene.scene.camera.lens) / tangent) * axis_, field_versine};
  for (std::size_t i = 0; i < scene.scene.surfaces.size(); ++i) {
    if (std::isfinite(scene.surfaces->area(static_cast<int>(i)))) continue;
    const SolidSurfaceSpec& spec = scene.scene.surfaces[i];
    const Mat3 turn = rotation_xyz(spec.rotation);
    Plane plane{static_cast<int>(i),
                spec.position,
                turn * Vec3{0, 0, 1},
                turn * Vec3{1, 0, 0},
                turn * Vec3{0, 1, 0},
                0.5 * spec.extent,
                {},
                0};
    // Without objects light is wanted below the camera.
    const Vec3 around = radius > 0 ? centre : camera;
    const double above = dot(around - plane.origin, plane.normal);
    const double size = radius > 0 ? radius : scene.camera.lens_distance();
    plane.height = std::max(std::fabs(above), size);
    plane.lookout = around + (std::copysign(plane.height, above) - above) * plane.normal;
    planes_.push_back(plane);
  }
}

bool EndlessPlanes::on_plane(const Plane& plane, Vec3 point) const {
  const Vec3 p = point - plane.origin;
  return std::fabs(dot(p, plane.x)) <= plane.half.x && std::fabs(dot(p, plane.y)) <= plane.half.y;
}

EndlessPlanes::Place EndlessPlanes::draw(std::size_t index, double choice, double u,
                                         double v) const {
  const Plane& plane = planes_[index];
  Vec3 from, direction;
  if (choice < 2 * kShare) {
    const Cone& cone = cones_[choice < kShare ? 0 : 1];
    from = cone.apex;
    const double versine = u * cone.versine;
    // Up to half a turn around the axis.
    const double sine2 = versine * (2 - versine), cosine = 1 - versine;
    const Vec3 other = std::fabs(axis_.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 e1 = normalize(cross(axis_, other)), e2 = cross(axis_, e1);
    const double angle = 2 * constants::pi * v, sine = std::sqrt(std::max(0.0, sine2));
    direction = cosine * axis_ + sine * std::cos(angle) * e1 + sine * std::sin(angle) * e2;
  } else {
    from = plane.lookout;
    const Vec3 down = dot(from - plane.origin, plane.normal) > 0 ? -plane.normal : plane.normal;
    const double sine = std::sqrt(u * (2 - u)), angle = 2 * constants::pi * v;
    direction =
        (1 - u) * down + sine * std::cos(angle) * plane.x + sine * std::sin(angle) * plane.y;
  }
  double t = 0;
  Place place;
  if (!crossing(index, {from, direction}, t) || !(t > 0)) return place;
  place.point = from + t * direction;
  if (on_plane(plane, place.point)) place.density = density(index, place.point);
  return place;
}

double EndlessPlanes::density(std::size_t index, Vec3 point) const {
  const Plane& plane = planes_[index];
  /// Solid angle of an area at the point, per area.
  const auto per_area = [&](Vec3 way) {
    const double square = dot(way, way);
    return square > 0 ? std::fabs(dot(way, plane.normal)) / (square * std::sqrt(square)) : 0.0;
  };
  double result = kShare * per_area(point - plane.lookout) / (2 * constants::pi);
  for (const Cone& cone : cones_) {
    const Vec3 seen = point - cone.apex;
    const double distance = length(seen);
    if (distance > 0 && 1 - dot(seen, axis_) / distance <= cone.versine)
      result += kShare * per_area(seen) / (2 * constants::pi * cone.versine);
  }
  return result;
}

bool EndlessPlanes::crossing(std::size_t index, const Ray& line, double& t) const {
  const Plane& plane = planes_[index];
  const double along = dot(line.direction, plane.normal);
  if (along == 0) return false;
  t = dot(plane.origin - line.origin, plane.normal) / along;
  return std::isfinite(t);
}

double EndlessPlanes::before(const Ray& line, double t) const {
  double first = t;
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    double at = 0;
    // How far before does not matter: nothing else is there.
    if (crossing(i, line, at)) first = std::min(first, at - 0.01 * std::fabs(at) - 1);
  }
  return first;
}

}  // namespace plenoflame
