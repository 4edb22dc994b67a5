#include "render/ray_path_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "plenoflame/math/ray_span.h"

namespace plenoflame {

/// Appends the vertices of one ray.
class PathTracer::Vertices {
 public:
  Vertices(RayPath& ray, RayPaths& paths) : ray_(ray), paths_(paths) {
    ray.first = paths.vertices.size();
  }
  void push(Vec3 world, int surface, double index, const MediumSample& here = {}) {
    if (paths_.vertices.size() > ray_.first)
      distance_ += length(world - paths_.vertices.back().position);
    paths_.vertices.push_back(
        {world, surface, index, distance_, here.temperature, here.absorption});
  }
  void finish() {
    ray_.count = paths_.vertices.size() - ray_.first;
    paths_.rays.push_back(ray_);
  }

 private:
  RayPath& ray_;
  RayPaths& paths_;
  double distance_ = 0;
};

PathTracer::PathTracer(const Camera& camera, const Medium& medium, const SurfaceScene* surfaces)
    : camera_(camera), medium_(medium), surfaces_(surfaces), box_(medium.bounds()) {
  steps_.push_back(kSensorVertex);
  lens_surfaces_ =
      camera.surface_count() - (camera.has_array() ? (camera.ideal_array() ? 1 : 2) : 0);
  for (int s = camera.surface_count() - 1; s >= 0; --s) {
    steps_.push_back(s);
    const IdealLens& ideal = camera.ideal();
    if (s < lens_surfaces_ && camera.ideal_lens() && ideal.front_principal != ideal.rear_principal)
      steps_.push_back(s);
  }
}

double PathTracer::index_behind(int surface, int type, bool to_scene) const {
  if (surface < 0) return 1;
  if (surface >= lens_surfaces_) {
    const int glass = to_scene ? lens_surfaces_ + 1 : lens_surfaces_;
    return surface == glass && !camera_.ideal_array() && type >= 0
               ? camera_.microlenses()[static_cast<std::size_t>(type)].index
               : 1;
  }
  if (camera_.ideal_lens()) return 1;
  const auto& surfaces = camera_.lens().surfaces();
  const auto s = static_cast<std::size_t>(surface);
  if (to_scene) return s == 0 ? 1 : surfaces[s - 1].index;
  return surfaces[s].index;
}

void PathTracer::add_flames(const Ray& ray, double from, double to, bool beside, Vertices& vertices,
                            int samples) const {
  const auto [near, far] = clip_to_box(box_, ray, from, to);
  const auto push = [&](double t, int surface) {
    vertices.push(ray.at(t), surface, 1, medium_.sample(ray.at(t)));
  };
  if (near < far) {
    if (near > from) push(near, kSceneVertex);
    for (int i = 1; i <= samples; ++i) push(near + (far - near) * i / (samples + 1), kFlameVertex);
    if (far < to) push(far, kSceneVertex);
  } else if (beside) {
    const double middle = dot(0.5 * (box_.lower + box_.upper) - ray.origin, ray.direction);
    if (middle > 0) vertices.push(ray.at(middle), kSceneVertex, 1);
  }
}

void PathTracer::add(Vec2 start, std::optional<LensIndex> lens, Vec2 aim, RayPath& ray,
                     RayPaths& paths) const {
  const Camera::Path path = camera_.trace(start, lens, aim, true);
  ray.status = path.status;
  ray.weight *= path.passed;
  Vertices vertices(ray, paths);
  // Where a ray was that missed a surface is nowhere.
  const std::size_t points = path.points.size() - (path.status.status == RayStatus::missed ? 1 : 0);
  // What goes between the microlenses skips their faces, but for the one where it may end.
  std::size_t skipped = 0;
  if (!lens && camera_.has_array())
    skipped = (camera_.ideal_array() ? 1u : 2u) -
              (ray.status.status != RayStatus::reached && ray.status.surface >= lens_surfaces_);
  for (std::size_t i = 0; i < points; ++i) {
    const int step = steps_[i > 0 ? i + skipped : 0];
    vertices.push(camera_.to_world().point(path.points[i]), step,
                  index_behind(step, ray.type, true));
  }
  if (path.status.status == RayStatus::reached) {
    const Ray exit{camera_.to_world().point(path.exit.origin),
                   camera_.to_world().direction(path.exit.direction)};
    constexpr double kInf = std::numeric_limits<double>::infinity();
    SurfaceHit hit;
    const bool ends = surfaces_ && surfaces_->intersect(exit, 0, kInf, {}, hit);
    add_flames(exit, 0, ends ? hit.t : kInf, !ends, vertices, paths.flame_samples);
    if (ends) {
      ray.solid = hit.where.surface;
      vertices.push(exit.at(hit.t), kSolidVertex, 1, medium_.sample(exit.at(hit.t)));
    }
  }
  vertices.finish();
}

void PathTracer::add_from_scene(const Ray& from, RayPath& ray, RayPaths& paths) const {
  const RigidTransform to_camera = camera_.to_world().inverse();
  std::vector<Camera::Arrival> arrivals;
  std::vector<Vec3> points;
  ray.status = camera_.trace_from_scene(
      {to_camera.point(from.origin), to_camera.direction(from.direction)}, arrivals, &points);
  if (ray.status.status == RayStatus::missed) points.pop_back();
  ray.column = ray.row = -1;
  if (!arrivals.empty()) {
    const Camera::Arrival& arrival = arrivals.front();
    if (arrival.lens) {
      ray.lens = *arrival.lens;
      ray.type = camera_.lattice().type(ray.lens);
    }
    const SensorSpec& sensor = camera_.spec().sensor;
    const double column = 0.5 * sensor.columns - arrival.sensor_point.x / sensor.pixel_pitch;
    const double row = 0.5 * sensor.rows - arrival.sensor_point.y / sensor.pixel_pitch;
    if (column >= 0 && row >= 0 && column < sensor.columns && row < sensor.rows) {
      ray.column = static_cast<int>(column);
      ray.row = static_cast<int>(row);
    }
  } else if (camera_.has_array() && static_cast<int>(points.size()) > lens_surfaces_) {
    // It ended at the array: the lens in whose place.
    const Vec3 last = points.back();
    ray.lens = camera_.lattice().nearest({last.x, last.y});
    ray.type = camera_.lattice().type(ray.lens);
  }
  const double front =
      points.empty() ? 0 : length(camera_.to_world().point(points.front()) - from.origin);
  // The point may lie on a surface itself, which does not hide it from the side that it looks to.
  SurfaceHit hit;
  const double clear = 1e-9 * front;
  const bool hidden = surfaces_ && surfaces_->intersect(from, clear, front - clear, {}, hit);
  if (hidden) {
    ray.status = {RayStatus::missed, -1};
    ray.column = ray.row = -1;
    ray.lens = {};
    ray.type = -1;
    ray.solid = hit.where.surface;
  }
  Vertices vertices(ray, paths);
  vertices.push(from.origin, kObjectVertex, 1, medium_.sample(from.origin));
  if (hidden) {
    add_flames(from, 0, hit.t, false, vertices, paths.flame_samples);
    vertices.push(from.at(hit.t), kSolidVertex, 1, medium_.sample(from.at(hit.t)));
    vertices.finish();
    return;
  }
  add_flames(from, 0, front, false, vertices, paths.flame_samples);
  // From the scene on, the same steps backwards; one that went past the array skips its surfaces.
  const bool between = !arrivals.empty() && camera_.has_array() && !arrivals.front().lens;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool last = i + 1 == points.size();
    const int step = last && !arrivals.empty() ? kSensorVertex : steps_[steps_.size() - 1 - i];
    vertices.push(camera_.to_world().point(points[i]), step,
                  between && last ? 1 : index_behind(step, ray.type, false));
  }
  vertices.finish();
}

