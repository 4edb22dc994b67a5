#include "plenoflame/camera/resolution.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace plenoflame {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kZones = 5;
constexpr int kRings = 12, kSpokes = 8;
constexpr double kNearestDepth = 0.25, kFarthestDepth = 20;  // |a| / B of a curve

/// The same camera with a single type and without tolerances.
CameraSpec with_one_type(const Camera& camera, std::size_t type) {
  CameraSpec spec = camera.spec();
  spec.lens.decentre = spec.lens.tilt = spec.array.tilt = {};
  spec.array.focal_jitter = 0;
  spec.array.types = {spec.array.types[type]};
  spec.array.offset = {};
  spec.array.centre_jitter = 0;
  spec.array.measured_from = ArrayReference::vertex;
  spec.array.sensor_distance = camera.array_back() - camera.sensor();
  spec.focus.mode = FocusMode::distance;
  spec.focus.lens_distance = camera.lens_distance();
  return spec;
}

double object_of(const Camera& camera, const Microlens& lens, double a) {
  return paraxial_object_distance(camera.lens_first_order(),
                                  camera.rear_vertex() - (lens.front_principal + a));
}

/// Ignores NaN.
double best_of(const std::vector<double>& values) {
  double best = kNan;
  for (const double value : values)
    if (!(value <= best)) best = std::isnan(value) ? best : value;
  return best;
}

}  // namespace

double effective_resolution(const TypeDesign& type, double diameter, double pixel, double a,
                            double least_spot) {
  const double b = type.sensor_distance;
  const double blur = diameter * std::fabs(b * (1 / type.focal_length - 1 / a) - 1);
  return std::min(1.0, std::fabs(b / a)) * pixel / std::max({blur, pixel, least_spot});
}

BlurTracer::BlurTracer(const Camera& camera, std::size_t type)
    : camera_(with_one_type(camera, type)) {}

double traced_resolution(const TracedBlur& blur, double pixel, double least_spot) {
  return pixel / std::max(blur.in_image, blur.growth * std::max(pixel, least_spot));
}

std::optional<BlurTracer::Arriving> BlurTracer::at_array(double object_distance, Vec2 pupil) const {
  const Vec3 object{0, 0, object_distance};
  const Vec3 target{pupil.x, pupil.y, -camera_.lens_first_order().entrance_pupil};
  Ray ray{object, normalize(target - object)};
  if (ray.direction.z >= 0) return std::nullopt;
  if (camera_.ideal_lens()) {
    const IdealLens& lens = camera_.ideal();
    const Vec3 p = ray.at((lens.front_principal - object.z) / ray.direction.z);
    const double k = 1 / lens.focal_length, z = camera_.array_front() - lens.rear_principal;
    const Vec2 slope{ray.direction.x / ray.direction.z + k * p.x,
                     ray.direction.y / ray.direction.z + k * p.y};
    return Arriving{Vec2{p.x, p.y} + z * slope, slope};
  }
  if (camera_.lens().trace_to_sensor(ray).status != RayStatus::reached) return std::nullopt;
  const Vec3 p = ray.at((camera_.array_front() - ray.origin.z) / ray.direction.z);
  return Arriving{{p.x, p.y},
                  {ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z}};
}

std::optional<BlurTracer::Zone> BlurTracer::zone_blur(double object_distance, double zone) const {
  const FirstOrder& lens = camera_.lens_first_order();
  const double pupil = 0.5 * lens.entrance_pupil_diameter, step = 1e-4 * pupil;
  const double height = zone * pupil;
  const auto middle = at_array(object_distance, {height, 0});
  const auto outer = at_array(object_distance, {height + step, 0});
  const auto aside = at_array(object_distance, {height, step});
  if (!middle || !outer || !aside) return std::nullopt;
  // The beam of the zone, aimed at one microlens, maps the pupil onto the array.
  const Vec2 across = outer->place - middle->place, across_slope = outer->slope - middle->slope;
  const double scale_x = across.x / step, scale_y = aside->place.y / step;
  // Neighbouring rays intersect at the focus of the zone: across the zone and along it.
  const Microlens& type = camera_.microlenses().front();
  const auto kept = [&](double width, double slope) {
    const double a = camera_.array_front() - width / slope - type.front_principal;
    return std::min(1.0, std::fabs(type.sensor_distance / a));
  };
  const double share =
      0.5 * (kept(across.x, across_slope.x) + kept(aside->place.y, aside->slope.y));
  const double radius = 0.5 * camera_.spec().array.diameter;
  const LensIndex microlens = camera_.lattice().nearest(middle->place);
  const Vec2 centre = camera_.lattice().centre(microlens);
  const auto limited = [&](double length, double scale) {
    return std::fabs(length) < pupil * std::fabs(scale) ? length / scale
                                                        : std::copysign(pupil, length);
  };
  const double wide_x = limited(radius, scale_x), wide_y = limited(radius, scale_y);
  const double from_x = height + limited(centre.x - middle->place.x, scale_x);
  const double from_y = limited(centre.y, scale_y);
  const Vec3 object{0, 0, object_distance};
  std::vector<Camera::Arrival> arrivals;
  double n = 0, x = 0, y = 0, squares = 0;
  for (int ring = 0; ring < kRings; ++ring)
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      const double r = std::sqrt((ring + 0.5) / kRings);
      const double angle = 6.283185307179586 * (spoke + 0.5 * (ring % 2)) / kSpokes;
      const Vec3 target{from_x + r * wide_x * std::cos(angle),
                        from_y + r * wide_y * std::sin(angle), -lens.entrance_pupil};
      const Vec3 direction = normalize(target - object);
      arrivals.clear();
      if (direction.z >= 0) continue;
      camera_.trace_from_scene({object, direction}, arrivals);
      for (const Camera::Arrival& arrival : arrivals) {
        if (!arrival.lens || !(*arrival.lens == microlens)) continue;
        const Vec2 at = arrival.sensor_point - centre;
        n += 1, x += at.x, y += at.y, squares += dot(at, at);
      }
    }
  if (n < 0.05 * kRings * kSpokes) return std::nullopt;
  return Zone{8 * std::max(0.0, squares - (x * x + y * y) / n) / n, share};
}

