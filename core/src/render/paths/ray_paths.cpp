#include "plenoflame/render/ray_paths.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/sampling/sobol.h"
#include "plenoflame/scene/channel_kinds.h"
#include "render/paths/ray_path_tracer.h"
#include "render/run/run_control.h"
#include "render/tracer/path_integrator.h"
#include "render/tracer/pixel_sampler.h"
#include "render/tracer/radiance_integrator.h"
#include "render/transport/channel_sum.h"
#include "render/transport/scene_medium.h"
#include "render/transport/world_paths.h"

namespace plenoflame {
namespace {

/// Stores the rays of the tracer with their light.
class PathSink : public RayConsumer<double> {
 public:
  PathSink(const BackwardPlan<double>& plan, const PathTracer& tracer, double samples,
           RayPaths& paths)
      : scene_(*plan.scene),
        tracer_(tracer),
        integrator_(plan),
        samples_(samples),
        paths_(paths),
        drawn_(kBlockRays) {}

  void begin_tile(int, const PixelWindow&) override {}
  bool wants_drawn() const override { return true; }
  void drawn(const DrawnRays<double>& rays) override {
    const auto& [frame, lens, type, block, first, count] = rays;
    const Camera& camera = scene_.camera;
    const bool through_lens = type >= 0;
    const Vec2 place{frame.lens_x, frame.lens_y};
    const double plane =
        through_lens ? camera.lens_place(lens).z : camera.aim_plane(std::max(type, 0));
    const auto& between = scene_.pupils.between();
    // Rays between the microlenses were aimed at the main lens; their paths aim at the plane of the
    // array.
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

  void traced(const TracedRays<double>& rays) override {
    integrator_.integrate(rays);
    for (const PixelRays& pixel : rays.pixels) add(pixel);
  }

 private:
  void add(const PixelRays& rays) {
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
      // The kernel continues rays that ended in the camera along the axis, with weight 0.
      const bool reached = paths_.rays.back().status.status == RayStatus::reached;
      if (reached)
        paths_.rays.back().optical_thickness = std::fabs(std::log(integrator_.transmittance()[i]));
      for (std::size_t c = 0; c < paths_.channels.size(); ++c)
        paths_.radiance.push_back(
            reached ? integrator_.radiance()[static_cast<int>(c) * kPaddedBlock + i] : 0.0);
    }
  }

  struct Drawn {
    Vec2 start, aim;
    LensIndex lens;
    int type = -1;
    double weight = 0;
  };
  const CompiledScene& scene_;
  const PathTracer& tracer_;
  RadianceIntegrator<double> integrator_;
  double samples_;
  RayPaths& paths_;
  std::vector<Drawn> drawn_;
};

/// Converts radiances of nodes to channels, followed by the optical thickness of the channels.
/// @param pupil_part part of the stop that the ray crosses
void to_channels(const CompiledScene& scene, int pupil_part, std::vector<double>& carried) {
  if (scene.mix.empty()) return;
  sum_channels(
      scene.part_mixes.empty() ? scene.mix : scene.part_mixes[static_cast<std::size_t>(pupil_part)],
      carried.data(), 1, 1);
  carried[scene.scene.channels.size()] = carried.back();
  carried.resize(scene.scene.channels.size() + 1);
}

/// Light of flames, surfaces and surroundings along single rays.
class LightAlong {
 public:
  /// @param scene, medium kept by reference
  LightAlong(const CompiledScene& scene, const Medium& medium)
      : light_(scene, settings_, {}),
        plan_(make_pass_plan<double>(scene, medium, settings_, {0, 1}, light_)),
        integrator_(plan_),
        columns_(8 + static_cast<std::size_t>(scene.node_count())),
        codes_(kRayPadding) {
    double** const lines[] = {&block_.x, &block_.y, &block_.z, &block_.dx, &block_.dy, &block_.dz};
    for (std::size_t c = 0; c < std::size(lines); ++c) *lines[c] = columns_[c];
    block_.weight = columns_[6];
    block_.code = codes_.data();
    std::fill_n(block_.weight, kRayPadding, 1.0);
  }

