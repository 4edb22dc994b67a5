#include "render/visibility/endless_planes.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"
#include "sampling/directions.h"

namespace plenoflame {
namespace {

constexpr double kShare = 1.0 / 3;      ///< of the points, for each of the three ways
constexpr double kDiscShare = 2.0 / 3;  ///< of the points for light from another plane

/// 1 - cos of an angle, from its tangent.
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
    : axis_(scene.camera.to_world().direction({0, 0, 1})), centre_(centre), radius_(radius) {
  if (!scene.surfaces) return;
  const Vec3 camera = scene.camera.to_world().translation;
  const SensorSpec& sensor = scene.camera.spec().sensor;
  const double corner = sensor.corner();
  const double image = scene.camera.rear_vertex() - scene.camera.sensor() -
                       scene.camera.lens_first_order().rear_principal;
  cones_[0] = {camera, versine_of(1.5 * corner / image)};
  // Rays that leave the whole front within the field's angles diverge from a point behind it.
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
    // Without objects, points are drawn below the camera.
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

/// Follows a direction to a plane. @return density 1 if the direction meets it, otherwise 0
EndlessPlanes::Place EndlessPlanes::meet(std::size_t index, Vec3 from, Vec3 direction) const {
  double t = 0;
  Place place;
  if (!crossing(index, {from, direction}, t) || !(t > 0)) return place;
  place.point = from + t * direction;
  place.density = on_plane(planes_[index], place.point) ? 1 : 0;
  return place;
}

EndlessPlanes::Place EndlessPlanes::draw(std::size_t index, double choice, double u,
                                         double v) const {
  const Plane& plane = planes_[index];
  Place place;
  if (choice < 2 * kShare) {
    const Cone& cone = cones_[choice < kShare ? 0 : 1];
    place = meet(index, cone.apex, cone_direction(axis_, u * cone.versine, v));
  } else {
    const Vec3 from = plane.lookout;
    const bool above = dot(from - plane.origin, plane.normal) > 0;
    place = meet(index, from, cone_direction(above ? -plane.normal : plane.normal, u, v));
  }
  if (place.density > 0) place.density = density(index, place.point);
  return place;
}

/// Solid angle of an element of the plane, seen from the point, per area.
double EndlessPlanes::per_area(const Plane& plane, Vec3 way) {
  const double square = dot(way, way);
  return square > 0 ? std::fabs(dot(way, plane.normal)) / (square * std::sqrt(square)) : 0.0;
}

double EndlessPlanes::cone_density(const Plane& plane, Vec3 point) const {
  double result = 0;
  for (const Cone& cone : cones_) {
    const Vec3 seen = point - cone.apex;
    const double distance = length(seen);
    if (distance > 0 && 1 - dot(seen, axis_) / distance <= cone.versine)
      result += kShare * per_area(plane, seen) / (2 * constants::pi * cone.versine);
  }
  return result;
}

double EndlessPlanes::density(std::size_t index, Vec3 point) const {
  const Plane& plane = planes_[index];
  return kShare * per_area(plane, point - plane.lookout) / (2 * constants::pi) +
         cone_density(plane, point);
}

/// (radius / height)^2 at the end of a plane's logarithmic disc, for light from a point.
double EndlessPlanes::disc_reach(const Plane& plane, Vec3 from) const {
  const double reach = 2 * (length(from - plane.lookout) / plane.height + 1);
  return reach * reach;
}

EndlessPlanes::Place EndlessPlanes::draw_from(std::size_t index, Vec3 from, double choice, double u,
                                              double v) const {
  const Plane& plane = planes_[index];
  if (choice >= kDiscShare) {
    // Both cones are the first two thirds of draw().
    Place place = draw(index, 2 * kShare * (choice - kDiscShare) / (1 - kDiscShare), u, v);
    if (place.density > 0) place.density = density_from(index, from, place.point);
    return place;
  }
  // The area density is proportional to 1 / (r^2 + height^2), which is even over octaves of
  // distance.
  const double ratio = std::expm1(u * std::log1p(disc_reach(plane, from)));
  const double radius = plane.height * std::sqrt(ratio), angle = 2 * constants::pi * v;
  Place place;
  place.point = foot(plane) + radius * (std::cos(angle) * plane.x + std::sin(angle) * plane.y);
  if (on_plane(plane, place.point)) place.density = density_from(index, from, place.point);
  return place;
}

double EndlessPlanes::density_from(std::size_t index, Vec3 from, Vec3 point) const {
  const Plane& plane = planes_[index];
  const Vec3 off = point - foot(plane);
  const double height2 = plane.height * plane.height, square = dot(off, off);
  const double reach = disc_reach(plane, from);
  const double disc = square <= reach * height2
                          ? 1 / (constants::pi * (square + height2) * std::log1p(reach))
                          : 0.0;
  return kDiscShare * disc + (1 - kDiscShare) / (2 * kShare) * cone_density(plane, point);
}

/// The point of the plane below the lookout.
Vec3 EndlessPlanes::foot(const Plane& plane) {
  return plane.lookout - dot(plane.lookout - plane.origin, plane.normal) * plane.normal;
}

std::optional<std::size_t> EndlessPlanes::find(int surface) const {
  for (std::size_t k = 0; k < planes_.size(); ++k)
    if (planes_[k].surface == surface) return k;
  return std::nullopt;
}

double EndlessPlanes::versine_of_objects(Vec3 point) const {
  const Vec3 way = centre_ - point;
  const double square = dot(way, way), part = radius_ * radius_ / square;
  return radius_ > 0 && part < 1 ? part / (1 + std::sqrt(1 - part)) : 0;
}

EndlessPlanes::Leaving EndlessPlanes::leave(std::size_t plane, const Ray& outwards, double way,
                                            double choice, double u, double v) const {
  const Vec3 point = outwards.origin, normal = outwards.direction;
  // The ways are the cosine, the cone around all finite objects, and one for each other plane.
  const double versine = versine_of_objects(point);
  const std::size_t ways = 1 + (versine > 0 ? 1 : 0) + planes_.size() - 1;
  auto chosen = std::min(static_cast<std::size_t>(way * static_cast<double>(ways)), ways - 1);
  Leaving leaving;
  bool drawn_at_objects = false;
  const Vec3 to_objects = centre_ - point;
  if (chosen == 0) {
    leaving.direction = cosine_direction(normal, u, v);
  } else if (versine > 0 && --chosen == 0) {
    drawn_at_objects = true;
    leaving.direction = cone_direction(normalize(to_objects), u * versine, v);
  } else {
    std::size_t other = chosen - 1;  // among the planes other than `plane`
    if (other >= plane) ++other;
    const Place place = draw_from(other, point, choice, u, v);
    if (!(place.density > 0)) return leaving;
    leaving.direction = normalize(place.point - point);
  }
  const double cosine = dot(normal, leaving.direction);
  if (!(cosine > 0)) return leaving;
  double sum = cosine / constants::pi;
  // From far away, the cosine of the cone's angle has too few digits for this test.
  const Vec3 beside = cross(leaving.direction, to_objects);
  const bool at_objects =
      dot(leaving.direction, to_objects) > 0 && dot(beside, beside) <= radius_ * radius_;
  if (versine > 0 && (drawn_at_objects || at_objects)) sum += 1 / (2 * constants::pi * versine);
  for (std::size_t k = 0; k < planes_.size(); ++k) {
    double t = 0;
    if (k == plane || !crossing(k, {point, leaving.direction}, t) || !(t > 0)) continue;
    const Vec3 met = point + t * leaving.direction;
    if (on_plane(planes_[k], met))
      sum += density_from(k, point, met) * t * t /
             std::fabs(dot(leaving.direction, planes_[k].normal));
  }
  leaving.weight = static_cast<double>(ways) * cosine / constants::pi / sum;
  return leaving;
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
    // The margin is arbitrary, since nothing else is there.
    if (crossing(i, line, at)) first = std::min(first, at - 0.01 * std::fabs(at) - 1);
  }
  return first;
}

}  // namespace plenoflame