TracedBlur BlurTracer::operator()(double object_distance) const {
  TracedBlur blur{kNan, kNan, kNan, kNan};
  double squares = 0, in_image = 0, growth = 0;
  int seen = 0;
  for (int k = 0; k < kZones; ++k) {
    // The first zone is the axis itself; the others represent equal areas around it.
    const std::optional<Zone> zone =
        zone_blur(object_distance, k == 0 ? 0 : std::sqrt((k + 0.5) / kZones));
    if (!zone) continue;
    if (k == 0) blur.central = std::sqrt(zone->blur2);
    const double wider2 = 1 / (zone->kept * zone->kept);
    squares += zone->blur2;
    in_image += zone->blur2 * wider2;
    growth += wider2;
    ++seen;
  }
  if (seen == 0) return blur;
  blur.all = std::sqrt(squares / seen);
  blur.in_image = std::sqrt(in_image / seen);
  blur.growth = std::sqrt(growth / seen);
  return blur;
}

std::vector<ResolutionPoint> resolution_curve(const Camera& camera, int points, double wavelength) {
  std::vector<ResolutionPoint> curve;
  if (!camera.has_array()) return curve;
  const CameraDesign d = first_order_design(camera);
  const double diameter = camera.spec().array.diameter, pixel = camera.spec().sensor.pixel_pitch;
  const double b = d.types.front().sensor_distance;
  const Microlens& reference = camera.microlenses().front();
  bool in_front = false, behind = false;
  for (const TypeDesign& type : d.types) (type.keplerian ? in_front : behind) = true;
  const double ends[] = {
      object_of(camera, reference, (behind ? -kFarthestDepth : kNearestDepth) * b),
      object_of(camera, reference, (in_front ? kFarthestDepth : -kNearestDepth) * b)};
  // Objects end at infinity, and far away nothing changes.
  const double farthest =
      20 * std::max(std::isfinite(d.object_distance) ? d.object_distance : 0, d.lens.focal_length);
  double near = kInfinity, far = 0;
  for (const double end : ends) {
    const double distance = end > 0 ? std::min(end, farthest) : farthest;
    near = std::min(near, distance), far = std::max(far, distance);
  }
  std::vector<BlurTracer> tracers;
  for (std::size_t k = 0; k < d.types.size(); ++k) tracers.emplace_back(camera, k);
  for (int i = 0; i < points; ++i) {
    ResolutionPoint point;
    point.object_distance = near + (far - near) * i / std::max(1, points - 1);
    const double image = paraxial_image_distance(d.lens, point.object_distance);
    for (std::size_t k = 0; k < d.types.size(); ++k) {
      const TypeDesign& type = d.types[k];
      const double a = camera.rear_vertex() - image - camera.microlenses()[k].front_principal;
      if (k == 0) point.array_distance = a;
      const double least = 1.22 * wavelength * type.f_number;
      point.paraxial.push_back(effective_resolution(type, diameter, pixel, a, least));
      point.traced.push_back(traced_resolution(tracers[k](point.object_distance), pixel, least));
    }
    point.paraxial_joint = best_of(point.paraxial);
    point.traced_joint = best_of(point.traced);
    curve.push_back(std::move(point));
  }
  return curve;
}

}  // namespace plenoflame
