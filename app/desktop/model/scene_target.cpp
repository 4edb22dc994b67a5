#include "model/scene_target.h"

#include "model/jobs/ray_selector.h"

namespace plenoflame::desktop {

Selection target_of(const CompiledScene& scene, const Ray& sight, Targets targets) {
  Vec3 point;
  if (targets == Targets::flame && scene.medium && flame_point(*scene.medium, sight, point))
    return Selection::of_point(point);
  const RigidTransform inverse = scene.camera.to_world().inverse();
  const Ray local{inverse.point(sight.origin), inverse.direction(sight.direction)};
  if (local.direction.z == 0) return {};
  const CameraSpec& spec = scene.scene.camera;
  if (targets == Targets::microlenses && spec.array.present) {
    const double t = (scene.camera.array_front() - local.origin.z) / local.direction.z;
    if (t <= 0) return {};
    const Vec3 p = local.at(t);
    return Selection::of_microlens(scene.camera.lattice().nearest({p.x, p.y}));
  }
  const double t = (scene.camera.sensor() - local.origin.z) / local.direction.z;
  if (t <= 0) return {};
  const Vec3 p = local.at(t);
  const auto [column, row] = scene.camera.image_point({p.x, p.y});
  if (column < 0 || row < 0 || column >= spec.sensor.columns || row >= spec.sensor.rows) return {};
  return Selection::of_pixel(static_cast<int>(column), static_cast<int>(row));
}

}  // namespace plenoflame::desktop
