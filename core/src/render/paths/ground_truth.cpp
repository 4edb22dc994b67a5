#include "plenoflame/render/ground_truth.h"
#include "plenoflame/film/reopened.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "media/voxels/cell_sampling.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part.h"
#include "plenoflame/math/ray_span.h"
#include "plenoflame/scene/spectral.h"
#include "render/transport/world_paths.h"
#include "render/visibility/scene_beams.h"

namespace plenoflame {
namespace {

/// The truth of one ray; distances along the ray.
struct MediumTruth {
  double optical_depth = 0;
  double radiance = 0, moment = 0;  ///< of the first channel; moment: weighted by t
  std::vector<double> depths;       ///< optical depth at each quadrature wavelength
  double heat = 0;                  ///< radiance weighted by the temperature
  double first = 0, last = 0;
  bool hit = false;
};

/// Largest optical depth of a step, so that the rest of the exponential within it is smooth.
constexpr double kDeepest = 0.1;
constexpr double kMostSteps = 1000;

/// The share of each wavelength of the medium in the first channel.
struct FirstChannel {
  std::vector<double> weights;  ///< weights of their light in the channel
  std::vector<double> shares;   ///< of its light from a body at 1700 K; the sum is 1
};

constexpr std::size_t kPoints = 4;  ///< of Gauss' rule

/// Arrays for one ray, reused for the next.
struct Work {
  std::vector<double> limits, depth;
  /// Emission [W/(m^3 sr)] and absorption [1/m] at the points of a step, at every wavelength.
  std::vector<double> emission, absorption;
  std::array<double, kPoints> temperature{};  ///< [K]
  std::vector<double> all;                    ///< all channels of the medium at one point
  const CellSampling* cells = nullptr;        ///< the medium, if it has cells
};

/// Gauss-Legendre on [0, 1].
struct GaussRule {
  std::array<double, kPoints> at, weight;
};
const GaussRule kFourPoints = [] {
  const double inner = 0.5 * std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2));
  const double outer = 0.5 * std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2));
  const double share = std::sqrt(30.0) / 72;
  return GaussRule{{0.5 - outer, 0.5 - inner, 0.5 + inner, 0.5 + outer},
                   {0.25 - share, 0.25 + share, 0.25 + share, 0.25 - share}};
}();

/// The largest values at the points of an interval.
struct Deepest {
  double absorption = 0, emission = 0;
};

/// Coefficients of any medium at places of a ray, in the form of CellSampling.
void coefficients_at(const Medium& medium, const Ray& ray, const double* t, std::size_t nodes,
                     Work& work) {
  work.all.resize(static_cast<std::size_t>(medium.channel_count()));
  for (std::size_t g = 0; g < kPoints; ++g) {
    const Vec3 place = ray.at(t[g]);
    const auto at = static_cast<std::ptrdiff_t>(g * nodes);
    const double first = medium.coefficients(place, work.all.data());
    std::copy_n(work.all.begin(), nodes, work.emission.begin() + at);
    if (medium.is_grey())
      std::fill(work.all.begin(), work.all.end(), first);
    else
      medium.absorptions(place, work.all.data());
    std::copy_n(work.all.begin(), nodes, work.absorption.begin() + at);
    work.temperature[g] = medium.sample(place).temperature;
  }
}

/// @param start, width of the interval, which lies between two breakpoints
Deepest look_at(const Medium& medium, const Ray& ray, double start, double width, std::size_t nodes,
                Work& work) {
  std::array<double, kPoints> t{};
  for (std::size_t g = 0; g < kPoints; ++g) t[g] = start + kFourPoints.at[g] * width;
  if (work.cells)
    work.cells->coefficients_between(
        ray, t, static_cast<int>(nodes),
        {work.emission.data(), work.absorption.data(), work.temperature.data()});
  else
    coefficients_at(medium, ray, t.data(), nodes, work);
  return {*std::max_element(work.absorption.begin(), work.absorption.end()),
          *std::max_element(work.emission.begin(), work.emission.end())};
}

