#include "plenoflame/lightfield/micro_images.h"

#include "lightfield/outward_frame.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/camera/design.h"
#include "plenoflame/camera/pupil_sampling.h"
#include "plenoflame/optics/surface_shape.h"

namespace plenoflame {
namespace {

constexpr int kDegree = 5;
constexpr std::size_t kTerms = 21;  ///< (kDegree + 1) (kDegree + 2) / 2

/// The monomials x^i y^j, i + j <= kDegree.
std::array<double, kTerms> monomials(Vec2 p) {
  std::array<double, kTerms> terms{};
  std::size_t k = 0;
  double y = 1;
  for (int j = 0; j <= kDegree; ++j) {
    double term = y;
    for (int i = 0; i + j <= kDegree; ++i) {
      terms[k++] = term;
      term *= p.x;
    }
    y *= p.y;
  }
  return terms;
}

double sum(const std::array<double, kTerms>& a, const std::array<double, kTerms>& b) {
  double total = 0;
  for (std::size_t k = 0; k < kTerms; ++k) total += a[k] * b[k];
  return total;
}

/// Puts array and sensor at the camera's places, for any lens.
CameraSpec in_place(CameraSpec spec, const Camera& camera) {
  spec.focus.mode = FocusMode::distance;
  spec.focus.lens_distance = camera.lens_distance();
  spec.array.sensor_distance = camera.array_back() - camera.sensor();
  spec.array.measured_from = ArrayReference::vertex;
  return spec;
}

/// The camera with a single microlens of one type that stands at (h, 0), everything else in place.
CameraSpec single_type(const Camera& camera, std::size_t type) {
  CameraSpec spec = camera.spec();
  spec.lens.distortion = {};
  spec.lens.decentre = spec.lens.tilt = spec.array.tilt = {};
  spec.lens = round_counterpart(std::move(spec.lens));
  spec.array.focal_jitter = 0;
  spec.array.types = {spec.array.types[type]};
  // The white image is taken to be alike all around the axis: that of a circle of the same area.
  if (const MicrolensAperture& aperture = camera.aperture(); aperture.pairs() > 0) {
    spec.array.aperture = ApertureShape::circular;
    spec.array.diameter = 2 * std::sqrt(aperture.area() / constants::pi);
  }
  spec.array.rotation = 0;
  return in_place(std::move(spec), camera);
}

/// The same with wider apertures of the main lens. Rays at the rim of the stop then get through,
/// and the fit needs no extrapolation.
CameraSpec opened(CameraSpec spec) {
  spec.lens.diameter *= 1.1;
  for (SurfaceSpec& surface : spec.lens.surfaces) {
    surface.diameter *= surface.stop ? 1.1 : 1.4;
    if (!is_round(surface))
      surface.diameter = std::min(surface.diameter, 1.99 * greatest_height(surface));
    else if (std::isfinite(surface.radius))
      surface.diameter = std::min(surface.diameter, 1.99 * std::fabs(surface.radius));
  }
  return spec;
}

Camera at_distance(CameraSpec spec, double h) {
  spec.array.offset = {h, 0};
  return Camera(spec);
}

}  // namespace

void check_raw_image(const LightField& light_field, const CameraSpec& camera,
                     const std::string& what) {
  if (light_field.unit != "W" && light_field.unit != "e-" && light_field.unit != "DN")
    throw InputError(what + " is not a raw image: it holds " + light_field.unit +
                     ", not the flux of pixels in W, their electrons or their counts");
  if (camera.sensor.columns != light_field.sensor_width ||
      camera.sensor.rows != light_field.sensor_height)
    throw InputError("the scene's sensor has " + std::to_string(camera.sensor.columns) + " x " +
                     std::to_string(camera.sensor.rows) + " pixels, that of " + what + " " +
                     std::to_string(light_field.sensor_width) + " x " +
                     std::to_string(light_field.sensor_height) +
                     ": it is not a raw image of this camera");
  if (!camera.array.present)
    throw InputError("the camera of " + what +
                     " has no microlens array: its picture is a single view; use develop");
}

MicroImages::MicroImages(const Camera& camera, bool white, const Execution& execution)
    : camera_(camera) {
  if (!camera.has_array()) throw InputError("a camera without microlens array has no micro-images");
  const PupilSampling pupils(camera.lens_is_round() ? camera : camera.aligned(), execution);
  if (!camera.lens_is_round()) {
    CameraSpec spec = in_place(opened(camera.spec()), camera);
    spec.lens.distortion = {};
    open_ = std::make_shared<const Camera>(spec);
  }
  const std::size_t types = pupils.tables().size();
  nodes_.resize(types);
  step_.resize(types);
  for (std::size_t type = 0; type < types; ++type) {
    const PupilTable& table = pupils.tables()[type];
    const CameraSpec own = single_type(camera, type), open = opened(own);
    step_[type] = table.field_step;
    nodes_[type].resize(table.nodes.size());
    const double share = 1.0 / static_cast<double>(types);
    const Execution part = part_of_progress(execution, share * static_cast<double>(type), share);
    const bool done = reported_parallel_for(part, table.nodes.size(), [&](std::size_t i, int) {
      const PupilNode& pupil = table.nodes[i];
      Node& node = nodes_[type][i];
      if (pupil.dark()) return;
      node.dark = false;
      node.centre = pupil.centre;
      node.radius = pupil.image_radius;
      const double h = static_cast<double>(i) * table.field_step;
      const Camera wide = at_distance(open, h);
      const Vec2 lens = wide.lattice().centre({0, 0});
      const auto lines =
          fit_lines(wide, {0, 0}, lens, {lens.x + node.centre, 0}, node.radius, {1, 0});
      node.dark = !lines;
      if (lines) node.line = *lines;
      if (const auto stop = wide.at_stop({h + node.centre, 0}, LensIndex{})) node.stop = stop->x;
      if (white && !node.dark) fill_white(at_distance(own, h), node, pupil.outer_radius);
    });
    if (!done) throw Cancelled();
  }
  for (const std::vector<Node>& nodes : nodes_)
    for (const Node& node : nodes) reach_ = std::max(reach_, node.reach);
  if (camera.misaligned()) find_centres(execution);
  const Vec2 here = place({0, 0}).centre;
  spacing_ = std::min(length(place({1, 0}).centre - here), length(place({0, 1}).centre - here));
}

/// The lines of the chief rays of a micro-image, in the frame of the main lens, along and across
/// `outwards`.
/// @param aim the middle of the microlens @return none where too little gets through
std::optional<MicroImages::Lines> MicroImages::fit_lines(const Camera& open, LensIndex lens,
                                                         Vec2 aim, Vec2 centre, double radius,
                                                         Vec2 outwards) {
  const RigidTransform to_lens = open.lens_pose().inverse();
  std::vector<std::array<double, kTerms>> rows;
  std::vector<std::array<double, 4>> values;
  for (int ring = 0; ring <= 5; ++ring) {
    const int count = ring == 0 ? 1 : 6 * ring;
    for (int k = 0; k < count; ++k) {
      const double angle = 2 * constants::pi * (k + 0.5 * (ring % 2)) / count;
      const Vec2 p{0.2 * ring * std::cos(angle), 0.2 * ring * std::sin(angle)};
      const Camera::Path path = open.trace(centre + to_camera(radius * p, outwards), lens, aim);
      if (path.status.status != RayStatus::reached) continue;
      const bool moved = open.lens_moved();
      const Vec3 d = moved ? to_lens.direction(path.exit.direction) : path.exit.direction,
                 o = moved ? to_lens.point(path.exit.origin) : path.exit.origin;
      const Vec2 slope{d.x / d.z, d.y / d.z};
      const Vec2 start = to_local({o.x - o.z * slope.x, o.y - o.z * slope.y}, outwards),
                 turned = to_local(slope, outwards);
      rows.push_back(monomials(p));
      values.push_back({start.x, start.y, turned.x, turned.y});
    }
  }
  if (rows.size() < 2 * kTerms) return std::nullopt;  // too little to say where rays go
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd a(n, static_cast<Eigen::Index>(kTerms)), b(n, 4);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < kTerms; ++k)
      a(i, static_cast<Eigen::Index>(k)) = rows[static_cast<std::size_t>(i)][k];
    for (std::size_t k = 0; k < 4; ++k)
      b(i, static_cast<Eigen::Index>(k)) = values[static_cast<std::size_t>(i)][k];
  }
  const Eigen::MatrixXd x = a.colPivHouseholderQr().solve(b);
  Lines lines{};
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t t = 0; t < kTerms; ++t)
      lines[k][t] = x(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(k));
  return lines;
}