std::vector<double> carried_by(const Medium& medium, const Ray& ray, double from, double to) {
  const Box box = medium.bounds();
  RayBatch<double> batch;
  batch.size = kRayPadding;
  batch.anchor = 0.5 * (box.lower + box.upper);
  const Vec3 at = ray.origin - batch.anchor;
  // A batch is 16 rays at least: this one, repeated.
  alignas(64) std::array<std::array<double, kRayPadding>, 8> lines{};
  const std::array<double, 8> values{
      at.x, at.y, at.z, ray.direction.x, ray.direction.y, ray.direction.z, from, to};
  for (std::size_t k = 0; k < values.size(); ++k) lines[k].fill(values[k]);
  batch.x = lines[0].data();
  batch.y = lines[1].data();
  batch.z = lines[2].data();
  batch.dx = lines[3].data();
  batch.dy = lines[4].data();
  batch.dz = lines[5].data();
  if (std::isfinite(from)) batch.t_near = lines[6].data();
  if (std::isfinite(to)) batch.t_far = lines[7].data();
  struct alignas(64) Lane {
    std::array<double, kRayPadding> values;
  };
  const auto channels = static_cast<std::size_t>(medium.channel_count());
  std::vector<Lane> lanes(channels + 1);
  RadianceBatch<double> out;
  out.radiance = lanes[0].values.data();
  out.stride = kRayPadding;
  out.transmittance = lanes[channels].values.data();
  MediumCounters counters;
  medium.integrate(batch, {}, out, counters);
  std::vector<double> carried;
  for (std::size_t c = 0; c < channels; ++c) carried.push_back(lanes[c].values[0]);
  carried.push_back(std::fabs(std::log(lanes[channels].values[0])));
  return carried;
}

}  // namespace plenoflame
