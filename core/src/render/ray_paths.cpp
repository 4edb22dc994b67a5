#include "plenoflame/render/ray_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "plenoflame/base/error.h"
#include "plenoflame/sampling/sobol.h"
#include "render/backward_tile.h"

namespace plenoflame {
namespace {

/// What a scene without flames is filled with.
class EmptyMedium : public Medium {
 public:
  EmptyMedium(int channels, const Box& box) : channels_(channels), box_(box) {}
  int channel_count() const override { return channels_; }
  Box bounds() const override { return box_; }
  double feature_size() const override { return 1; }
  void integrate(const RayBatch<float>& rays, const MediumOptions&, RadianceBatch<float> out,
                 MediumCounters&) const override {
    fill(rays.size, out);
  }
  void integrate(const RayBatch<double>& rays, const MediumOptions&, RadianceBatch<double> out,
                 MediumCounters&) const override {
    fill(rays.size, out);
  }
  MediumSample sample(Vec3) const override { return {}; }
  double source(int, double) const override { return 0; }
  void append_breakpoints(const Ray&, std::vector<double>&) const override {}
  std::string description() const override { return "none"; }

 private:
  template <class Real>
  void fill(int count, RadianceBatch<Real> out) const {
    for (int c = 0; c < channels_; ++c) std::fill_n(out.radiance + c * out.stride, count, Real(0));
    std::fill_n(out.transmittance, count, Real(1));
  }
  int channels_;
  Box box_;
};

/// The scene's medium, or an empty one around the point that the camera is focused on.
class MediumOf {
 public:
  explicit MediumOf(const CompiledScene& scene)
      : empty_(static_cast<int>(scene.scene.channels.size()), box_ahead(scene.camera)),
        medium_(scene.medium ? *scene.medium : empty_) {}
  MediumOf(const MediumOf&) = delete;
  MediumOf& operator=(const MediumOf&) = delete;
  const Medium& get() const { return medium_; }

 private:
  static Box box_ahead(const Camera& camera) {
    const double distance = camera.spec().focus.object_distance;
    const double ahead = distance > 0 && std::isfinite(distance) ? distance : 1.0;
    const Vec3 middle = camera.to_world().point({0, 0, ahead});
    const double half = 0.05 * ahead;
    return {middle - Vec3{half, half, half}, middle + Vec3{half, half, half}};
  }
  EmptyMedium empty_;
  const Medium& medium_;
};

/// Where a line is inside a box: [near, far], empty when near > far.
struct Stretch {
  double near = -std::numeric_limits<double>::infinity();
  double far = std::numeric_limits<double>::infinity();
};

Stretch inside(const Box& box, const Ray& ray) {
  Stretch stretch;
  const auto slab = [&](double lower, double upper, double origin, double direction) {
    if (direction == 0) {
      if (origin < lower || origin > upper) stretch = {1, -1};
      return;
    }
    const double a = (lower - origin) / direction, b = (upper - origin) / direction;
    stretch.near = std::max(stretch.near, std::min(a, b));
    stretch.far = std::min(stretch.far, std::max(a, b));
  };
  slab(box.lower.x, box.upper.x, ray.origin.x, ray.direction.x);
  slab(box.lower.y, box.upper.y, ray.origin.y, ray.direction.y);
  slab(box.lower.z, box.upper.z, ray.origin.z, ray.direction.z);
  return stretch;
}

/// Turns a start on the sensor and an aim into vertices.
class PathTracer {
 public:
  PathTracer(const Camera& camera, const Box& box) : camera_(camera), box_(box) {
    // Paths list these from the sensor on, each at most as often as stated here.
    steps_.push_back(kSensorVertex);
    const int lens =
        camera.surface_count() - (camera.has_array() ? (camera.ideal_array() ? 1 : 2) : 0);
    for (int s = camera.surface_count() - 1; s >= 0; --s) {
      steps_.push_back(s);
      const IdealLens& ideal = camera.ideal();
      if (s < lens && camera.ideal_lens() && ideal.front_principal != ideal.rear_principal)
        steps_.push_back(s);
    }
    lens_surfaces_ = lens;
  }

