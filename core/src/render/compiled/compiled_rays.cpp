#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/film/film.h"
#include "plenoflame/render/compiled_camera.h"
#include "render/compiled/bundle_file.h"

namespace plenoflame {
namespace {

bool holds(const PixelWindow& outer, const PixelWindow& inner) {
  return inner.x >= outer.x && inner.y >= outer.y &&
         inner.x + inner.width <= outer.x + outer.width &&
         inner.y + inner.height <= outer.y + outer.height;
}

}  // namespace

CompiledContent content_for(const CompiledCamera& camera, std::size_t tile, std::size_t paths,
                            std::size_t parts, const std::string& name) {
  CompiledContent content = camera.content(tile);
  if (!std::all_of(content.groups.begin(), content.groups.end(), [&](const CompiledGroup& group) {
        return group.path < paths && group.part < parts;
      }))
    throw FileError(name + ": is damaged; compile the camera again");
  return content;
}

void check_compiled_window(const CompiledCamera& camera, const PixelWindow& window,
                           const std::string& name) {
  if (!holds(camera.window, window))
    throw UsageError(fmt::format(
        "{}: holds the window {},{},{},{} of the sensor only; ask for a part of that, or compile a "
        "larger one",
        name, camera.window.x, camera.window.y, camera.window.width, camera.window.height));
}

std::vector<CompiledRay> rays_of_tile(const CompiledScene& scene, const CompiledCamera& camera,
                                      std::size_t tile, const std::string& name) {
  std::vector<CompiledRay> rays;
  if (camera.tiles[tile].groups == 0) return rays;
  std::size_t parts = 1;
  const auto paths = scene.paths();
  for (const CompiledScene& path : paths) parts = std::max(parts, path.part_mixes.size());
  const CompiledContent content = content_for(camera, tile, paths.size(), parts, name);
  const PixelWindow from = Film(camera.window, 1, 1).tile(static_cast<int>(tile));
  rays.reserve(content.nodes.size());
  std::size_t node = 0;
  for (const CompiledGroup& group : content.groups) {
    const std::size_t second = node + group.count[0], end = second + group.count[1];
    for (; node < end; ++node) {
      const CompiledNode& kept = content.nodes[node];
      std::array<double, 4> at{};
      for (std::size_t k = 0; k < 4; ++k)
        at[k] = static_cast<double>(group.lower[k]) +
                static_cast<double>(group.step[k]) * static_cast<double>(kept.place[k]);
      CompiledRay ray;
      ray.column = from.x + group.pixel % Film::kTile;
      ray.row = from.y + group.pixel / Film::kTile;
      ray.path = group.path;
      ray.part = group.part;
      ray.set = node < second ? 0 : 1;
      ray.place = camera.anchor + at[0] * camera.across + at[1] * camera.down;
      ray.direction = normalize(camera.along + at[2] * camera.across + at[3] * camera.down);
      ray.weight = 0.5 * static_cast<double>(kept.weight);
      rays.push_back(ray);
    }
  }
  return rays;
}

}  // namespace plenoflame
