#include "render/scene_beams.h"

namespace plenoflame {

std::unique_ptr<const SceneBeams> SceneBeams::make(const CompiledScene& scene) {
  const std::optional<std::vector<Box>> lit = lit_boxes(scene);
  return lit ? std::make_unique<const SceneBeams>(scene, *lit) : nullptr;
}

SceneBeams::SceneBeams(const CompiledScene& scene, const std::vector<Box>& lit)
    : region_(scene.camera, lit),
      lenses_(scene.camera, scene.pupils.tables(), region_),
      pixels_(PixelBeams::make(scene.camera, scene.pupils.tables(), region_)) {
  if (const auto& between = scene.pupils.between())
    between_.emplace(between->camera, std::vector{between->table}, region_);
}

}  // namespace plenoflame
