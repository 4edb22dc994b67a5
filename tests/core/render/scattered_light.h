#pragma once
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/solids/mean_radiance.h"
#include "plenoflame/media/layered_medium.h"
#include "plenoflame/sampling/sobol.h"
#include "render/transport/scatter_walk.h"
#include "support/tally.h"

/// Light along single rays of scenes that scatter, without a camera.
namespace plenoflame::test {

inline ScatteringSpec henyey_greenstein(double albedo, double g) {
  return {albedo, PhaseFunction::henyey_greenstein, g};
}
inline ScatteringSpec rayleigh(double albedo) {
  return {albedo, PhaseFunction::rayleigh, 0};
}

/// Cold gas in an ellipsoid, in one channel. @param extinction [1/m]
inline CompiledScene smoke(Vec3 semi_axes, double extinction, const ScatteringSpec& spec,
                           const std::vector<SolidSurfaceSpec>& surfaces,
                           const std::vector<LightSpec>& lights, int reflections = 1) {
  CompiledScene scene = lit_scene(surfaces, lights, reflections);
  if (surfaces.empty()) scene.surfaces = nullptr;
  scene.medium =
      make_layered_medium({{{}, semi_axes, 1, extinction}}, {}, {SourceFunction::total()});
  scene.scatterers = {{scene.medium.get(), spec}};
  return scene;
}

/// The light that the medium scatters into whole lines, one sample each, per node; without any
/// surfaces.
inline std::vector<Tally> scattered_along(const CompiledScene& scene, const std::vector<Ray>& rays,
                                          std::uint64_t seed) {
  const ScatterPlan plan(scene, {}, {});
  ScatterWalk walk(plan);
  MediumCounters counters;
  std::vector<Tally> tallies(static_cast<std::size_t>(scene.node_count()));
  constexpr std::size_t kBatch = 500;
  for (std::size_t begin = 0; begin < rays.size(); begin += kBatch) {
    const std::size_t count = std::min(kBatch, rays.size() - begin);
    std::vector<ScatterWalk::Start> starts;
    for (std::size_t i = 0; i < count; ++i)
      starts.push_back({static_cast<int>(i), rays[begin + i], mix64(seed) ^ (2 * (begin + i))});
    std::vector<std::vector<double>> radiance(tallies.size(), std::vector<double>(count));
    walk.add(starts, radiance, counters);
    for (std::size_t c = 0; c < tallies.size(); ++c)
      for (const double l : radiance[c]) tallies[c].add(l);
  }
  return tallies;
}

/// Radiance along rays, as a camera would see it, one sample each, per node.
/// @param rays whose origins are outside of the medium
inline std::vector<Tally> nodes_along(const CompiledScene& scene, const std::vector<Ray>& rays,
                                      std::uint64_t seed) {
  const auto light = make_surface_light(scene, {}, {});
  const auto plan = make_scatter_plan(scene, {}, {}, light.get());
  ScatterWalk walk(*plan);
  MediumSegments segments(scene.medium.get(), plan->options);
  MediumCounters counters;
  Random random(seed);
  std::vector<Tally> tallies(static_cast<std::size_t>(scene.node_count()));
  constexpr std::size_t kBatch = 500;
  for (std::size_t begin = 0; begin < rays.size(); begin += kBatch) {
    const std::size_t count = std::min(kBatch, rays.size() - begin);
    std::vector<std::vector<double>> scattered(tallies.size(), std::vector<double>(count)),
        behind = scattered;
    std::vector<ScatterWalk::Start> starts;
    std::vector<SurfacePath> paths;
    std::vector<SurfaceLight::First> first;
    segments.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const Ray& ray = rays[begin + i];
      const std::uint64_t key = mix64(seed) ^ (2 * (begin + i));
      SurfacePath path;
      path.ray = static_cast<int>(i);
      path.key = mix64(key + 1);
      double far = kInfinity;
      if (scene.surfaces && scene.surfaces->intersect(ray, 0, kInfinity, {}, path.hit)) {
        far = path.hit.t;
        paths.push_back(path);
        first.push_back({{random(), random(), random(), random()}});
      } else {
        for (std::size_t c = 0; c < scene.lights.environment.size(); ++c)
          behind[c][i] = scene.lights.environment[c];
      }
      starts.push_back({static_cast<int>(i), ray, key, far});
      segments.add(ray, far);
    }
    segments.integrate(true, counters);
    // Every other ray lets thin media draw places evenly.
    for (std::size_t i = 0; i < count; i += 2) starts[i].even = segments.transmittance(i);
    walk.add(starts, scattered, counters);
    walk.add_surfaces(paths, first, behind, counters);
    for (std::size_t c = 0; c < tallies.size(); ++c)
      for (std::size_t i = 0; i < count; ++i)
        tallies[c].add(segments.radiance(i, static_cast<int>(c)) +
                       segments.transmittance(i, c) * behind[c][i] + scattered[c][i]);
  }
  return tallies;
}

/// The same of the first node.
inline Tally radiance_along(const CompiledScene& scene, const std::vector<Ray>& rays,
                            std::uint64_t seed) {
  return nodes_along(scene, rays, seed).front();
}

}  // namespace plenoflame::test