/// @param end of the ray, at a solid surface or kInfinity
/// @param before optical depths in front of the ray, at each wavelength; empty: none
MediumTruth through_medium(const Medium& medium, const Ray& ray, double end,
                           const FirstChannel& channel, Work& work,
                           const std::vector<double>& before = {}) {
  MediumTruth truth;
  const std::size_t nodes = channel.weights.size();
  truth.depths = before;
  truth.depths.resize(nodes);
  std::vector<double>& limits = work.limits;
  // The part of the ray within the bounds.
  const RaySpan span = clip_to_box(medium.bounds(), ray, 0, end);
  if (span.empty()) return truth;
  limits.clear();
  medium.append_breakpoints(ray, limits);
  std::erase_if(limits, [&](double t) { return !(t > span.near && t < span.far); });
  limits.push_back(span.near);
  limits.push_back(span.far);
  std::sort(limits.begin(), limits.end());
  work.emission.resize(kPoints * nodes);
  work.absorption.resize(kPoints * nodes);

  for (std::size_t k = 0; k + 1 < limits.size(); ++k) {
    const double start = limits[k], width = limits[k + 1] - start;
    if (!(width > 0)) continue;
    const GaussRule& rule = kFourPoints;
    const Deepest found = look_at(medium, ray, start, width, nodes, work);
    if (!(found.absorption > 0 || found.emission > 0)) continue;
    if (!truth.hit) truth.first = start;
    truth.hit = true;
    truth.last = start + width;
    const int steps = static_cast<int>(
        std::ceil(std::clamp(found.absorption * width / kDeepest, 1.0, kMostSteps)));
    const double step = width / steps;
    for (int i = 0; i < steps; ++i) {
      const double begin = start + i * step;
      // With a single step, the interval has been evaluated already.
      if (steps > 1) look_at(medium, ray, begin, step, nodes, work);
      std::vector<double>& depth = work.depth;
      depth.assign(nodes, 0.0);
      for (std::size_t g = 0; g < rule.at.size(); ++g)
        for (std::size_t n = 0; n < nodes; ++n)
          depth[n] += rule.weight[g] * step * work.absorption[g * nodes + n];
      for (std::size_t g = 0; g < rule.at.size(); ++g) {
        double light = 0;
        for (std::size_t n = 0; n < nodes; ++n)
          // Optical depth to the point within the step, from the mean absorption; exact to second
          // order.
          light += channel.weights[n] * rule.weight[g] * step * work.emission[g * nodes + n] *
                   std::exp(-truth.depths[n] - depth[n] * rule.at[g]);
        truth.radiance += light;
        truth.moment += light * (begin + rule.at[g] * step);
        truth.heat += light * work.temperature[g];
      }
      for (std::size_t n = 0; n < nodes; ++n) truth.depths[n] += depth[n];
    }
  }
  for (std::size_t n = 0; n < nodes; ++n)
    truth.optical_depth += channel.shares[n] * truth.depths[n];
  return truth;
}

/// The chief ray of a pixel, in the camera frame. None: the ray ends in the camera, or the beam of
/// its microlens (without array: of the pixel) meets nothing.
class ChiefRays {
 public:
  /// @param beams nullptr: every ray is followed
  ChiefRays(const Camera& camera, const SceneBeams* beams) : camera_(camera), beams_(beams) {
    const double plane = camera.aim_plane(0), gap = plane - camera.sensor();
    const double pupil = camera.exit_pupil() - camera.sensor();
    towards_axis_ = std::isfinite(pupil) ? gap / pupil : 0.0;
  }
  std::optional<Ray> operator()(int column, int row) {
    const Vec2 s = camera_.sensor_point(column + 0.5, row + 0.5);
    // The microlens that hides the middle of its micro-image, seen from the middle of the pupil.
    const Vec2 before = camera_.foot() + (1 - towards_axis_) * (s - camera_.foot());
    Camera::Path path;
    if (camera_.has_array()) {
      const LensIndex lens = camera_.lattice().nearest(before);
      const Vec3 place = camera_.lens_place(lens);
      if (!sees_anything(lens, place)) return std::nullopt;
      path = camera_.trace(s, lens, {place.x, place.y});
    } else {
      if (beams_ && !beams_->lenses().may_meet(0, {s.x, s.y, camera_.sensor()}))
        return std::nullopt;
      path = camera_.trace(s, std::nullopt, before);
    }
    if (path.status.status != RayStatus::reached) return std::nullopt;
    return path.exit;
  }

 private:
  bool sees_anything(LensIndex lens, Vec3 place) {
    if (!beams_) return true;
    // Neighbouring pixels usually belong to the same microlens.
    if (!looked_ || lens.q != looked_at_.q || lens.r != looked_at_.r) {
      looked_ = true;
      looked_at_ = lens;
      sees_ = beams_->lenses().may_meet(camera_.lattice().type(lens), place);
    }
    return sees_;
  }

  const Camera& camera_;
  const SceneBeams* beams_;
  double towards_axis_ = 0;
  LensIndex looked_at_;
  bool looked_ = false, sees_ = true;
};

/// The truth of a pixel's chief ray; distances from the front vertex along the optical axis [m].
struct PixelTruth {
  int surface = -1;  ///< number; -1: none
  double surface_distance = 0;
  bool hit = false;  ///< the ray meets a flame
  double optical_depth = 0, first = 0, last = 0;
  double light = 0, moment = 0, heat = 0;  ///< radiance; weighted by distance; by temperature
};