/// Finds every centre by itself, for microlenses that differ at one distance from the axis.
void MicroImages::find_centres(const Execution& execution) {
  const SensorSpec& sensor = camera_.spec().sensor;
  const double margin = 4 * longest_pitch(camera_.spec().array) + length(camera_.foot());
  const Vec2 corner = camera_.sensor_point(0, 0);
  const Vec2 most{corner.x + margin, corner.y + margin};
  const std::vector<LensIndex> lenses = camera_.lattice().within(-1.0 * most, most);
  if (lenses.empty()) return;
  LensIndex low = lenses.front(), high = low;
  for (const LensIndex lens : lenses) {
    low = {std::min(low.q, lens.q), std::min(low.r, lens.r)};
    high = {std::max(high.q, lens.q), std::max(high.r, lens.r)};
  }
  Centres centres;
  centres.low = low;
  centres.columns = high.q - low.q + 1;
  centres.rows = high.r - low.r + 1;
  const double none = std::numeric_limits<double>::quiet_NaN();
  centres.values.assign(
      static_cast<std::size_t>(centres.columns) * static_cast<std::size_t>(centres.rows),
      Vec2{none, none});
  constexpr std::size_t kPart = 256;
  const std::size_t parts = (lenses.size() + kPart - 1) / kPart;
  const bool done = parallel_for(execution, parts, [&](std::size_t part, int) {
    for (std::size_t k = part * kPart; k < std::min(lenses.size(), (part + 1) * kPart); ++k)
      centres.values[centres.index(lenses[k])] = find_centre(lenses[k], 1e-7 * sensor.pixel_pitch);
  });
  if (!done) throw Cancelled();
  centres_ = std::move(centres);
}

