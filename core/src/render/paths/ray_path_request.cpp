#include "plenoflame/render/ray_path_request.h"

namespace plenoflame {

RayPaths trace_ray_paths(const CompiledScene& scene, const RayPathRequest& request,
                         const Execution& execution) {
  RenderSettings settings;
  settings.samples = request.rays_per_pixel;
  settings.seed = request.seed.value_or(scene.scene.render.seed);
  RayPaths paths = empty_ray_paths(scene);
  paths.flame_samples = request.flame_samples;
  std::vector<Pixel> pixels = request.pixels;
  const std::vector<Pixel> drawn =
      random_pixels(scene.camera.spec().sensor, request.random_pixels, settings.seed);
  pixels.insert(pixels.end(), drawn.begin(), drawn.end());
  add_pixel_rays(scene, settings, pixels, execution, paths);
  for (const LensIndex lens : request.microlenses)
    add_microlens_rays(scene, settings, lens, execution, paths);
  for (const Vec3 point : request.points)
    add_object_rays(scene, point, request.rays_per_point, paths);
  if (request.chief_rays) add_chief_rays(scene, paths);
  RaySelection selection;
  for (std::size_t status = 0; status < request.statuses.size(); ++status)
    if (request.statuses[status]) selection.statuses.push_back(static_cast<RayStatus>(status));
  if (selection.statuses.empty()) return empty_ray_paths(scene);
  if (selection.statuses.size() == request.statuses.size()) selection.statuses.clear();
  if (request.type >= 0) selection.types = {request.type};
  selection.most = request.most;
  select_rays(selection, paths);
  return paths;
}

}  // namespace plenoflame