  void add(Vec2 start, std::optional<LensIndex> lens, Vec2 aim, RayPath& ray,
           RayPaths& paths) const {
    const Camera::Path path = camera_.trace(start, lens, aim, true);
    ray.status = path.status;
    ray.first = paths.vertices.size();
    // Where a ray was that missed a surface is nowhere.
    const std::size_t points =
        path.points.size() - (path.status.status == RayStatus::missed ? 1 : 0);
    double distance = 0;
    const auto push = [&](Vec3 world, int surface) {
      if (paths.vertices.size() > ray.first)
        distance += length(world - paths.vertices.back().position);
      paths.vertices.push_back({world, surface, index_behind(surface, ray.type), distance});
    };
    // What goes between the microlenses skips their faces, but for the one where it may end.
    std::size_t skipped = 0;
    if (!lens && camera_.has_array())
      skipped = (camera_.ideal_array() ? 1u : 2u) -
                (ray.status.status != RayStatus::reached && ray.status.surface >= lens_surfaces_);
    for (std::size_t i = 0; i < points; ++i)
      push(camera_.to_world().point(path.points[i]), steps_[i > 0 ? i + skipped : 0]);
    if (path.status.status == RayStatus::reached) {
      const Ray exit{camera_.to_world().point(path.exit.origin),
                     camera_.to_world().direction(path.exit.direction)};
      const Stretch stretch = inside(box_, exit);
      const bool meets = stretch.near <= stretch.far && stretch.far > 0;
      if (meets && stretch.near > 0) push(exit.at(stretch.near), kSceneVertex);
      const double beside = dot(0.5 * (box_.lower + box_.upper) - exit.origin, exit.direction);
      if (meets)
        push(exit.at(stretch.far), kSceneVertex);
      else if (beside > 0)
        push(exit.at(beside), kSceneVertex);
    }
    ray.count = paths.vertices.size() - ray.first;
    paths.rays.push_back(ray);
  }

 private:
  double index_behind(int surface, int type) const {
    if (surface < 0) return 1;
    if (surface >= lens_surfaces_)
      return surface == lens_surfaces_ + 1
                 ? camera_.microlenses()[static_cast<std::size_t>(type)].index
                 : 1;
    if (surface == 0 || camera_.ideal_lens()) return 1;
    return camera_.lens().surfaces()[static_cast<std::size_t>(surface) - 1].index;
  }

  const Camera& camera_;
  Box box_;
  std::vector<int> steps_;
  int lens_surfaces_ = 0;
};

/// Keeps what the tracer draws and computes.
class PathSink : public RaySink<double> {
 public:
  PathSink(const CompiledScene& scene, const PathTracer& tracer, double samples, RayPaths& paths)
      : scene_(scene), tracer_(tracer), samples_(samples), paths_(paths), drawn_(kBlockRays) {}

  void drawn(const KernelPatch<double>& patch, int type, const KernelBlock<double>& block,
             int first, int count) override {
    const Camera& camera = scene_.camera;
    const bool through_lens = camera.has_array() && type >= 0;
    const Vec2 place{patch.lens_x, patch.lens_y};
    const LensIndex lens = through_lens ? camera.lattice().nearest(place) : LensIndex{};
    const auto& between = scene_.pupils.between();
    // Rays between the lenses are aimed at the main lens; traced ones at the plane of the array.
    const double drawn_gap = camera.has_array() && type < 0
                                 ? between->camera.aim_plane(0) - camera.sensor()
                                 : camera.aim_plane(std::max(type, 0)) - camera.sensor();
    const double gap = camera.aim_plane(std::max(type, 0)) - camera.sensor();
    for (int i = first; i < first + count; ++i) {
      const Vec2 aim = place + Vec2{block.x[i], block.y[i]};
      const Vec2 slope{block.dx[i] / block.dz[i], block.dy[i] / block.dz[i]};
      const Vec2 start = aim - drawn_gap * slope;
      drawn_[static_cast<std::size_t>(i)] = {start, drawn_gap == gap ? aim : start + gap * slope,
                                             lens, through_lens ? type : -1, block.weight[i]};
    }
  }