/// The truth of a ray, evaluated stretch by stretch at its true position behind windows.
PixelTruth truth_along(const CompiledScene& scene, const Ray& world, const FirstChannel& channel,
                       WorldPaths& paths, Work& work) {
  PixelTruth truth;
  const WorldPath& path = paths.trace(world);
  const std::span<const AirSegment> stretches = paths.stretches(path);
  const RigidTransform to_camera = scene.camera.to_world().inverse();
  const auto along_axis = [&](const Ray& ray, double t) { return to_camera.point(ray.at(t)).z; };
  if (path.hit >= 0) {
    truth.surface = paths.hit(path).where.surface;
    truth.surface_distance = along_axis(stretches.back().ray, stretches.back().far);
  }
  if (!scene.medium) return truth;
  std::vector<double> depths;
  for (const AirSegment& segment : stretches) {
    const MediumTruth part =
        through_medium(*scene.medium, segment.ray, segment.far, channel, work, depths);
    depths = part.depths;
    if (!part.hit) continue;
    if (!truth.hit) truth.first = along_axis(segment.ray, part.first);
    truth.hit = true;
    truth.last = along_axis(segment.ray, part.last);
    truth.optical_depth = part.optical_depth;
    if (!(part.radiance > 0)) continue;
    const double light = segment.throughput * part.radiance;
    truth.light += light;
    truth.moment += light * along_axis(segment.ray, part.moment / part.radiance);
    truth.heat += segment.throughput * part.heat;
  }
  return truth;
}

FirstChannel first_channel(const CompiledScene& scene) {
  if (scene.mix.empty() || !scene.medium) return {{1.0}, {1.0}};
  constexpr double kTemperature = 1700;
  FirstChannel channel;
  double sum = 0;
  for (int n = 0; n < scene.mix.nodes(); ++n) {
    const double weight = scene.mix.weight(0, n);
    channel.weights.push_back(weight);
    channel.shares.push_back(weight > 0 ? weight * scene.medium->source(n, kTemperature) : 0);
    sum += channel.shares.back();
  }
  for (double& share : channel.shares) share /= sum;
  return channel;
}

}  // namespace

void add_ground_truth(const CompiledScene& scene, LightField& light_field,
                      const Execution& execution) {
  const PixelWindow window = light_field.window;
  Image optical_depth(window.width, window.height),
      distance = optical_depth, first = optical_depth, last = optical_depth,
      temperature = optical_depth, surface, surface_distance;
  if (scene.surfaces) surface = surface_distance = optical_depth;
  const auto beams = SceneBeams::make(scene);
  const auto text = light_field.texts.find(kPartOfPicture);
  const Part part = text == light_field.texts.end() ? Part() : part_from(text->second);
  const int across = (window.width + Film::kTile - 1) / Film::kTile;
  const auto is_wanted = [&](int column, int row) {
    return part_of_tile(row / Film::kTile * across + column / Film::kTile, across, part.count) ==
           part.number - 1;
  };
  const FirstChannel channel = first_channel(scene);
  const RigidTransform& to_world = scene.camera.to_world();
  std::mutex mutex;
  int ended = 0;
  const auto tell = [&] {
    if (!execution.progress) return;
    const std::lock_guard lock(mutex);
    Progress progress;
    progress.fraction = static_cast<double>(++ended) / window.height;
    execution.progress(progress);
  };
  const auto set = [&](int column, int row, const PixelTruth& pixel) {
    if (pixel.surface >= 0) {
      surface.at(column, row) = static_cast<float>(pixel.surface + 1);
      surface_distance.at(column, row) = static_cast<float>(pixel.surface_distance);
      distance.at(column, row) = static_cast<float>(pixel.surface_distance);
    }
    if (!pixel.hit) return;
    optical_depth.at(column, row) = static_cast<float>(pixel.optical_depth);
    first.at(column, row) = static_cast<float>(pixel.first);
    last.at(column, row) = static_cast<float>(pixel.last);
    if (!(pixel.light > 0)) return;
    distance.at(column, row) = static_cast<float>(pixel.moment / pixel.light);
    temperature.at(column, row) = static_cast<float>(pixel.heat / pixel.light);
  };
  const bool done =
      parallel_for(execution, static_cast<std::size_t>(window.height), [&](std::size_t line, int) {
        const int row = static_cast<int>(line);
        Work work;
        work.cells = dynamic_cast<const CellSampling*>(scene.medium.get());
        ChiefRays rays(scene.camera, beams.get());
        WorldPaths paths(scene);
        for (int column = 0; column < window.width; ++column) {
          if (!part.is_whole() && !is_wanted(column, row)) continue;
          const std::optional<Ray> ray = rays(window.x + column, window.y + row);
          if (!ray) continue;
          const Ray world{to_world.point(ray->origin), to_world.direction(ray->direction)};
          set(column, row, truth_along(scene, world, channel, paths, work));
        }
        tell();
      });
  if (!done) throw Cancelled();
  light_field.layers[truth::kOpticalDepth] = std::move(optical_depth);
  light_field.layers[truth::kDistance] = std::move(distance);
  light_field.layers[truth::kFirstHit] = std::move(first);
  light_field.layers[truth::kLastHit] = std::move(last);
  light_field.layers[truth::kTemperature] = std::move(temperature);
  if (const auto response = camera_response(scene.scene, scene.scene.channels.front()))
    light_field.numbers["truth.wavelength"] = response->centroid();
  if (!scene.surfaces) return;
  light_field.layers[truth::kSurface] = std::move(surface);
  light_field.layers[truth::kSurfaceDistance] = std::move(surface_distance);
}

}  // namespace plenoflame
