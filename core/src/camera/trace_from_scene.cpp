#include <algorithm>
#include <cmath>

#include "plenoflame/camera/camera.h"

namespace plenoflame {
namespace {

Vec2 at_plane(const Ray& ray, double z) {
  const double t = (z - ray.origin.z) / ray.direction.z;
  return {ray.origin.x + t * ray.direction.x, ray.origin.y + t * ray.direction.y};
}

Vec2 slope(const Ray& ray) {
  return {ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z};
}

/// A ray towards the sensor with slope dx/dz, dy/dz.
Ray inwards(Vec2 at, double z, Vec2 slope) {
  return {{at.x, at.y, z}, -normalize({slope.x, slope.y, 1})};
}

/// cos^4 of the angle with the axis. The paraxial transform conserves dA d(slope)^2; the product of
/// solid angle and projected area is cos^4 times that.
double cos4(Vec2 slope) {
  const double tangent2 = dot(slope, slope);
  return 1 / ((1 + tangent2) * (1 + tangent2));
}

/// Depth of a spherical face's rim behind its vertex (negative: in front of it).
double rim_depth(double radius, double height) {
  if (!std::isfinite(radius)) return 0;
  const double inside = std::max(0.0, (radius - height) * (radius + height));
  const double depth = height * height / (std::fabs(radius) + std::sqrt(inside));
  return std::copysign(depth, radius);
}

}  // namespace

TraceStatus Camera::trace_main_lens_inwards(Ray& ray, Arrival& arrival,
                                            std::vector<Vec3>* points) const {
  if (lens_moved_) {
    const RigidTransform inverse = lens_pose_.inverse();
    ray = {inverse.point(ray.origin), inverse.direction(ray.direction)};
    const TraceStatus status = trace_aligned_lens_inwards(ray, arrival, points);
    ray = {lens_pose_.point(ray.origin), lens_pose_.direction(ray.direction)};
    if (points)
      for (Vec3& point : *points) point = lens_pose_.point(point);
    return status;
  }
  return trace_aligned_lens_inwards(ray, arrival, points);
}

/// Traces in the frame of the main lens.
TraceStatus Camera::trace_aligned_lens_inwards(Ray& ray, Arrival& arrival,
                                               std::vector<Vec3>* points) const {
  if (!ideal_lens()) {
    PassedLight passed = light_of_lens();
    const TraceStatus status = trace_surfaces(
        ray, false, points, spec_.transmission.fresnel ? &passed : nullptr, arrival.pupil_part);
    arrival.etendue_ratio *= passed.share;
    return status;
  }
  const Vec2 height = at_plane(ray, ideal_.front_principal);
  const Vec2 outer = slope(ray);
  const Vec2 inner = outer + (1.0 / ideal_.focal_length) * height;
  const Vec2 at_stop = ideal_.stop_height * height + ideal_.stop_slope * inner;
  if (!pupil_filters_.empty())
    arrival.pupil_part = pupil_filters_.part_at((1 / ideal_.stop_radius) * at_stop);
  ray = inwards(height, ideal_.rear_principal, inner);
  arrival.etendue_ratio *= cos4(inner) / cos4(outer);
  if (points) {
    if (ideal_.front_principal != ideal_.rear_principal)
      points->push_back({height.x, height.y, ideal_.front_principal});
    points->push_back(ray.origin);
  }
  if (length(at_stop) > ideal_.stop_radius) return {RayStatus::vignetted, 0};
  return {};
}

TraceStatus Camera::pass_microlens(LensIndex lens, Ray ray, Arrival arrival,
                                   std::vector<Arrival>& arrivals,
                                   std::vector<Vec3>* points) const {
  const auto type = static_cast<std::size_t>(lattice_.type(lens));
  const Vec2 centre = lattice_.centre(lens);
  ray.origin.x -= centre.x;
  ray.origin.y -= centre.y;
  TraceStatus status;
  if (ideal_array()) {
    const Microlens& microlens = microlenses_[type];
    const Vec2 height = at_plane(ray, microlens.front_principal);
    const Vec2 outer = slope(ray);
    const Vec2 inner = outer + microlens_power(lens) * height;
    ray = inwards(height, microlens.rear_principal, inner);
    arrival.etendue_ratio *= cos4(inner) / cos4(outer);
    if (points) points->push_back(ray.origin);
    if (!aperture_.holds(height)) status = {RayStatus::vignetted, 0};
  } else {
    status = pass_faces(lens, false, ray, points, arrival.etendue_ratio);
  }
  if (points)
    for (Vec3& point : *points) point = array_pose_.point(point + Vec3{centre.x, centre.y, 0});
  if (status.status != RayStatus::reached) return status;
  arrival.lens = lens;
  if (array_tilted_) {
    ray.origin = ray.origin + Vec3{centre.x, centre.y, 0};
    ray = from_array(ray);
    arrival.sensor_point = at_plane(ray, sensor_);
  } else {
    arrival.sensor_point = at_plane(ray, sensor_) + centre;
  }
  arrival.etendue_ratio *= through_cover(ray.direction);
  if (points) points->push_back({arrival.sensor_point.x, arrival.sensor_point.y, sensor_});
  arrivals.push_back(arrival);
  return status;
}

/// Traces a ray from the main lens through every microlens that it may meet. @return true if it met
/// one, even if it ended there; `status` is that of the last microlens tried
bool Camera::meet_microlenses(const Ray& in_camera, const Arrival& arrival,
                              std::vector<Arrival>& arrivals, TraceStatus& status,
                              std::vector<Vec3>* points) const {
  const Ray ray = to_array(in_camera);
  // The layer of space that contains the front faces (or principal planes).
  const double radius = aperture_.radius();
  double high = -kInfinity, low = kInfinity;
  for (const Microlens& lens : microlenses_) {
    const double vertex = ideal_array() ? lens.front_principal : array_front_;
    const double curved = lens.radius_front * (1 - spec_.array.focal_jitter);
    const double rim = ideal_array() ? vertex : vertex - rim_depth(curved, radius);
    high = std::max({high, vertex, rim});
    low = std::min({low, vertex, rim});
  }
  const Vec2 a = at_plane(ray, high), b = at_plane(ray, low);
  bool on_a_lens = false;
  std::vector<Vec3> behind, attempted;  // points from the array on
  const auto attempt = [&](LensIndex lens) {
    attempted.clear();
    const TraceStatus tried =
        pass_microlens(lens, ray, arrival, arrivals, points ? &attempted : nullptr);
    // A ray that passes the front aperture belongs to this lens, even if it ends there.
    const bool entered = tried.status == RayStatus::reached ||
                         tried.status == RayStatus::total_internal_reflection || tried.surface > 0;
    if (entered || !on_a_lens) {  // status and points belong to the same lens
      status = tried;
      if (!on_a_lens) behind = attempted;
    }
    on_a_lens = on_a_lens || entered;
  };
  const LensIndex nearest = lattice_.nearest(a);
  if (nearest == lattice_.nearest(b)) {
    attempt(nearest);  // cells are convex: the whole path is in one cell
  } else {
    const double reach = longest_pitch(spec_.array);
    for (const LensIndex lens :
         lattice_.within({std::min(a.x, b.x) - reach, std::min(a.y, b.y) - reach},
                         {std::max(a.x, b.x) + reach, std::max(a.y, b.y) + reach}))
      attempt(lens);
  }
  if (points) points->insert(points->end(), behind.begin(), behind.end());
  return on_a_lens;
}

bool Camera::passes_between(const Ray& ray) const {
  const Vec3 away = ray.direction.z > 0 ? ray.direction : -ray.direction;
  // Starts well in front of the array.
  const double ahead = (array_front_ + longest_pitch(spec_.array) - ray.origin.z) / away.z;
  std::vector<Arrival> arrivals;
  TraceStatus status;
  return !meet_microlenses({ray.origin + ahead * away, -away}, {}, arrivals, status, nullptr);
}

TraceStatus Camera::trace_from_scene(const Ray& from_scene, std::vector<Arrival>& arrivals,
                                     std::vector<Vec3>* points) const {
  Ray ray = from_scene;
  Arrival arrival;
  if (distortion_.present()) {
    const RigidTransform to_lens = lens_pose_.inverse();
    ray = {to_lens.point(ray.origin), to_lens.direction(ray.direction)};
    if (!distortion_.to_lens(ray, arrival.etendue_ratio)) return {RayStatus::vignetted, 0};
    ray = {lens_pose_.point(ray.origin), lens_pose_.direction(ray.direction)};
  }
  const TraceStatus main_lens = trace_main_lens_inwards(ray, arrival, points);
  if (main_lens.status != RayStatus::reached) return main_lens;
  if (!has_array()) {
    arrival.sensor_point = at_plane(ray, sensor_);
    arrival.etendue_ratio *= through_cover(ray.direction);
    arrivals.push_back(arrival);
    if (points) points->push_back({arrival.sensor_point.x, arrival.sensor_point.y, sensor_});
    return {};
  }
  const int lens_surfaces = surface_count() - (ideal_array() ? 1 : 2);
  const std::size_t before = arrivals.size();
  TraceStatus status{RayStatus::vignetted, 0};
  const std::size_t in_front = points ? points->size() : 0;
  const bool on_a_lens = meet_microlenses(ray, arrival, arrivals, status, points);
  if (!on_a_lens && !spec_.array.opaque_between) {
    arrival.sensor_point = at_plane(ray, sensor_);
    arrival.etendue_ratio *= through_cover(ray.direction);
    arrivals.push_back(arrival);
    if (points) {  // discards the points of all attempts
      points->resize(in_front);
      points->push_back({arrival.sensor_point.x, arrival.sensor_point.y, sensor_});
    }
  }
  if (arrivals.size() > before) return {};
  return {status.status, status.surface + lens_surfaces};
}

}  // namespace plenoflame
