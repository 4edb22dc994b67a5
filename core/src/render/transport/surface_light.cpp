#include "render/transport/surface_light.h"

#include <cmath>
#include <limits>

#include "plenoflame/base/constants.h"
#include "plenoflame/sampling/philox.h"
#include "sampling/directions.h"
#include "solids/light_direction.h"

namespace plenoflame {
namespace {

/// The emission is sampled with numbers that no path uses.
constexpr std::uint64_t kSurfaceFlameSeed = 0x666c616d65u;

/// Light needs no fine grid, since nearby lines have nearly equal radiance.
constexpr int kSurfaceFlameCells = 24;

}  // namespace

SurfaceLightPlan::SurfaceLightPlan(const CompiledScene& compiled, const RenderSettings& settings,
                                   const Execution& execution)
    : scene(&compiled),
      channels(compiled.node_count()),
      reflections(compiled.scene.render.reflections) {
  options.isa = settings.isa;
  options.skip = settings.skip;
  if (!compiled.surfaces) return;
  add_emitters();
  scatters = reflections > 0 && !compiled.scatterers.empty();
  follow_last = reflections > 0 && (emitters || !compiled.lights.environment.empty());
  if (reflections > 0 && compiled.medium && compiled.scene.render.flame_light) {
    flame = std::make_unique<EmissionProposal>(*compiled.medium, settings.seed ^ kSurfaceFlameSeed,
                                               execution, kSurfaceFlameCells);
    if (flame->dark()) flame.reset();
  }
}

std::unique_ptr<const SurfaceLightPlan> make_surface_light(const CompiledScene& scene,
                                                           const RenderSettings& settings,
                                                           const Execution& execution) {
  if (!scene.surfaces && scene.lights.environment.empty()) return nullptr;
  return std::make_unique<SurfaceLightPlan>(scene, settings, execution);
}

void SurfaceLightPlan::add_emitters() {
  const SurfaceScene& surfaces = *scene->surfaces;
  area_density.assign(static_cast<std::size_t>(surfaces.surface_count()), 0.0);
  double total = 0;
  for (int i = 0; i < surfaces.surface_count(); ++i) {
    const double* emission = surfaces.emission(i, true);
    if (!emission) continue;
    emitters = true;
    if (!std::isfinite(surfaces.area(i))) continue;
    // In proportion to the emitted power; every channel has the same weight.
    double power = 0;
    for (int c = 0; c < channels; ++c) power += emission[c];
    power *= surfaces.area(i) * (surfaces.emission(i, false) ? 2 : 1);
    if (!(power > 0)) continue;
    total += power;
    emitting.push_back({i, total});
    area_density[static_cast<std::size_t>(i)] = power / surfaces.area(i);
  }
  for (Emitter& emitter : emitting) emitter.share /= total;
  if (total > 0)
    for (double& density : area_density) density /= total;
}

SurfaceLight::SurfaceLight(const SurfaceLightPlan& plan)
    : plan_(plan), segments_(plan.scene->medium.get(), plan.options) {}

void SurfaceLight::add(std::vector<SurfacePath>& paths, const std::vector<First>& first,
                       std::vector<std::vector<double>>& radiance, MediumCounters& counters) {
  const std::vector<First>* random = &first;
  for (int depth = 0; !paths.empty(); ++depth) {
    add_emission(paths, radiance);
    if (depth == plan_.reflections) return;
    add_delta_lights(paths, radiance, counters);
    if (depth > 0 && plan_.random()) {
      random_.resize(paths.size());
      for (std::size_t i = 0; i < paths.size(); ++i) {
        const auto word = philox(paths[i].key, static_cast<std::uint64_t>(depth), 0);
        for (std::size_t k = 0; k < 4; ++k) random_[i].u[k] = unit_uniform(word[k]);
      }
      random = &random_;
    }
    if (plan_.flame) add_flame(paths, *random, depth, radiance, counters);
    if (!plan_.emitting.empty()) add_emitters(paths, *random, depth, radiance, counters);
    if (depth + 1 == plan_.reflections && !plan_.follow_last) return;
    go_on(paths, *random, radiance, counters);
  }
}

void SurfaceLight::add_emission(const std::vector<SurfacePath>& paths,
                                std::vector<std::vector<double>>& radiance) const {
  if (!plan_.emitters) return;
  for (const SurfacePath& path : paths) {
    const double* emission =
        plan_.scene->surfaces->emission(path.hit.where.surface, path.hit.front);
    if (!emission) continue;
    double weight = 1;
    if (path.density > 0)  // shared with samples of emitters
      weight = path.density / (path.density + plan_.emitter_density(path.hit.where.surface,
                                                                    path.hit.t, path.cosine));
    for (std::size_t c = 0; c < radiance.size(); ++c)
      radiance[c][static_cast<std::size_t>(path.ray)] += weight * path.share(c) * emission[c];
  }
}

/// Samples points of emitting surfaces, evenly over their area.
void SurfaceLight::add_emitters(const std::vector<SurfacePath>& paths,
                                const std::vector<First>& random, int depth,
                                std::vector<std::vector<double>>& radiance,
                                MediumCounters& counters) {
  const SurfaceScene& surfaces = *plan_.scene->surfaces;
  segments_.clear();
  samples_.clear();
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const SurfacePath& path = paths[i];
    if (!(path.hit.reflectivity > 0)) continue;
    const auto word = philox(path.key, static_cast<std::uint64_t>(depth), 2);
    const double choice = unit_uniform(word[0]);
    std::size_t k = 0;
    while (k + 1 < plan_.emitting.size() && choice > plan_.emitting[k].share) ++k;
    const int surface = plan_.emitting[k].surface;
    const bool taken = plan_.flame != nullptr;  // u[2] and u[3], by the flame's point
    const SurfacePoint point = surfaces.point_on(surface, unit_uniform(word[1]),
                                                 taken ? unit_uniform(word[2]) : random[i].u[2],
                                                 taken ? unit_uniform(word[3]) : random[i].u[3]);
    const Vec3 to_point = point.point - path.hit.point;
    const double distance = length(to_point);
    if (!(distance > 0)) continue;
    const Ray ray{path.hit.point, (1 / distance) * to_point};
    const double cosine = dot(path.hit.normal, ray.direction);
    const double leaving = -dot(point.normal, ray.direction);
    if (!(cosine > 0) || leaving == 0) continue;
    const bool front = leaving > 0;
    if (!surfaces.emission(surface, front)) continue;
    // The first surface on the ray must be this side of this part, so distances need no comparison.
    SurfaceHit hit;
    rays_ += 1;
    if (!surfaces.intersect(ray, 0, kInfinity, path.hit.where, hit)) continue;
    if (!(hit.where == point.where) || hit.front != front) continue;
    segments_.add(ray, distance);
    const double density = plan_.emitter_density(surface, distance, std::fabs(leaving));
    samples_.push_back({path.ray, i,
                        path.throughput * path.hit.reflectivity / constants::pi * cosine /
                            (density + cosine / constants::pi),
                        static_cast<std::size_t>(surface)});
  }
  segments_.integrate(false, counters);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    const double* emission = surfaces.emission(static_cast<int>(sample.light), true);
    const std::vector<double>& passed = paths[sample.path].passed;
    for (std::size_t c = 0; c < radiance.size(); ++c) {
      const double weight = sample.weight * segments_.transmittance(i, c);
      radiance[c][static_cast<std::size_t>(sample.ray)] +=
          (passed.empty() ? weight : weight * passed[c]) * emission[c];
    }
  }
}