/// The sensor point from which the ray through the middle of the lens meets the stop where that of
/// the aligned camera does.
Vec2 MicroImages::find_centre(LensIndex lens, double accuracy) const {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const Place nominal = aligned_place(lens);
  if (nominal.dark) return {none, none};
  const std::vector<Node>& nodes = nodes_[static_cast<std::size_t>(nominal.type)];
  const auto i = static_cast<std::size_t>(nominal.node);
  const double t = nominal.node - static_cast<double>(i);
  const Vec2 target = ((1 - t) * nodes[i].stop + t * nodes[i + 1].stop) * nominal.outwards;
  const double step = 1e-3 * camera_.spec().sensor.pixel_pitch;
  Vec2 s = nominal.centre;
  for (int k = 0; k < 12; ++k) {
    const auto at = camera_.at_stop(s, lens), right = camera_.at_stop(s + Vec2{step, 0}, lens),
               up = camera_.at_stop(s + Vec2{0, step}, lens);
    if (!at || !right || !up) return {none, none};
    const Vec2 u = (1 / step) * (*right - *at), v = (1 / step) * (*up - *at), miss = *at - target;
    const double determinant = u.x * v.y - v.x * u.y;
    if (determinant == 0) return {none, none};
    const Vec2 change{(v.y * miss.x - v.x * miss.y) / determinant,
                      (u.x * miss.y - u.y * miss.x) / determinant};
    s = s - change;
    if (length(change) < accuracy) return s;
  }
  return {none, none};
}

