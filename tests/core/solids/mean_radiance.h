#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "core/solids/surface_samples.h"
#include "render/transport/surface_light.h"
#include "support/cameras.h"

/// The light on a surface, without a camera.
namespace plenoflame::test {

inline CompiledScene lit_scene(const std::vector<SolidSurfaceSpec>& surfaces,
                               const std::vector<LightSpec>& lights, int reflections = 1,
                               const std::string& folder = "") {
  CameraSpec camera;  // any: none looks at it
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = 0.1;
  camera.lens.diameter = 0.01;
  camera.sensor = {2, 2, 1e-6};
  camera.focus.object_distance = 1;
  camera.focus.conjugate = "sensor";
  CompiledScene scene = scene_of(camera, nullptr);
  scene.scene.surfaces = surfaces;
  scene.scene.lights = lights;
  scene.scene.render.reflections = reflections;
  scene.surfaces = scene_of(surfaces, folder);
  scene.lights = compile_lights(lights, {SourceFunction::total()});
  return scene;
}

struct Mean {
  double value, error;
};

/// Radiance that leaves the front of a surface, averaged over points drawn on it.
inline Mean mean_radiance(const CompiledScene& scene, int surface, int points, std::uint64_t seed) {
  const SurfaceLightPlan plan(scene, {}, {});
  SurfaceLight light(plan);
  Random random(seed);
  std::vector<SurfacePath> paths;
  std::vector<SurfaceLight::First> first;
  for (int i = 0; i < points; ++i) {
    const SurfacePoint p = scene.surfaces->point_on(surface, random(), random(), random());
    SurfacePath path;
    path.ray = i;
    path.key = static_cast<std::uint64_t>(i) * 977 + seed;
    path.hit.point = p.point;
    path.hit.normal = p.normal;
    path.hit.where = p.where;
    path.hit.reflectivity =
        scene.scene.surfaces[static_cast<std::size_t>(surface)].material.reflectivity;
    paths.push_back(path);
    first.push_back({{random(), random(), random(), random()}});
  }
  std::vector<std::vector<double>> radiance(1,
                                            std::vector<double>(static_cast<std::size_t>(points)));
  MediumCounters counters;
  light.add(paths, first, radiance, counters);
  double sum = 0, squares = 0;
  for (const double r : radiance[0]) {
    sum += r;
    squares += r * r;
  }
  const double mean = sum / points;
  return {mean, std::sqrt(std::max(0.0, squares / points - mean * mean) / points)};
}

}  // namespace plenoflame::test
