#include "plenoflame/render/ray_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/sampling/philox.h"
#include "plenoflame/sampling/sobol.h"
#include "render/backward_tile.h"
#include "render/channel_sum.h"
#include "render/medium_segments.h"
#include "render/ray_path_tracer.h"
#include "render/scene_medium.h"
#include "render/surface_light.h"

namespace plenoflame {
namespace {

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
    const double plane =
        through_lens ? camera.lens_place(lens).z : camera.aim_plane(std::max(type, 0));
    const auto& between = scene_.pupils.between();
    // Rays between the lenses are aimed at the main lens; traced ones at the plane of the array.
    const double drawn_gap = camera.has_array() && type < 0
                                 ? between->camera.aim_plane(0) - camera.sensor()
                                 : plane - camera.sensor();
    const double gap = plane - camera.sensor();
    for (int i = first; i < first + count; ++i) {
      const Vec2 aim = place + Vec2{block.x[i], block.y[i]};
      const Vec2 slope{block.dx[i] / block.dz[i], block.dy[i] / block.dz[i]};
      const Vec2 start = aim - drawn_gap * slope;
      drawn_[static_cast<std::size_t>(i)] = {start, drawn_gap == gap ? aim : start + gap * slope,
                                             lens, through_lens ? type : -1, block.weight[i]};
    }
  }

