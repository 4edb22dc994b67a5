#include "render/visibility/scene_beams.h"

#include <cmath>

#include "render/visibility/window_displacement.h"

namespace plenoflame {

std::unique_ptr<const SceneBeams> SceneBeams::make(const CompiledScene& scene) {
  std::optional<std::vector<Box>> lit = occupied_boxes(scene);
  return lit ? make(scene, *std::move(lit)) : nullptr;
}

std::unique_ptr<const SceneBeams> SceneBeams::make(const CompiledScene& scene,
                                                   std::vector<Box> lit) {
  if (scene.windows) {
    // Beams are straight. Boxes grow by the largest displacement of bent rays.
    const double room = displacement_by_windows(scene, lit);
    if (!std::isfinite(room)) return nullptr;
    for (Box& box : lit) {
      box.lower = box.lower - Vec3{room, room, room};
      box.upper = box.upper + Vec3{room, room, room};
    }
  }
  return std::make_unique<const SceneBeams>(scene, lit);
}

SceneBeams::SceneBeams(const CompiledScene& scene, const std::vector<Box>& lit)
    : region_(scene.camera, lit),
      lenses_(scene.camera, scene.pupils.tables(), region_),
      pixels_(PixelBeams::make(scene.camera, scene.pupils.tables(), region_)) {
  if (const auto& between = scene.pupils.between())
    between_.emplace(between->camera, std::vector{between->table}, region_);
}

}  // namespace plenoflame