void SurfaceLight::add_delta_lights(const std::vector<SurfacePath>& paths,
                                    std::vector<std::vector<double>>& radiance,
                                    MediumCounters& counters) {
  const std::vector<DeltaLight>& lights = plan_.scene->lights.delta;
  if (lights.empty()) return;
  segments_.clear();
  samples_.clear();
  for (std::size_t p = 0; p < paths.size(); ++p) {
    const SurfacePath& path = paths[p];
    if (!(path.hit.reflectivity > 0)) continue;
    for (std::size_t l = 0; l < lights.size(); ++l) {
      const std::optional<LightDirection> to = direction_to(lights[l], path.hit.point);
      if (!to) continue;
      const double cosine = dot(path.hit.normal, to->way);
      if (!(cosine > 0)) continue;
      const Ray ray{path.hit.point, to->way};
      rays_ += 1;
      if (plan_.scene->surfaces->occluded(ray, 0, to->distance, path.hit.where)) continue;
      segments_.add(ray, to->distance);
      samples_.push_back(
          {path.ray, p, path.throughput * path.hit.reflectivity / constants::pi * cosine * to->fall,
           l});
    }
  }
  segments_.integrate(false, counters);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    const std::vector<double>& passed = paths[sample.path].passed;
    for (std::size_t c = 0; c < radiance.size(); ++c) {
      const double weight = sample.weight * segments_.transmittance(i, c);
      radiance[c][static_cast<std::size_t>(sample.ray)] +=
          (passed.empty() ? weight : weight * passed[c]) * lights[sample.light].strength[c];
    }
  }
}