MicroImages::Place MicroImages::place(LensIndex lens) const {
  Place place = aligned_place(lens);
  if (!camera_.misaligned() || place.dark) return place;
  place.dark = true;
  if (centres_.values.empty() || !centres_.holds(lens)) return place;
  place.centre = centres_.values[centres_.index(lens)];
  place.dark = std::isnan(place.centre.x);
  return place;
}

/// As in an aligned camera; in a misaligned one the centre is a first guess.
MicroImages::Place MicroImages::aligned_place(LensIndex lens) const {
  Place place;
  place.lens = lens;
  place.type = camera_.lattice().type(lens);
  const auto type = static_cast<std::size_t>(place.type);
  const Vec3 lens_place = camera_.lens_place(lens);
  // The place of the lens in the field of the main lens.
  const Vec3 in_lens =
      camera_.lens_moved() ? camera_.lens_pose().inverse().point(lens_place) : lens_place;
  const Vec2 middle{in_lens.x, in_lens.y};
  const double h = length(middle);
  place.centre = middle;
  if (h > 0) place.outwards = (1 / h) * middle;
  place.node = h / step_[type];
  const std::vector<Node>& nodes = nodes_[type];
  const auto i = static_cast<std::size_t>(place.node);
  if (i + 1 >= nodes.size() || nodes[i].dark || nodes[i + 1].dark) return place;
  const double t = place.node - static_cast<double>(i);
  place.dark = false;
  const double shift = (1 - t) * nodes[i].centre + t * nodes[i + 1].centre;
  place.centre = middle + shift * place.outwards;
  place.radius = (1 - t) * nodes[i].radius + t * nodes[i + 1].radius;
  if (!camera_.misaligned()) return place;
  // Straight on from the middle of the exit pupil.
  const Vec2 from_foot = Vec2{lens_place.x, lens_place.y} - camera_.foot();
  place.centre = Vec2{lens_place.x, lens_place.y} + (h > 0 ? shift / h : 0.0) * from_foot;
  place.radius *=
      (lens_place.z - camera_.sensor()) / (camera_.aim_plane(place.type) - camera_.sensor());
  return place;
}

/// Mixed between the tables' nodes; of a main lens that is not round, where no two micro-images
/// need be alike, those of this one itself.
MicroImages::Lines MicroImages::lines_of(const Place& place) const {
  if (open_) {
    const Vec3 middle = open_->lens_place(place.lens);
    if (const auto lines = fit_lines(*open_, place.lens, {middle.x, middle.y}, place.centre,
                                     place.radius, place.outwards))
      return *lines;
  }
  const std::vector<Node>& nodes = nodes_[static_cast<std::size_t>(place.type)];
  const auto i = static_cast<std::size_t>(place.node);
  const double t = place.node - static_cast<double>(i);
  Lines lines{};
  for (std::size_t which = 0; which < lines.size(); ++which)
    for (std::size_t k = 0; k < kTerms; ++k)
      lines[which][k] = (1 - t) * nodes[i].line[which][k] + t * nodes[i + 1].line[which][k];
  return lines;
}

void MicroImages::look_through(const std::vector<WindowSpec>& windows) {
  windows_ = windows.empty() ? nullptr : std::make_shared<const WindowSet>(windows);
}

MicroImages::ToPlane MicroImages::to_plane(const Place& place, double depth) const {
  ToPlane plane;
  plane.place_ = place;
  // The tables hold lines in the frame of the main lens, without its distortion.
  if (camera_.lens_moved() || camera_.distortion().present() || windows_) {
    plane.distortion_ = camera_.distortion();
    plane.pose_ = camera_.lens_pose();
    plane.to_world_ = camera_.to_world();
    plane.windows_ = windows_;
    plane.depth_ = depth;
    ToPlane& second = plane.second_.emplace_back();
    second.place_ = place;
    const Lines lines = lines_of(place);
    set_plane(place, lines, 0, plane);
    set_plane(place, lines, 1, second);
    return plane;
  }
  set_plane(place, lines_of(place), depth, plane);
  return plane;
}