  /// All light along a ray: radiances of the nodes, then the optical thickness.
  /// @param exit the ray as it leaves the camera @param number of the ray
  std::vector<double> along(const Ray& exit, std::size_t number) {
    const Vec3 from = exit.origin - plan_.anchor, d = exit.direction;
    const double line[] = {from.x, from.y, from.z, d.x, d.y, d.z};
    for (std::size_t c = 0; c < std::size(line); ++c)
      std::fill_n(columns_[c], kRayPadding, line[c]);
    const std::vector<RayGroup> groups{{0, 1, 0, 0, 0, mix64(number)}};
    MediumCounters counters;
    integrator_.integrate({block_, 1, kRayPadding, {}, groups, 0}, columns_[8], kPaddedBlock,
                          columns_[7], counters);
    std::vector<double> carried;
    for (int n = 0; n < plan_.scene->node_count(); ++n)
      carried.push_back(columns_[8][n * kPaddedBlock]);
    carried.push_back(std::fabs(std::log(columns_[7][0])));
    return carried;
  }

 private:
  RenderSettings settings_;
  PathLight light_;
  BackwardPlan<double> plan_;
  PathIntegrator<double> integrator_;
  AlignedColumns<double> columns_;
  std::vector<int> codes_;
  KernelBlock<double> block_{};
};

/// Removes rays that do not pass this microlens.
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

/// Moves the rays of `part` to the end of `all`.
void join(RayPaths& part, RayPaths& all) {
  for (RayPath ray : part.rays) {
    ray.first += all.vertices.size();
    all.rays.push_back(ray);
  }
  all.vertices.insert(all.vertices.end(), part.vertices.begin(), part.vertices.end());
  all.radiance.insert(all.radiance.end(), part.radiance.begin(), part.radiance.end());
  part = {};
}

/// @param only the microlens whose rays are traced; none: all
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
  const int points = samples_per_replicate(settings);
  const PathLight light(scene, settings, execution);
  const BackwardPlan<double> plan =
      make_pass_plan<double>(scene, medium.get(), settings, {0, points}, light);
  // Rays that pass beside the flames are traced, too, so no beams are used.
  const PathTracer tracer(scene, medium.get());
  const double samples = static_cast<double>(points) * settings.replicates;
  // Traces a few pixels at a time, with paths of their own, and joins them in the order of the
  // pixels.
  constexpr std::size_t kPixels = 16;
  std::vector<RayPaths> parts((pixels.size() + kPixels - 1) / kPixels);
  const auto trace = [&](std::size_t part, int) {
    RayPaths& own = parts[part];
    own.channels = paths.channels;
    own.flame_samples = paths.flame_samples;
    PathSink sink(plan, tracer, samples, own);
    PixelSampler<double> sampler(plan, sink);
    for (std::size_t i = part * kPixels; i < std::min(pixels.size(), (part + 1) * kPixels); ++i) {
      sampler.trace(0, {pixels[i].column, pixels[i].row, 1, 1});
    }
    if (only) keep_lens(*only, own);
  };
  if (!parallel_for(execution, parts.size(), trace)) throw Cancelled();
  // Reserves memory for all rays at once: a million rays take hundreds of megabytes.
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

/// Radiance of each node that the flames send along an object's ray, followed by the optical
/// thickness.
/// @param sent the ray as it leaves the object
/// @param front number of the vertex on the camera's first surface
std::vector<double> carried_back(const CompiledScene& scene, const Medium& medium, const Ray& sent,
                                 const RayPaths& paths, std::size_t front) {
  const RayPath& ray = paths.rays.back();
  const Vec3 from = paths.vertices[front].position;
  std::size_t faces = 0;
  for (std::size_t k = ray.first; k < front; ++k)
    faces += paths.vertices[k].surface == kWindowVertex;
  // A straight ray keeps its line, although distortion bends it in the entrance pupil.
  Ray back{sent.at(length(from - sent.origin)), -sent.direction};
  if (faces > 0) back = {from, normalize(paths.vertices[front - 1].position - from)};
  WindowPath path;
  trace_from(scene, back, path);
  path.segments.resize(std::min(path.segments.size(), faces / 2 + 1));
  AirSegment& last = path.segments.back();
  last.far = length(sent.origin - last.ray.origin);
  MediumSegments segments(&medium, {});
  for (const AirSegment& stretch : path.segments) segments.add(stretch.ray, stretch.far);
  MediumCounters counters;
  segments.integrate(true, counters);
  const auto nodes = static_cast<std::size_t>(medium.channel_count());
  std::vector<double> carried(nodes), passed(nodes, 1.0);
  for (std::size_t k = 0; k < path.segments.size(); ++k)
    for (std::size_t n = 0; n < nodes; ++n) {
      carried[n] +=
          path.segments[k].throughput * passed[n] * segments.radiance(k, static_cast<int>(n));
      passed[n] *= segments.transmittance(k, n);
    }
  carried.push_back(std::fabs(std::log(passed[0])));
  return carried;
}

}  // namespace

RayPaths empty_ray_paths(const CompiledScene& scene) {
  RayPaths paths;
  for (const ChannelSpec& channel : scene.scene.channels) {
    paths.channels.push_back(channel.name);
    paths.wavelengths.push_back(own_wavelength(channel));
  }
  for (int s = 0; s < scene.camera.surface_count(); ++s)
    paths.surfaces.push_back(scene.camera.surface_name(s));
  return paths;
}

void add_pixel_rays(const CompiledScene& scene, const RenderSettings& settings,
                    const std::vector<Pixel>& pixels, const Execution& execution, RayPaths& paths) {
  std::vector<Pixel> once;
  std::set<Pixel> seen;
  for (const Pixel pixel : pixels)
    if (seen.insert(pixel).second) once.push_back(pixel);
  trace_pixels(scene, settings, once, std::nullopt, execution, paths);
}

void add_microlens_rays(const CompiledScene& scene, const RenderSettings& settings, LensIndex lens,
                        const Execution& execution, RayPaths& paths,
                        const std::vector<Pixel>& except) {
  const Camera& camera = scene.camera;
  if (!camera.has_array())
    throw InputError("the camera has no microlens array, and so no rays of a microlens");
  const std::set<Pixel> left_out(except.begin(), except.end());
  bool any_left_out = false;
  const Vec3 lens_place = camera.lens_place(lens);
  const Vec2 place{lens_place.x, lens_place.y};
  const PupilNode node =
      scene.pupils.tables()[static_cast<std::size_t>(camera.lattice().type(lens))].at(
          length(place - camera.foot()));
  const SensorSpec& sensor = camera.spec().sensor;
  std::vector<Pixel> pixels;
  if (!node.dark()) {
    // The range of pixels that light of this microlens can reach.
    const double image = std::fabs(node.centre) + node.outer_radius;
    const auto range = [&](double at, int count, double pitch) {
      const double reach = image + SensorSpec::kBlurCut * sensor.blur * pitch;
      const double middle = 0.5 * count - at / pitch;
      return std::pair{
          std::max(0, static_cast<int>(std::floor(middle - reach / pitch)) - 1),
          std::min(count - 1, static_cast<int>(std::floor(middle + reach / pitch)) + 1)};
    };
    const auto [left, right] = range(place.x, sensor.columns, sensor.pixel().x);
    const auto [top, bottom] = range(place.y, sensor.rows, sensor.pixel().y);
    for (int row = top; row <= bottom; ++row)
      for (int column = left; column <= right; ++column) {
        const bool out = left_out.contains({column, row});
        any_left_out = any_left_out || out;
        if (!out) pixels.push_back({column, row});
      }
  }
  const std::size_t before = paths.rays.size();
  trace_pixels(scene, settings, pixels, lens, execution, paths);
  if (paths.rays.size() == before && !any_left_out)
    throw UsageError("the microlens " + std::to_string(lens.q) + "," + std::to_string(lens.r) +
                     " lights no pixel of the sensor");
}

void add_object_rays(const CompiledScene& scene, Vec3 point, int count, RayPaths& paths) {
  if (count < 1) throw UsageError("at least 1 ray from an object point is needed");
  const Camera& camera = scene.camera;
  const Vec3 at = camera.to_world().inverse().point(point);
  // The entrance pupil of the first-order design; without one, the front of the lens.
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
  const PathTracer tracer(scene, medium.get());
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    // Vogel's spiral: equal areas, without a preferred direction.
    const double r = 0.5 * diameter * std::sqrt((i + 0.5) / count), phi = golden * i;
    const Vec3 aim = camera.to_world().point({r * std::cos(phi), r * std::sin(phi), pupil});
    const Ray ray{point, normalize(aim - point)};
    RayPath path;
    tracer.add_from_scene(ray, path, paths);
    const RayPath& added = paths.rays.back();
    std::vector<double> carried(paths.channels.size() + 1, 0.0);
    if (added.status.status == RayStatus::reached) {
      // The light is that seen from the camera's first surface.
      std::size_t k = added.first;
      while (paths.vertices[k].surface != 0 && k + 1 < added.first + added.count) ++k;
      carried = carried_back(scene, medium.get(), ray, paths, k);
      to_channels(scene, added.pupil_part, carried);
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
  const PathTracer tracer(scene, medium.get());
  const SensorSpec& sensor = camera.spec().sensor;
  const auto [half_x, half_y] = camera.sensor_point(0, 0);
  const Vec2 pixel = sensor.pixel();
  double reach = 0;
  for (const PupilTable& table : scene.pupils.tables())
    for (const PupilNode& node : table.nodes) reach = std::max(reach, std::fabs(node.centre));
  const Vec2 corner{half_x + reach, half_y + reach};
  LightAlong light(scene, medium.get());
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
    ray.column = static_cast<int>(std::floor((half_x - start.x) / pixel.x));
    ray.row = static_cast<int>(std::floor((half_y - start.y) / pixel.y));
    const std::optional<Ray> exit = tracer.add(start, lens, place, ray, paths);
    RayPath& added = paths.rays.back();
    paths.radiance.resize(paths.rays.size() * paths.channels.size(), 0.0);
    if (!exit) continue;
    std::vector<double> carried = light.along(*exit, paths.rays.size() - 1);
    to_channels(scene, added.pupil_part, carried);
    added.optical_thickness = carried.back();
    std::copy(carried.begin(), carried.end() - 1,
              paths.radiance.end() - static_cast<std::ptrdiff_t>(paths.channels.size()));
  }
}

std::vector<Pixel> random_pixels(const SensorSpec& sensor, int count, std::uint64_t seed) {
  const auto columns = static_cast<std::uint64_t>(sensor.columns);
  const std::uint64_t all = columns * static_cast<std::uint64_t>(sensor.rows);
  if (count < 0 || static_cast<std::uint64_t>(count) > all)
    throw UsageError("the sensor has " + std::to_string(all) + " pixels; " + std::to_string(count) +
                     " different ones cannot be drawn from them");
  // The beginning of a Fisher-Yates shuffle; the map holds only the entries that were moved.
  std::unordered_map<std::uint64_t, std::uint64_t> moved;
  const auto at = [&](std::uint64_t place) {
    const auto found = moved.find(place);
    return found == moved.end() ? place : found->second;
  };
  std::vector<Pixel> pixels;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(count); ++i) {
    const double u = static_cast<double>(mix64(mix64(seed) + i) >> 11) * std::ldexp(1.0, -53);
    const std::uint64_t place =
        i + std::min(all - i - 1, static_cast<std::uint64_t>(u * static_cast<double>(all - i)));
    const std::uint64_t chosen = at(place);
    moved[place] = at(i);
    pixels.push_back({static_cast<int>(chosen % columns), static_cast<int>(chosen / columns)});
  }
  return pixels;
}

}  // namespace plenoflame
