#include "plenoflame/render/ground_truth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/math/ray_span.h"
#include "plenoflame/scene/spectral.h"

namespace plenoflame {
namespace {

/// What one ray meets; distances along the ray.
struct MediumTruth {
  double optical_depth = 0;
  double radiance = 0, moment = 0;  ///< of the first channel; moment: weighted by t
  std::vector<double> depths;       ///< optical, of each wavelength that stands for it
  double heat = 0;                  ///< weighted by the temperature
  double first = 0, last = 0;
  bool hit = false;
};

/// A step is at most this deep, so that what is left of the exponential within it is smooth.
constexpr double kDeepest = 0.1;
constexpr double kMostSteps = 1000;

/// What the medium's wavelengths are to the first channel, one each.
struct FirstChannel {
  std::vector<double> weights;  ///< with which it counts their light
  std::vector<double> shares;   ///< of its light from a body at 1700 K, together 1
};

/// What a ray needs, kept from one to the next.
struct Work {
  std::vector<double> limits, emission, absorption, depth;
  std::array<std::vector<double>, 4> source;
};

/// Emission [W/(m^3 sr)] and absorption [1/m] at a place, of every wavelength.
/// @return the largest absorption of the first `nodes`
double coefficients(const Medium& medium, Vec3 place, std::size_t nodes, Work& work) {
  const double first = medium.coefficients(place, work.emission.data());
  if (medium.is_grey()) {
    std::fill(work.absorption.begin(), work.absorption.end(), first);
    return first;
  }
  medium.absorptions(place, work.absorption.data());
  return *std::max_element(work.absorption.begin(),
                           work.absorption.begin() + static_cast<std::ptrdiff_t>(nodes));
}

/// @param end where the ray ends: at a solid surface, or kInfinity
MediumTruth through_medium(const Medium& medium, const Ray& ray, double end,
                           const FirstChannel& channel, Work& work) {
  MediumTruth truth;
  const std::size_t nodes = channel.weights.size();
  truth.depths.assign(nodes, 0.0);
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
  work.emission.resize(static_cast<std::size_t>(medium.channel_count()));
  work.absorption.resize(work.emission.size());

  // Gauss-Legendre, 4 points on [0, 1].
  const double inner = 0.5 * std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2));
  const double outer = 0.5 * std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2));
  const std::array<double, 4> at{0.5 - outer, 0.5 - inner, 0.5 + inner, 0.5 + outer};
  const double share = std::sqrt(30.0) / 72;
  const std::array<double, 4> weight{0.25 - share, 0.25 + share, 0.25 + share, 0.25 - share};
  for (std::size_t k = 0; k + 1 < limits.size(); ++k) {
    const double start = limits[k], width = limits[k + 1] - start;
    if (!(width > 0)) continue;
    double deepest = 0, brightest = 0;
    for (const double x : at) {
      deepest = std::max(deepest, coefficients(medium, ray.at(start + x * width), nodes, work));
      for (std::size_t n = 0; n < nodes; ++n) brightest = std::max(brightest, work.emission[n]);
    }
    if (!(deepest > 0 || brightest > 0)) continue;
    if (!truth.hit) truth.first = start;
    truth.hit = true;
    truth.last = start + width;
    const int steps =
        static_cast<int>(std::ceil(std::clamp(deepest * width / kDeepest, 1.0, kMostSteps)));
    const double step = width / steps;
    for (int i = 0; i < steps; ++i) {
      const double begin = start + i * step;
      std::vector<double>& depth = work.depth;
      depth.assign(nodes, 0.0);
      for (std::size_t g = 0; g < at.size(); ++g) {
        coefficients(medium, ray.at(begin + at[g] * step), nodes, work);
        work.source[g].assign(work.emission.begin(),
                              work.emission.begin() + static_cast<std::ptrdiff_t>(nodes));
        for (std::size_t n = 0; n < nodes; ++n) depth[n] += weight[g] * step * work.absorption[n];
      }
      for (std::size_t g = 0; g < at.size(); ++g) {
        double light = 0;
        for (std::size_t n = 0; n < nodes; ++n)
          // To the point within the step: the mean absorption, which is exact to second order.
          light += channel.weights[n] * weight[g] * step * work.source[g][n] *
                   std::exp(-truth.depths[n] - depth[n] * at[g]);
        truth.radiance += light;
        truth.moment += light * (begin + at[g] * step);
        truth.heat += light * medium.sample(ray.at(begin + at[g] * step)).temperature;
      }
      for (std::size_t n = 0; n < nodes; ++n) truth.depths[n] += depth[n];
    }
  }
  for (std::size_t n = 0; n < nodes; ++n)
    truth.optical_depth += channel.shares[n] * truth.depths[n];
  return truth;
}

/// The middle ray of a pixel, camera frame; none: it ends in the camera.
class ChiefRays {
 public:
  explicit ChiefRays(const Camera& camera) : camera_(camera) {
    const double plane = camera.aim_plane(0), gap = plane - camera.sensor();
    const double pupil = camera.exit_pupil() - camera.sensor();
    towards_axis_ = std::isfinite(pupil) ? gap / pupil : 0.0;
  }
  std::optional<Ray> operator()(int column, int row) const {
    const Vec2 s = camera_.sensor_point(column + 0.5, row + 0.5);
    // Seen from the middle of the pupil, the microlens stands before the middle of its micro-image.
    const Vec2 before = camera_.foot() + (1 - towards_axis_) * (s - camera_.foot());
    Camera::Path path;
    if (camera_.has_array()) {
      const LensIndex lens = camera_.lattice().nearest(before);
      const Vec3 place = camera_.lens_place(lens);
      path = camera_.trace(s, lens, {place.x, place.y});
    } else {
      path = camera_.trace(s, std::nullopt, before);
    }
    if (path.status.status != RayStatus::reached) return std::nullopt;
    return path.exit;
  }

 private:
  const Camera& camera_;
  double towards_axis_ = 0;
};

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
  const ChiefRays rays(scene.camera);
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
  const bool done =
      parallel_for(execution, static_cast<std::size_t>(window.height), [&](std::size_t line, int) {
        const int row = static_cast<int>(line);
        Work work;
        for (int column = 0; column < window.width; ++column) {
          const std::optional<Ray> ray = rays(window.x + column, window.y + row);
          if (!ray) continue;
          const Ray world{to_world.point(ray->origin), to_world.direction(ray->direction)};
          const auto along_axis = [&](double t) {
            return static_cast<float>(ray->origin.z + t * ray->direction.z);
          };
          SurfaceHit hit;
          hit.t = kInfinity;
          if (scene.surfaces && scene.surfaces->intersect(world, 0, kInfinity, {}, hit)) {
            surface.at(column, row) = static_cast<float>(hit.where.surface + 1);
            surface_distance.at(column, row) = along_axis(hit.t);
            distance.at(column, row) = along_axis(hit.t);
          }
          if (!scene.medium) continue;
          const MediumTruth truth = through_medium(*scene.medium, world, hit.t, channel, work);
          if (!truth.hit) continue;
          optical_depth.at(column, row) = static_cast<float>(truth.optical_depth);
          first.at(column, row) = along_axis(truth.first);
          last.at(column, row) = along_axis(truth.last);
          if (!(truth.radiance > 0)) continue;
          distance.at(column, row) = along_axis(truth.moment / truth.radiance);
          temperature.at(column, row) = static_cast<float>(truth.heat / truth.radiance);
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