  void finished(int column, int row, int first, int count, double scale, const double* radiance,
                int stride, const double* transmittance) override {
    for (int i = first; i < first + count; ++i) {
      const Drawn& drawn = drawn_[static_cast<std::size_t>(i)];
      RayPath ray;
      ray.column = column;
      ray.row = row;
      ray.lens = drawn.lens;
      ray.type = drawn.type;
      ray.weight = scale * drawn.weight / samples_;
      const std::optional<LensIndex> lens =
          drawn.type >= 0 ? std::optional(drawn.lens) : std::nullopt;
      tracer_.add(drawn.start, lens, drawn.aim, ray, paths_);
      // The kernel sends rays that ended in the camera on along the axis, with no weight.
      const bool reached = paths_.rays.back().status.status == RayStatus::reached;
      if (reached) paths_.rays.back().optical_thickness = std::fabs(std::log(transmittance[i]));
      for (std::size_t c = 0; c < paths_.channels.size(); ++c)
        paths_.radiance.push_back(reached ? radiance[static_cast<int>(c) * stride + i] : 0.0);
    }
  }

 private:
  struct Drawn {
    Vec2 start, aim;
    LensIndex lens;
    int type = -1;
    double weight = 0;
  };
  const CompiledScene& scene_;
  const PathTracer& tracer_;
  double samples_;
  RayPaths& paths_;
  std::vector<Drawn> drawn_;
};

/// Radiance per channel of one line through the medium, then its optical thickness.
std::vector<double> carried_by(const Medium& medium, const Ray& ray) {
  const Box box = medium.bounds();
  RayBatch<double> batch;
  batch.size = kRayPadding;
  batch.anchor = 0.5 * (box.lower + box.upper);
  const Vec3 at = ray.origin - batch.anchor;
  // A batch is 16 rays at least: this one, repeated.
  alignas(64) std::array<std::array<double, kRayPadding>, 6> lines{};
  const std::array<double, 6> values{at.x,           at.y, at.z, ray.direction.x, ray.direction.y,
                                     ray.direction.z};
  for (std::size_t k = 0; k < values.size(); ++k) lines[k].fill(values[k]);
  batch.x = lines[0].data();
  batch.y = lines[1].data();
  batch.z = lines[2].data();
  batch.dx = lines[3].data();
  batch.dy = lines[4].data();
  batch.dz = lines[5].data();
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

}  // namespace

RayPaths empty_ray_paths(const CompiledScene& scene) {
  RayPaths paths;
  for (const ChannelSpec& channel : scene.scene.channels) {
    paths.channels.push_back(channel.name);
    paths.wavelengths.push_back(channel.kind == ChannelKind::total ? 0.0 : channel.wavelength);
  }
  for (int s = 0; s < scene.camera.surface_count(); ++s)
    paths.surfaces.push_back(scene.camera.surface_name(s));
  return paths;
}

void add_pixel_rays(const CompiledScene& scene, const RenderSettings& settings,
                    const std::vector<Pixel>& pixels, const Execution& execution, RayPaths& paths) {
  const SensorSpec& sensor = scene.camera.spec().sensor;
  for (const Pixel pixel : pixels)
    if (pixel.column < 0 || pixel.row < 0 || pixel.column >= sensor.columns ||
        pixel.row >= sensor.rows)
      throw UsageError("pixel " + std::to_string(pixel.column) + "," + std::to_string(pixel.row) +
                       " is outside of the sensor of " + std::to_string(sensor.columns) + " x " +
                       std::to_string(sensor.rows) + " pixels");
  if (settings.replicates < 1 || settings.samples < settings.replicates)
    throw UsageError("at least " + std::to_string(std::max(1, settings.replicates)) +
                     " rays per pixel and microlens are needed");
  const MediumOf medium(scene);
  const int points = (settings.samples + settings.replicates - 1) / settings.replicates;
  BackwardPlan<double> plan = make_double_plan(scene, medium.get(), settings, 0, points);
  plan.beams.reset();  // rays that pass beside the flames are wanted, too
  const PathTracer tracer(scene.camera, medium.get().bounds());
  PathSink sink(scene, tracer, static_cast<double>(points) * settings.replicates, paths);
  const int channels = static_cast<int>(paths.channels.size());
  for (const Pixel pixel : pixels) {
    if (execution.stop.stop_requested()) throw Cancelled();
    const PixelWindow window{pixel.column, pixel.row, 1, 1};
    Film film(window, channels, settings.replicates);
    TileTracer<double> tile(plan, film);
    tile.show_rays_to(&sink);
    tile.render(window);
  }
}

void add_chief_rays(const CompiledScene& scene, RayPaths& paths) {
  const Camera& camera = scene.camera;
  if (!camera.has_array())
    throw InputError("the camera has no microlens array, and so no chief rays of microlenses");
  const MediumOf medium(scene);
  const PathTracer tracer(camera, medium.get().bounds());
  const SensorSpec& sensor = camera.spec().sensor;
  const double half_x = 0.5 * sensor.columns * sensor.pixel_pitch;
  const double half_y = 0.5 * sensor.rows * sensor.pixel_pitch;
  double reach = 0;
  for (const PupilTable& table : scene.pupils.tables())
    for (const PupilNode& node : table.nodes) reach = std::max(reach, std::fabs(node.centre));
  const Vec2 corner{half_x + reach, half_y + reach};
  for (const LensIndex lens : camera.lattice().within(-1.0 * corner, corner)) {
    const Vec2 place = camera.lattice().centre(lens);
    RayPath ray;
    ray.lens = lens;
    ray.type = camera.lattice().type(lens);
    const PupilNode node =
        scene.pupils.tables()[static_cast<std::size_t>(ray.type)].at(length(place));
    if (node.dark()) continue;
    const double h = length(place);
    const Vec2 start = place + (h > 0 ? (node.centre / h) * place : Vec2{node.centre, 0});
    if (std::fabs(start.x) >= half_x || std::fabs(start.y) >= half_y) continue;
    ray.column = static_cast<int>(std::floor((half_x - start.x) / sensor.pixel_pitch));
    ray.row = static_cast<int>(std::floor((half_y - start.y) / sensor.pixel_pitch));
    tracer.add(start, lens, place, ray, paths);
    RayPath& added = paths.rays.back();
    paths.radiance.resize(paths.rays.size() * paths.channels.size(), 0.0);
    if (added.status.status != RayStatus::reached || added.count < 2) continue;
    const RayVertex& last = paths.vertices[added.first + added.count - 1];
    const RayVertex& before = paths.vertices[added.first + added.count - 2];
    const std::vector<double> carried =
        carried_by(medium.get(), {last.position, normalize(last.position - before.position)});
    added.optical_thickness = carried.back();
    std::copy(carried.begin(), carried.end() - 1,
              paths.radiance.end() - static_cast<std::ptrdiff_t>(paths.channels.size()));
  }
}

std::vector<Pixel> random_pixels(const SensorSpec& sensor, int count, std::uint64_t seed) {
  std::vector<Pixel> pixels;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t bits = mix64(mix64(seed) + static_cast<std::uint64_t>(i));
    const auto pick = [](std::uint64_t half, int size) {
      return static_cast<int>((half * static_cast<std::uint64_t>(size)) >> 32);
    };
    pixels.push_back({pick(bits >> 32, sensor.columns), pick(bits & 0xffffffffu, sensor.rows)});
  }
  return pixels;
}

}  // namespace plenoflame