  void finished(const RaysOfPixel& rays, const double* radiance, int stride,
                const double* transmittance) override {
    for (int i = rays.first; i < rays.first + rays.count; ++i) {
      const Drawn& drawn = drawn_[static_cast<std::size_t>(i)];
      RayPath ray;
      ray.column = rays.column;
      ray.row = rays.row;
      ray.lens = drawn.lens;
      ray.type = drawn.type;
      ray.weight = rays.scale * drawn.weight / samples_;
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

/// Radiance of what stands for the channels, then the optical thickness: of the channels.
void to_channels(const CompiledScene& scene, std::vector<double>& carried) {
  if (scene.mix.empty()) return;
  sum_channels(scene.mix, carried.data(), 1, 1);
  carried[scene.scene.channels.size()] = carried.back();
  carried.resize(scene.scene.channels.size() + 1);
}

/// What surfaces and surroundings send along single rays behind the flames, and what these scatter.
class LightBehind {
 public:
  explicit LightBehind(const CompiledScene& scene)
      : scene_(scene),
        nodes_(static_cast<std::size_t>(scene.node_count())),
        segments_(scene.medium.get(), {}) {
    if (scene.surfaces) {
      plan_ = std::make_unique<SurfaceLightPlan>(scene, RenderSettings{}, Execution{});
      light_ = std::make_unique<SurfaceLight>(*plan_);
    }
    scatter_ = make_scatter_plan(scene, RenderSettings{}, Execution{}, plan_.get());
    if (scatter_) walk_ = std::make_unique<ScatterWalk>(*scatter_);
  }

  /// @param line whose origin is the ray's last vertex @param before a vertex ahead of it
  /// @param number of the ray @param carried radiance of what stands for the channels, added to;
  /// then the optical thickness: of the flames in front
  void add(const Ray& line, Vec3 before, std::size_t number, const RayPath& ray,
           std::vector<double>& carried) {
    std::vector<std::vector<double>> radiance(nodes_, std::vector<double>(1));
    if (ray.solid >= 0) {
      SurfacePath path;
      path.key = mix64(number);
      const double back = length(line.origin - before);
      if (!scene_.surfaces->intersect({before, line.direction}, 0.5 * back, 1.5 * back, {},
                                      path.hit))
        return;
      const auto word = philox(path.key, 0, 0);
      std::vector<SurfaceLight::First> first(1);
      for (std::size_t k = 0; k < 4; ++k) first[0].u[k] = unit_uniform(word[k]);
      std::vector<SurfacePath> paths{path};
      MediumCounters counters;
      if (walk_)
        walk_->add_surfaces(paths, first, radiance, counters);
      else
        light_->add(paths, first, radiance, counters);
    } else {
      const std::vector<double>& environment = scene_.lights.environment;
      for (std::size_t n = 0; n < environment.size(); ++n) radiance[n][0] = environment[n];
    }
    // The flames in front may let another share of each wavelength through.
    MediumCounters counters;
    segments_.clear();
    segments_.add({before, line.direction},
                  ray.solid >= 0 ? length(line.origin - before) : kInfinity);
    segments_.integrate(false, counters);
    for (std::size_t n = 0; n < nodes_; ++n)
      carried[n] += segments_.transmittance(0, n) * radiance[n][0];
    if (walk_) add_scattered(line, number, ray.solid >= 0, carried);
  }

 private:
  void add_scattered(const Ray& line, std::size_t number, bool ends, std::vector<double>& carried) {
    std::vector<std::vector<double>> radiance(nodes_, std::vector<double>(1));
    MediumCounters counters;
    walk_->add({{0, line, mix64(~number), ends ? 0 : kInfinity}}, radiance, counters);
    for (std::size_t n = 0; n < nodes_; ++n) carried[n] += radiance[n][0];
  }

  const CompiledScene& scene_;
  std::size_t nodes_;
  MediumSegments segments_;
  std::unique_ptr<SurfaceLightPlan> plan_;
  std::unique_ptr<SurfaceLight> light_;
  std::unique_ptr<const ScatterPlan> scatter_;
  std::unique_ptr<ScatterWalk> walk_;
};

/// Leaves out what does not go through this microlens.
void keep_lens(LensIndex lens, RayPaths& paths) {
  RayPaths kept;
  for (std::size_t i = 0; i < paths.rays.size(); ++i) {
    RayPath ray = paths.rays[i];
    if (!(ray.lens == lens)) continue;
    const auto first = paths.vertices.begin() + static_cast<std::ptrdiff_t>(ray.first);
    ray.first = kept.vertices.size();
    kept.vertices.insert(kept.vertices.end(), first,
                         first + static_cast<std::ptrdiff_t>(ray.count));
    kept.rays.push_back(ray);
    for (std::size_t c = 0; c < paths.channels.size(); ++c)
      kept.radiance.push_back(paths.radiance_of(i, c));
  }
  paths.rays = std::move(kept.rays);
  paths.vertices = std::move(kept.vertices);
  paths.radiance = std::move(kept.radiance);
}

/// Moves the rays of `part` behind those of `all`.
void join(RayPaths& part, RayPaths& all) {
  for (RayPath ray : part.rays) {
    ray.first += all.vertices.size();
    all.rays.push_back(ray);
  }
  all.vertices.insert(all.vertices.end(), part.vertices.begin(), part.vertices.end());
  all.radiance.insert(all.radiance.end(), part.radiance.begin(), part.radiance.end());
  part = {};
}

/// @param only the microlens whose rays are wanted; none: all
void trace_pixels(const CompiledScene& scene, const RenderSettings& settings,
                  const std::vector<Pixel>& pixels, std::optional<LensIndex> only,
                  const Execution& execution, RayPaths& paths) {
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
  const SceneMedium medium(scene);
  const int points = (settings.samples + settings.replicates - 1) / settings.replicates;
  const auto light = make_surface_light(scene, settings, execution);
  const auto scatter = make_scatter_plan(scene, settings, execution, light.get());
  const BackwardPlan<double> plan = make_pass_plan<double>(scene, medium.get(), settings,
                                                           {0, points}, light.get(), scatter.get());
  // Rays that pass beside the flames are wanted, too: no beams.
  const PathTracer tracer(scene.camera, medium.get(), scene.surfaces.get());
  const double samples = static_cast<double>(points) * settings.replicates;
  const int channels = static_cast<int>(paths.channels.size());
  // A few pixels at a time, each with paths of its own; joined in the order of the pixels.
  constexpr std::size_t kPixels = 16;
  std::vector<RayPaths> parts((pixels.size() + kPixels - 1) / kPixels);
  const auto trace = [&](std::size_t part, int) {
    RayPaths& own = parts[part];
    own.channels = paths.channels;
    own.flame_samples = paths.flame_samples;
    PathSink sink(scene, tracer, samples, own);
    for (std::size_t i = part * kPixels; i < std::min(pixels.size(), (part + 1) * kPixels); ++i) {
      const PixelWindow window{pixels[i].column, pixels[i].row, 1, 1};
      Film film(window, channels, settings.replicates);
      TileTracer<double> tile(plan, film);
      tile.show_rays_to(&sink);
      tile.render(0);
    }
    if (only) keep_lens(*only, own);
  };
  if (!parallel_for(execution, parts.size(), trace)) throw Cancelled();
  // Room for all at once: a million rays take hundreds of megabytes.
  std::size_t rays = paths.rays.size(), radiances = paths.radiance.size(),
              vertices = paths.vertices.size();
  for (const RayPaths& part : parts) {
    rays += part.rays.size();
    radiances += part.radiance.size();
    vertices += part.vertices.size();
  }
  paths.rays.reserve(rays);
  paths.radiance.reserve(radiances);
  paths.vertices.reserve(vertices);
  for (RayPaths& part : parts) join(part, paths);
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
  trace_pixels(scene, settings, pixels, std::nullopt, execution, paths);
}

void add_microlens_rays(const CompiledScene& scene, const RenderSettings& settings, LensIndex lens,
                        const Execution& execution, RayPaths& paths) {
  const Camera& camera = scene.camera;
  if (!camera.has_array())
    throw InputError("the camera has no microlens array, and so no rays of a microlens");
  const Vec3 lens_place = camera.lens_place(lens);
  const Vec2 place{lens_place.x, lens_place.y};
  const PupilNode node =
      scene.pupils.tables()[static_cast<std::size_t>(camera.lattice().type(lens))].at(
          length(place - camera.foot()));
  const SensorSpec& sensor = camera.spec().sensor;
  std::vector<Pixel> pixels;
  if (!node.dark()) {
    // As far as light of this microlens can be, in whole pixels.
    const double reach = std::fabs(node.centre) + node.outer_radius;
    const double pitch = sensor.pixel_pitch;
    const auto range = [&](double at, int count) {
      const double middle = 0.5 * count - at / pitch;
      return std::pair{
          std::max(0, static_cast<int>(std::floor(middle - reach / pitch)) - 1),
          std::min(count - 1, static_cast<int>(std::floor(middle + reach / pitch)) + 1)};
    };
    const auto [left, right] = range(place.x, sensor.columns);
    const auto [top, bottom] = range(place.y, sensor.rows);
    for (int row = top; row <= bottom; ++row)
      for (int column = left; column <= right; ++column) pixels.push_back({column, row});
  }
  const std::size_t before = paths.rays.size();
  trace_pixels(scene, settings, pixels, lens, execution, paths);
  if (paths.rays.size() == before)
    throw UsageError("the microlens " + std::to_string(lens.q) + "," + std::to_string(lens.r) +
                     " lights no pixel of the sensor");
}

void add_object_rays(const CompiledScene& scene, Vec3 point, int count, RayPaths& paths) {
  if (count < 1) throw UsageError("at least 1 ray from an object point is needed");
  const Camera& camera = scene.camera;
  const Vec3 at = camera.to_world().inverse().point(point);
  // The entrance pupil as the first-order design has it; without one the front of the lens.
  const FirstOrder& lens = camera.lens_first_order();
  const auto& surfaces = camera.spec().lens.surfaces;
  double pupil = -lens.entrance_pupil, diameter = lens.entrance_pupil_diameter;
  if (!(diameter > 0) || !std::isfinite(pupil) || pupil >= at.z) {
    pupil = 0;
    diameter = surfaces.empty() ? camera.spec().lens.diameter : surfaces.front().diameter;
  }
  if (!(at.z > 0))
    throw InputError("the object point is " + std::to_string(at.z) +
                     " m in front of the camera's first vertex; it must lie in front of it");
  const SceneMedium medium(scene);
  const PathTracer tracer(camera, medium.get(), scene.surfaces.get());
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    // Vogel's spiral: equal areas, no direction preferred.
    const double r = 0.5 * diameter * std::sqrt((i + 0.5) / count), phi = golden * i;
    const Vec3 aim = camera.to_world().point({r * std::cos(phi), r * std::sin(phi), pupil});
    const Ray ray{point, normalize(aim - point)};
    RayPath path;
    tracer.add_from_scene(ray, path, paths);
    const RayPath& added = paths.rays.back();
    std::vector<double> carried(paths.channels.size() + 1, 0.0);
    if (added.status.status == RayStatus::reached) {
      // Seen from the camera's first surface.
      std::size_t k = added.first;
      while (paths.vertices[k].surface != 0 && k + 1 < added.first + added.count) ++k;
      const Vec3 front = paths.vertices[k].position;
      carried = carried_by(medium.get(), {front, -ray.direction}, 0, length(point - front));
      to_channels(scene, carried);
    }
    paths.rays.back().optical_thickness = carried.back();
    paths.radiance.insert(paths.radiance.end(), carried.begin(), carried.end() - 1);
  }
}

void add_chief_rays(const CompiledScene& scene, RayPaths& paths) {
  const Camera& camera = scene.camera;
  if (!camera.has_array())
    throw InputError("the camera has no microlens array, and so no chief rays of microlenses");
  const SceneMedium medium(scene);
  const PathTracer tracer(camera, medium.get(), scene.surfaces.get());
  const SensorSpec& sensor = camera.spec().sensor;
  const double half_x = 0.5 * sensor.columns * sensor.pixel_pitch;
  const double half_y = 0.5 * sensor.rows * sensor.pixel_pitch;
  double reach = 0;
  for (const PupilTable& table : scene.pupils.tables())
    for (const PupilNode& node : table.nodes) reach = std::max(reach, std::fabs(node.centre));
  const Vec2 corner{half_x + reach, half_y + reach};
  LightBehind behind(scene);
  std::optional<MicroImages> images;
  if (camera.misaligned()) images.emplace(camera, false);
  for (const LensIndex lens : camera.lattice().within(-1.0 * corner, corner)) {
    const Vec3 lens_place = camera.lens_place(lens);
    const Vec2 place{lens_place.x, lens_place.y};
    RayPath ray;
    ray.lens = lens;
    ray.type = camera.lattice().type(lens);
    const double h = length(place);
    Vec2 start;
    if (images) {
      const MicroImages::Place image = images->place(lens);
      if (image.dark) continue;
      start = image.centre;
    } else {
      const PupilNode node =
          scene.pupils.tables()[static_cast<std::size_t>(ray.type)].at(length(place));
      if (node.dark()) continue;
      start = place + (h > 0 ? (node.centre / h) * place : Vec2{node.centre, 0});
    }
    if (std::fabs(start.x) >= half_x || std::fabs(start.y) >= half_y) continue;
    ray.column = static_cast<int>(std::floor((half_x - start.x) / sensor.pixel_pitch));
    ray.row = static_cast<int>(std::floor((half_y - start.y) / sensor.pixel_pitch));
    tracer.add(start, lens, place, ray, paths);
    RayPath& added = paths.rays.back();
    paths.radiance.resize(paths.rays.size() * paths.channels.size(), 0.0);
    if (added.status.status != RayStatus::reached || added.count < 2) continue;
    const RayVertex& last = paths.vertices[added.first + added.count - 1];
    const RayVertex& before = paths.vertices[added.first + added.count - 2];
    const Ray line{last.position, normalize(last.position - before.position)};
    const double infinite = std::numeric_limits<double>::infinity();
    std::vector<double> carried =
        carried_by(medium.get(), line, -infinite, added.solid >= 0 ? 0 : infinite);
    std::size_t front = added.first;  // from the camera's first surface on, far from the hit
    while (paths.vertices[front].surface != 0 && front + 2 < added.first + added.count) ++front;
    behind.add(line, paths.vertices[front].position, paths.rays.size() - 1, added, carried);
    to_channels(scene, carried);
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
