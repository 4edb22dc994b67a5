#include "plenoflame/camera/camera.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "optics/reflection.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "plenoflame/optics/surface_shape.h"

namespace plenoflame {
namespace {

RigidTransform camera_to_world(const CameraSpec& spec) {
  const Vec3 z = normalize(spec.look_direction);
  const Vec3 up = spec.up - dot(spec.up, z) * z;
  if (!(length(up) > 1e-9 * length(spec.up)))
    throw InputError("camera.up is parallel to camera.look_direction; choose another up direction");
  const Vec3 y = -normalize(up);
  const Vec3 x = cross(y, z);
  // Columns of the rotation are the camera axes in the world.
  return {{{{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}}}, spec.position};
}

}  // namespace

Camera::Camera(const CameraSpec& spec, std::vector<std::string>* warnings)
    : spec_(spec), pupil_filters_(spec.pupil_filters) {
  to_world_ = camera_to_world(spec_);
  place_lens();
  solve_focus(warnings);
  place_array();
  mount();
  if (!spec_.lens.distortion.none()) place_distortion();
}

/// @throws InputError when the map is not invertible somewhere in the picture
void Camera::place_distortion() {
  distortion_ = LensDistortion(spec_.lens.distortion, -lens_first_order_.entrance_pupil);
  constexpr int kPlaces = 96;  // along the sensor's border
  constexpr double kRoom = 1.02, kMost = 1.5;
  const Vec2 corner = sensor_point(0, 0);
  const double exit = exit_pupil();
  const RigidTransform to_lens = lens_pose_.inverse();
  double widest = 0;
  for (int k = 0; k < kPlaces; ++k) {
    const double along = 4.0 * (k % (kPlaces / 4)) / (kPlaces / 4) / 2 - 1;
    const double side = k / (kPlaces / 4) % 2 == 0 ? 1 : -1;
    const Vec2 s = k < kPlaces / 2 ? Vec2{along * corner.x, side * corner.y}
                                   : Vec2{side * corner.x, along * corner.y};
    const double plane = aim_plane(0);
    const double share = std::isfinite(exit) ? (exit - plane) / (exit - sensor_) : 1;
    const Vec2 straight = foot_ + share * (s - foot_);
    std::optional<LensIndex> lens;
    Vec2 aim = straight;
    if (has_array()) {
      lens = lattice_.nearest(straight);
      const Vec3 place = lens_place(*lens);
      aim = {place.x, place.y};
    }
    const Path path = trace_inside(s, lens, aim, false);
    if (path.status.status != RayStatus::reached) continue;
    widest =
        std::max(widest, length(distortion_.direction({to_lens.point(path.exit.origin),
                                                       to_lens.direction(path.exit.direction)})));
  }
  if (kRoom * widest <= distortion_.limit()) {
    distortion_.restrict_to(kMost * widest);
    return;
  }
  const auto degrees = [](double tangent) {
    return std::to_string(std::atan(tangent) * 180 / constants::pi);
  };
  throw InputError(
      "camera.lens.distortion cannot be undone: places in the picture have one "
      "direction each up to " +
      degrees(distortion_.limit()) + " degrees from the axis, and the sensor reaches " +
      degrees(widest) + "; coefficients count in units of the tangent of the angle");
}

Camera Camera::undistorted() const {
  Camera camera = *this;
  camera.spec_.lens.distortion = {};
  camera.distortion_ = {};
  return camera;
}

void Camera::mount() {
  const MainLensSpec& lens = spec_.lens;
  lens_moved_ = !(lens.decentre == Vec2{} && lens.tilt == Vec2{});
  array_tilted_ = has_array() && !(spec_.array.tilt == Vec2{});
  if (lens_moved_)
    lens_pose_ = {rotation_xyz({lens.tilt.x, lens.tilt.y, 0}),
                  {lens.decentre.x, lens.decentre.y, 0}};
  if (array_tilted_) {
    const Mat3 turn = rotation_xyz({spec_.array.tilt.x, spec_.array.tilt.y, 0});
    const Vec3 pivot{0, 0, array_front_};
    array_pose_ = {turn, pivot - turn * pivot};
  }
  if (!lens_moved_) return;
  const double pupil = exit_pupil();
  const Vec3 axis = lens_pose_.direction({0, 0, 1}), vertex = lens_pose_.translation;
  const double along = std::isfinite(pupil) ? pupil : (array_front_ - vertex.z) / axis.z;
  const Vec3 foot = vertex + along * axis;
  foot_ = {foot.x, foot.y};
}

Camera Camera::aligned() const {
  CameraSpec spec = spec_;
  spec.lens.distortion = {};
  spec.lens.decentre = spec.lens.tilt = spec.array.tilt = {};
  spec.lens = round_counterpart(std::move(spec.lens));
  spec.array.focal_jitter = 0;
  spec.focus.mode = FocusMode::distance;
  spec.focus.lens_distance = lens_distance_;
  if (has_array()) {
    spec.array.sensor_distance = array_back_ - sensor_;
    spec.array.measured_from = ArrayReference::vertex;
  }
  return Camera(spec);
}

Camera Camera::with_circles() const {
  if (aperture_.pairs() == 0) return *this;
  CameraSpec spec = spec_;
  spec.array = with_circumscribed_circles(spec.array);
  spec.focus.mode = FocusMode::distance;
  spec.focus.lens_distance = lens_distance_;
  spec.array.sensor_distance = array_back_ - sensor_;
  spec.array.measured_from = ArrayReference::vertex;
  return Camera(spec);
}

Vec3 Camera::lens_place(LensIndex lens) const {
  const Vec2 centre = lattice_.centre(lens);
  const Vec3 place{centre.x, centre.y, aim_plane(lattice_.type(lens))};
  return array_tilted_ ? array_pose_.point(place) : place;
}

const LensSystem& Camera::microlens_system(LensIndex lens, LensSystem& own) const {
  const auto type = static_cast<std::size_t>(lattice_.type(lens));
  const double factor = lattice_.focal_factor(lens);
  if (factor == 1) return microlens_systems_[type];
  std::vector<SurfaceSpec> surfaces = microlens_systems_[type].surfaces();
  for (SurfaceSpec& surface : surfaces) surface.radius *= factor;
  own = LensSystem(std::move(surfaces), array_front_);
  return own;
}

/// Traces a ray through the faces of a real microlens, in the array's frame about its centre. A ray
/// outside of an aperture with sides ends at the first face where it meets them.
TraceStatus Camera::pass_faces(LensIndex lens, bool to_scene, Ray& ray, std::vector<Vec3>* points,
                               double& passed) const {
  LensSystem own;
  const LensSystem& system = microlens_system(lens, own);
  PassedLight light;
  PassedLight* const lost = spec_.transmission.fresnel ? &light : nullptr;
  std::vector<Vec3> met;
  std::vector<Vec3>* const path = points || aperture_.pairs() == 0 ? points : &met;
  const std::size_t first = path ? path->size() : 0;
  TraceStatus status =
      to_scene ? system.trace_to_scene(ray, path, lost) : system.trace_to_sensor(ray, path, lost);
  passed *= light.share;
  if (aperture_.pairs() == 0) return status;
  for (std::size_t i = first; i < path->size(); ++i) {
    const auto step = static_cast<int>(i - first);
    const int face = to_scene ? 1 - step : step;
    if (status.status != RayStatus::reached && status.surface == face) break;
    if (aperture_.holds({(*path)[i].x, (*path)[i].y})) continue;
    status = {RayStatus::vignetted, face};
    ray.origin = (*path)[i];
    path->resize(i + 1);
    break;
  }
  return status;
}

double Camera::microlens_power(LensIndex lens) const {
  const Microlens& type = microlenses_[static_cast<std::size_t>(lattice_.type(lens))];
  return 1.0 / (type.first_order.focal_length * lattice_.focal_factor(lens));
}

Ray Camera::to_array(const Ray& ray) const {
  if (!array_tilted_) return ray;
  const RigidTransform inverse = array_pose_.inverse();
  return {inverse.point(ray.origin), inverse.direction(ray.direction)};
}

Ray Camera::from_array(const Ray& ray) const {
  if (!array_tilted_) return ray;
  return {array_pose_.point(ray.origin), array_pose_.direction(ray.direction)};
}

PassedLight Camera::light_of_lens() const {
  const TransmissionSpec& t = spec_.transmission;
  return {t.coating_index, t.coating_wavelength, spec_.wavelength, 1};
}

double Camera::through_cover(Vec3 direction) const {
  const double index = spec_.transmission.cover_index;
  return index > 1 ? plate_transmission(index, std::fabs(direction.z)) : 1;
}

/// Traces a ray through the surfaces of a real main lens, in its frame.
TraceStatus Camera::trace_surfaces(Ray& ray, bool to_scene, std::vector<Vec3>* points,
                                   PassedLight* passed, int& pupil_part) const {
  std::vector<Vec3> met;
  std::vector<Vec3>* const path = points || pupil_filters_.empty() ? points : &met;
  const std::size_t first = path ? path->size() : 0;
  const TraceStatus status =
      to_scene ? lens_.trace_to_scene(ray, path, passed) : lens_.trace_to_sensor(ray, path, passed);
  if (pupil_filters_.empty()) return status;
  const auto stop = static_cast<std::size_t>(lens_first_order_.stop);
  const std::size_t at = first + (to_scene ? spec_.lens.surfaces.size() - 1 - stop : stop);
  if (at >= path->size()) return status;
  const double per_radius = 2 / spec_.lens.surfaces[stop].diameter;
  pupil_part = pupil_filters_.part_at(per_radius * Vec2{(*path)[at].x, (*path)[at].y});
  return status;
}

TraceStatus Camera::trace_main_lens(Ray& ray, std::vector<Vec3>* points, Path& path) const {
  const std::size_t first = points ? points->size() : 0;
  if (lens_moved_) {
    const RigidTransform inverse = lens_pose_.inverse();
    ray = {inverse.point(ray.origin), inverse.direction(ray.direction)};
  }
  PassedLight light = light_of_lens();
  const TraceStatus status =
      ideal_lens() ? trace_ideal(ray, points, path.pupil_part)
                   : trace_surfaces(ray, true, points,
                                    spec_.transmission.fresnel ? &light : nullptr, path.pupil_part);
  path.passed *= light.share;
  if (!lens_moved_) return status;
  ray = {lens_pose_.point(ray.origin), lens_pose_.direction(ray.direction)};
  if (points)
    for (std::size_t i = first; i < points->size(); ++i)
      (*points)[i] = lens_pose_.point((*points)[i]);
  return status;
}

std::optional<Vec2> Camera::at_stop(Vec2 sensor_point, LensIndex lens) const {
  const Vec3 place = lens_place(lens);
  return at_stop(sensor_point, lens, {place.x, place.y});
}

std::optional<Vec2> Camera::at_stop(Vec2 sensor_point, LensIndex lens, Vec2 aim) const {
  const Path path = trace_inside(sensor_point, lens, aim, true);
  if (path.status.status == RayStatus::missed) return std::nullopt;
  const RigidTransform to_lens = lens_pose_.inverse();
  if (ideal_lens()) {
    // The ray that left the lens gives the height at the front principal plane, and the power its
    // slope.
    if (path.status.status != RayStatus::reached && path.status.surface != 0) return std::nullopt;
    const Vec3 p = to_lens.point(path.exit.origin), d = to_lens.direction(path.exit.direction);
    const Vec2 height{p.x, p.y};
    const Vec2 slope = Vec2{d.x / d.z, d.y / d.z} + (1.0 / ideal_.focal_length) * height;
    return ideal_.stop_height * height + ideal_.stop_slope * slope;
  }
  const std::size_t before = 1 + (ideal_array() ? 1u : 2u);
  const std::size_t stop =
      before + spec_.lens.surfaces.size() - 1 - static_cast<std::size_t>(lens_first_order_.stop);
  if (path.points.size() <= stop) return std::nullopt;
  const Vec3 p = to_lens.point(path.points[stop]);
  return Vec2{p.x, p.y};
}

void Camera::place_lens() {
  const MainLensSpec& lens = spec_.lens;
  if (lens.surfaces.empty() && lens.model == LensModel::real)
    throw InputError(
        "camera.lens has no surfaces; give camera.lens.surfaces, or model = \"ideal\"");
  lens_first_order_ = first_order(lens);
  const FirstOrder& f = lens_first_order_;
  rear_vertex_ = -f.length;
  if (!std::isfinite(f.focal_length) || f.focal_length <= 0)
    throw InputError("camera.lens does not converge: its focal length is not positive");
  if (f.stop < 0)
    throw InputError("camera.lens has no aperture stop; mark one surface with stop = true");
  if (lens.model == LensModel::real) {
    lens_ = LensSystem(lens.surfaces);
    lens_is_round_ = is_round(lens);
    return;
  }
  ideal_.focal_length = f.focal_length;
  ideal_.rear_principal = rear_vertex_ - f.rear_principal;
  ideal_.front_principal = -f.front_principal;
  if (std::isfinite(f.exit_pupil)) {
    ideal_.stop_slope = (rear_vertex_ - f.exit_pupil) - ideal_.rear_principal;
    ideal_.stop_radius = 0.5 * f.exit_pupil_diameter;
  } else {
    const double distance = -f.entrance_pupil - ideal_.front_principal;
    ideal_.stop_height = 1 - distance / f.focal_length;
    ideal_.stop_slope = distance;
    ideal_.stop_radius = 0.5 * f.entrance_pupil_diameter;
  }
}

void Camera::place_array() {
  ArraySpec& array = spec_.array;
  if (!array.present) {
    sensor_ = rear_vertex_ - lens_distance_;
    array_front_ = array_back_ = sensor_;
    return;
  }
  lattice_ = MicrolensLattice(array);
  aperture_ = MicrolensAperture(array);
  const double diameter = 2 * aperture_.radius();
  const bool thin = ideal_array() && array.types.front().focal_length != 0;
  array_front_ = rear_vertex_ - lens_distance_;
  array_back_ = array_front_ - (thin ? 0 : array.thickness);
  const double gap =
      array.sensor_distance + (array.measured_from == ArrayReference::principal_plane
                                   ? first_order(array, array.types.front()).rear_principal
                                   : 0.0);
  if (!(gap > 0))
    throw InputError("camera.array.sensor_distance puts the sensor inside the microlenses");
  // The spec now holds the sensor's true distance, so that cameras made from it have the same
  // distances.
  array.sensor_distance += array.spacing_error;
  sensor_ = array_back_ - gap - array.spacing_error;
  array.spacing_error = 0;
  if (!(sensor_ < array_back_))
    throw InputError("camera.array.spacing_error puts the sensor inside the microlenses");
  for (const MicrolensSpec& type : array.types) {
    Microlens lens;
    lens.name = type.name;
    lens.first_order = first_order(array, type);
    lens.radius_front = type.radius_front;
    lens.radius_back = type.radius_back;
    lens.index = type.index;
    lens.rear_principal = array_back_ - lens.first_order.rear_principal;
    lens.front_principal = array_front_ - lens.first_order.front_principal;
    lens.sensor_distance = lens.rear_principal - sensor_;
    lens.sharp_distance = 1.0 / (1.0 / lens.first_order.focal_length - 1.0 / lens.sensor_distance);
    microlenses_.push_back(lens);
    microlens_systems_.emplace_back(
        std::vector<SurfaceSpec>{{type.radius_front, array.thickness, type.index, diameter, false},
                                 {-type.radius_back, 0, 1, diameter, false}},
        array_front_);
  }
}

int Camera::surface_count() const {
  const int lens = ideal_lens() ? 1 : static_cast<int>(spec_.lens.surfaces.size());
  return lens + (has_array() ? (ideal_array() ? 1 : 2) : 0);
}

std::string Camera::surface_name(int surface) const {
  const int lens = ideal_lens() ? 1 : static_cast<int>(spec_.lens.surfaces.size());
  if (surface < 0) return "none";
  if (surface < lens) {
    if (ideal_lens()) return "main lens (ideal)";
    const bool stop = spec_.lens.surfaces[static_cast<std::size_t>(surface)].stop;
    return "main lens surface " + std::to_string(surface + 1) + (stop ? " (stop)" : "");
  }
  if (ideal_array()) return "microlens (ideal)";
  return surface == lens ? "microlens front" : "microlens back";
}

double Camera::aim_plane(int type) const {
  if (!has_array()) return ideal_lens() ? ideal_.rear_principal : rear_vertex_;
  return ideal_array() ? microlenses_[static_cast<std::size_t>(type)].rear_principal : array_back_;
}

TraceStatus Camera::trace_ideal(Ray& ray, std::vector<Vec3>* points, int& pupil_part) const {
  const double t = (ideal_.rear_principal - ray.origin.z) / ray.direction.z;
  const Vec3 p = ray.at(t);
  const Vec2 slope{ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z};
  const Vec2 height{p.x, p.y};
  if (points) points->push_back(p);
  const Vec2 at_stop = ideal_.stop_height * height + ideal_.stop_slope * slope;
  if (!pupil_filters_.empty())
    pupil_part = pupil_filters_.part_at((1 / ideal_.stop_radius) * at_stop);
  const Vec2 out = slope - (1.0 / ideal_.focal_length) * height;
  ray = {{p.x, p.y, ideal_.front_principal}, normalize({out.x, out.y, 1})};
  if (points && ideal_.front_principal != ideal_.rear_principal) points->push_back(ray.origin);
  if (length(at_stop) > ideal_.stop_radius) return {RayStatus::vignetted, 0};
  return {};
}

Camera::Path Camera::trace(Vec2 sensor_point, std::optional<LensIndex> lens, Vec2 aim,
                           bool with_points) const {
  Path path = trace_inside(sensor_point, lens, aim, with_points);
  if (!distortion_.present() || path.status.status != RayStatus::reached) return path;
  const RigidTransform to_lens = lens_pose_.inverse();
  Ray ray{to_lens.point(path.exit.origin), to_lens.direction(path.exit.direction)};
  if (!distortion_.to_scene(ray)) path.status = {RayStatus::vignetted, 0};
  path.exit = {lens_pose_.point(ray.origin), lens_pose_.direction(ray.direction)};
  return path;
}

/// Traces a ray as if the main lens had no distortion.
Camera::Path Camera::trace_inside(Vec2 sensor_point, std::optional<LensIndex> lens, Vec2 aim,
                                  bool with_points) const {
  Path path;
  const int type = lens ? lattice_.type(*lens) : 0;
  const Vec3 start{sensor_point.x, sensor_point.y, sensor_};
  const Vec3 place = lens ? lens_place(*lens) : Vec3{0, 0, aim_plane(type)};
  const Vec3 target{aim.x, aim.y, place.z};
  Ray ray{start, normalize(target - start)};
  path.passed = through_cover(ray.direction);
  std::vector<Vec3>* points = with_points ? &path.points : nullptr;
  if (points) points->push_back(start);
  const int lens_surfaces = ideal_lens() ? 1 : static_cast<int>(spec_.lens.surfaces.size());
  if (lens) {
    const Vec2 centre = lattice_.centre(*lens);
    ray = to_array(ray);
    ray.origin.x -= centre.x;
    ray.origin.y -= centre.y;
    const std::size_t first = path.points.size();
    if (ideal_array()) {
      const Microlens& microlens = microlenses_[static_cast<std::size_t>(type)];
      Vec3 p{aim.x - centre.x, aim.y - centre.y, microlens.rear_principal};
      if (array_tilted_) p = ray.at((microlens.rear_principal - ray.origin.z) / ray.direction.z);
      const double k = microlens_power(*lens);
      if (points) points->push_back(p);
      if (aperture_.pairs() > 0 ? !aperture_.holds({p.x, p.y})
                                : std::hypot(p.x, p.y) > aperture_.radius())
        path.status = {RayStatus::vignetted, lens_surfaces};
      ray = {{p.x, p.y, microlens.front_principal},
             normalize({ray.direction.x / ray.direction.z - k * p.x,
                        ray.direction.y / ray.direction.z - k * p.y, 1})};
    } else {
      path.status = pass_faces(*lens, true, ray, points, path.passed);
      if (path.status.status != RayStatus::reached) path.status.surface += lens_surfaces;
    }
    ray.origin.x += centre.x;
    ray.origin.y += centre.y;
    ray = from_array(ray);
    for (std::size_t i = first; i < path.points.size(); ++i) {
      path.points[i].x += centre.x;
      path.points[i].y += centre.y;
      if (array_tilted_) path.points[i] = array_pose_.point(path.points[i]);
    }
  }
  if (!lens && has_array() && !passes_between(ray)) {
    path.status = {RayStatus::vignetted, lens_surfaces};
    if (points) points->push_back(ray.at((array_front_ - ray.origin.z) / ray.direction.z));
  }
  if (path.status.status == RayStatus::reached) path.status = trace_main_lens(ray, points, path);
  path.exit = ray;
  return path;
}

}  // namespace plenoflame
