#include "render/paths/ray_path_tracer.h"

#include <algorithm>
#include <cmath>

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

PathTracer::PathTracer(const CompiledScene& scene, const Medium& medium)
    : camera_(scene.camera),
      medium_(medium),
      surfaces_(scene.surfaces.get()),
      box_(medium.bounds()),
      windows_(scene.windows.get()),
      empty_(scene),
      aim_(scene, 0.5 * (box_.lower + box_.upper), 0.5 * length(box_.upper - box_.lower)) {
  const Camera& camera = camera_;
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

std::optional<Ray> PathTracer::add(Vec2 start, std::optional<LensIndex> lens, Vec2 aim,
                                   RayPath& ray, RayPaths& paths) const {
  const Camera::Path path = camera_.trace(start, lens, aim, true);
  ray.status = path.status;
  ray.pupil_part = path.pupil_part;
  ray.weight *= path.passed;
  Vertices vertices(ray, paths);
  // A ray that missed a surface has no point there.
  const std::size_t points = path.points.size() - (path.status.status == RayStatus::missed ? 1 : 0);
  // A ray between the microlenses skips their faces, except for a face where it ends.
  std::size_t skipped = 0;
  if (!lens && camera_.has_array())
    skipped = (camera_.ideal_array() ? 1u : 2u) -
              (ray.status.status != RayStatus::reached && ray.status.surface >= lens_surfaces_);
  for (std::size_t i = 0; i < points; ++i) {
    const int step = steps_[i > 0 ? i + skipped : 0];
    vertices.push(camera_.to_world().point(path.points[i]), step,
                  index_behind(step, ray.type, true));
  }
  std::optional<Ray> exit;
  if (path.status.status == RayStatus::reached) {
    exit = {camera_.to_world().point(path.exit.origin),
            camera_.to_world().direction(path.exit.direction)};
    WorldPaths world = empty_;
    const WorldPath& way = world.trace(*exit);
    const std::span<const AirSegment> stretches = world.stretches(way);
    const AirSegment& last = stretches.back();
    add_stretches(stretches, way.open, paths.flame_samples, vertices);
    if (way.hit >= 0) {
      ray.solid = world.hit(way).where.surface;
      const Vec3 place = last.ray.at(last.far);
      vertices.push(place, kSolidVertex, 1, medium_.sample(place));
    } else if (!way.open && length(world.stop() - last.ray.at(last.far)) > 0) {
      vertices.push(world.stop(), kWindowVertex, 1);
    }
  }
  vertices.finish();
  return exit;
}

/// Adds stretches in air and the faces of windows between them.
void PathTracer::add_stretches(std::span<const AirSegment> segments, bool beside, int samples,
                               Vertices& vertices) const {
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const AirSegment& segment = segments[k];
    if (k > 0) vertices.push(segment.ray.origin, kWindowVertex, 1);
    add_flames(segment.ray, 0, segment.far, beside && k + 1 == segments.size(), vertices, samples);
    if (segment.window >= 0)
      vertices.push(segment.ray.at(segment.far), kWindowVertex, windows_->index(segment.window));
  }
}

void PathTracer::add_from_scene(const Ray& from, RayPath& ray, RayPaths& paths) const {
  std::vector<Camera::Arrival> arrivals;
  std::vector<Vec3> points;
  Ray arriving;
  WindowPath way;
  if (!aim_.follow(from, way, arriving)) {
    ray.status = {RayStatus::missed, -1};
    ray.column = ray.row = -1;
    Vertices vertices(ray, paths);
    vertices.push(from.origin, kObjectVertex, 1, medium_.sample(from.origin));
    add_stretches(way.segments, !way.stopped, paths.flame_samples, vertices);
    if (way.stopped) vertices.push(way.stop, kWindowVertex, 1);
    vertices.finish();
    return;
  }
  ray.status = camera_.trace_from_scene(arriving, arrivals, &points);
  if (ray.status.status == RayStatus::missed) points.pop_back();
  ray.column = ray.row = -1;
  if (!arrivals.empty()) {
    ray.pupil_part = arrivals.front().pupil_part;
    const Camera::Arrival& arrival = arrivals.front();
    if (arrival.lens) {
      ray.lens = *arrival.lens;
      ray.type = camera_.lattice().type(ray.lens);
    }
    const SensorSpec& sensor = camera_.spec().sensor;
    const auto [column, row] = camera_.image_point(arrival.sensor_point);
    if (column >= 0 && row >= 0 && column < sensor.columns && row < sensor.rows) {
      ray.column = static_cast<int>(column);
      ray.row = static_cast<int>(row);
    }
  } else if (camera_.has_array() && static_cast<int>(points.size()) > lens_surfaces_) {
    // The ray ended at the array: its microlens is the one at that place.
    const Vec3 last = points.back();
    ray.lens = camera_.lattice().nearest({last.x, last.y});
    ray.type = camera_.lattice().type(ray.lens);
  }
  AirSegment& last_stretch = way.segments.back();
  const double front =
      points.empty() ? 0
                     : length(camera_.to_world().point(points.front()) - last_stretch.ray.origin);
  last_stretch.far = front;
  // The point may lie on a surface, which does not hide it from the side that the surface faces.
  SurfaceHit hit;
  const double clear = 1e-9 * front;
  bool hidden = false;
  for (std::size_t k = 0; surfaces_ && !hidden && k < way.segments.size(); ++k) {
    AirSegment& stretch = way.segments[k];
    hidden =
        surfaces_->intersect(stretch.ray, k == 0 ? clear : 0.0,
                             k + 1 == way.segments.size() ? front - clear : stretch.far, {}, hit);
    if (!hidden) continue;
    stretch.far = hit.t;
    stretch.window = -1;
    way.segments.resize(k + 1);
  }
  if (hidden) {
    ray.status = {RayStatus::missed, -1};
    ray.column = ray.row = -1;
    ray.lens = {};
    ray.type = -1;
    ray.solid = hit.where.surface;
  }
  Vertices vertices(ray, paths);
  vertices.push(from.origin, kObjectVertex, 1, medium_.sample(from.origin));
  add_stretches(way.segments, false, paths.flame_samples, vertices);
  if (hidden) {
    const Vec3 place = way.segments.back().ray.at(hit.t);
    vertices.push(place, kSolidVertex, 1, medium_.sample(place));
    vertices.finish();
    return;
  }
  // The steps are those of a ray to the scene in reverse; a ray beside the microlenses skips their
  // surfaces.
  const bool between = !arrivals.empty() && camera_.has_array() && !arrivals.front().lens;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool last = i + 1 == points.size();
    const int step = last && !arrivals.empty() ? kSensorVertex : steps_[steps_.size() - 1 - i];
    vertices.push(camera_.to_world().point(points[i]), step,
                  between && last ? 1 : index_behind(step, ray.type, false));
  }
  vertices.finish();
}

}  // namespace plenoflame