void MicroImages::set_plane(const Place& place, const Lines& lines, double depth, ToPlane& plane) {
  const auto& [x0, y0, x1, y1] = lines;
  for (std::size_t k = 0; k < kTerms; ++k) {
    const double along = x0[k] + depth * x1[k], across = y0[k] + depth * y1[k];
    const Vec2 c = to_camera({along, across}, place.outwards);
    plane.x_[k] = c.x;
    plane.y_[k] = c.y;
  }
}

Vec2 MicroImages::ToPlane::operator()(Vec2 sensor_point) const {
  const auto terms =
      monomials((1 / place_.radius) * to_local(sensor_point - place_.centre, place_.outwards));
  const Vec2 here{sum(x_, terms), sum(y_, terms)};
  if (second_.empty()) return here;
  const Ray ray = ray_at(sensor_point);
  const Vec3 a = ray.origin, d = ray.direction;
  const double t = (depth_ - a.z) / d.z;
  return {a.x + t * d.x, a.y + t * d.y};
}

/// The straight part of the chief ray's way that crosses the plane, in the camera's frame; its
/// direction is not a unit vector.
Ray MicroImages::ToPlane::ray_at(Vec2 sensor_point) const {
  const auto terms =
      monomials((1 / place_.radius) * to_local(sensor_point - place_.centre, place_.outwards));
  const ToPlane& second = second_.front();
  const Vec3 start{sum(x_, terms), sum(y_, terms), 0};
  Ray line{start, Vec3{sum(second.x_, terms), sum(second.y_, terms), 1} - start};
  if (distortion_.present()) distortion_.to_scene(line);
  const Vec3 a = pose_.point(line.origin), b = pose_.point(line.origin + line.direction);
  const Ray straight{a, b - a};
  if (!windows_) return straight;
  // From the plane of the front vertex on, stretch by stretch; rays that end at a window continue
  // behind it.
  const Vec3 front = a + (-a.z / (b.z - a.z)) * (b - a);
  WindowPath path;
  windows_->trace({to_world_.point(front), to_world_.direction(normalize(b - a))}, path);
  const RigidTransform to_camera = to_world_.inverse();
  Vec3 before = front;
  for (std::size_t k = 0; k < path.segments.size(); ++k) {
    const AirSegment& stretch = path.segments[k];
    const Ray ray{to_camera.point(stretch.ray.origin), to_camera.direction(stretch.ray.direction)};
    // A plane within the glass: between the faces the way is straight, too.
    if (k > 0 && depth_ < ray.origin.z) return {before, ray.origin - before};
    if (k + 1 == path.segments.size() || depth_ <= ray.at(stretch.far).z) return ray;
    before = ray.at(stretch.far);
  }
  return straight;
}

MicroImages::Line MicroImages::chief_ray(const Place& place, Vec2 sensor_point) const {
  if (windows_) {
    const FocusSpec& focus = camera_.spec().focus;
    const double depth =
        focus.mode == FocusMode::distance
            ? paraxial_object_distance(camera_.lens_first_order(), camera_.lens_distance())
            : focus.object_distance;
    const Ray ray = to_plane(place, depth > 0 ? depth : kInfinity).ray_at(sensor_point);
    const Vec2 slope{ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z};
    return {Vec2{ray.origin.x, ray.origin.y} - ray.origin.z * slope, slope};
  }
  const Vec2 start = to_plane(place, 0)(sensor_point), end = to_plane(place, 1)(sensor_point);
  return {start, end - start};
}

}  // namespace plenoflame