/// Draws a point of the flame in proportion to its emission. The sample is the radiance of the
/// whole line through the point. It is divided by the density with which any point of that line is
/// drawn. This sample stays bounded where a surface touches the flame, unlike the light of single
/// points.
void SurfaceLight::add_flame(const std::vector<SurfacePath>& paths,
                             const std::vector<First>& random, int depth,
                             std::vector<std::vector<double>>& radiance, MediumCounters& counters) {
  segments_.clear();
  samples_.clear();
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const SurfacePath& path = paths[i];
    if (!(path.hit.reflectivity > 0)) continue;
    const auto word = philox(path.key, static_cast<std::uint64_t>(depth), 1);
    const EmissionProposal::Point point = plan_.flame->draw(
        random[i].u[2], random[i].u[3], unit_uniform(word[0]), unit_uniform(word[1]));
    const Vec3 to_point = point.position - path.hit.point;
    const double distance = length(to_point);
    if (!(distance > 0)) continue;
    const Ray ray{path.hit.point, (1 / distance) * to_point};
    const double cosine = dot(path.hit.normal, ray.direction);
    if (!(cosine > 0)) continue;
    const double density = plan_.flame->direction_density(ray);
    if (!(density > 0)) continue;
    SurfaceHit behind;
    rays_ += 1;
    const bool ends = plan_.scene->surfaces->intersect(ray, 0, kInfinity, path.hit.where, behind);
    segments_.add(ray, ends ? behind.t : kInfinity);
    samples_.push_back({path.ray, i,
                        path.throughput * path.hit.reflectivity / constants::pi * cosine / density,
                        0});
  }
  segments_.integrate(true, counters);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    const std::vector<double>& passed = paths[sample.path].passed;
    for (std::size_t c = 0; c < radiance.size(); ++c)
      radiance[c][static_cast<std::size_t>(sample.ray)] +=
          (passed.empty() ? sample.weight : sample.weight * passed[c]) *
          segments_.radiance(i, static_cast<int>(c));
  }
}

void SurfaceLight::go_on(std::vector<SurfacePath>& paths, const std::vector<First>& random,
                         std::vector<std::vector<double>>& radiance, MediumCounters& counters) {
  const std::vector<double>& environment = plan_.scene->lights.environment;
  segments_.clear();
  next_.clear();
  for (std::size_t i = 0; i < paths.size(); ++i) {
    SurfacePath path = paths[i];
    if (!(path.hit.reflectivity > 0)) continue;
    const Ray ray{path.hit.point,
                  cosine_direction(path.hit.normal, random[i].u[0], random[i].u[1])};
    path.throughput *= path.hit.reflectivity;
    path.density = dot(path.hit.normal, ray.direction) / constants::pi;
    rays_ += 1;
    const SurfacePart from = path.hit.where;
    const bool ends = plan_.scene->surfaces->intersect(ray, 0, kInfinity, from, path.hit);
    path.cosine = std::fabs(dot(path.hit.normal, ray.direction));
    if (!ends) path.hit.where = {};
    if (!ends && environment.empty()) continue;
    segments_.add(ray, ends ? path.hit.t : kInfinity);
    next_.push_back(path);
  }
  segments_.integrate(false, counters);
  paths.clear();
  for (std::size_t i = 0; i < next_.size(); ++i) {
    SurfacePath& path = next_[i];
    if (segments_.is_grey()) {
      path.throughput *= segments_.transmittance(i);
    } else {
      path.passed.resize(radiance.size(), 1.0);
      for (std::size_t c = 0; c < path.passed.size(); ++c)
        path.passed[c] *= segments_.transmittance(i, c);
    }
    if (path.hit.where.surface >= 0) {
      paths.push_back(path);
      continue;
    }
    for (std::size_t c = 0; c < radiance.size(); ++c)
      radiance[c][static_cast<std::size_t>(path.ray)] += path.share(c) * environment[c];
  }
}

}  // namespace plenoflame
