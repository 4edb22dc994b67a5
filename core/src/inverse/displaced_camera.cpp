#include "inverse/displaced_camera.h"

#include <cmath>

namespace plenoflame {

void displace(CameraSpec& camera, SuspectKind kind, double amount) {
  const Vec3 look = normalize(camera.look_direction);
  const Vec3 right = normalize(cross(look, camera.up)), up = cross(right, look);
  switch (kind) {
    case SuspectKind::right:
      camera.position = camera.position + amount * right;
      break;
    case SuspectKind::up:
      camera.position = camera.position + amount * up;
      break;
    case SuspectKind::forward:
      camera.position = camera.position + amount * look;
      break;
    case SuspectKind::turn:
      camera.up = std::cos(amount) * up + std::sin(amount) * right;
      break;
    case SuspectKind::focus:
      camera.focus.lens_distance *= 1 - amount;
      camera.focus.object_distance *= 1 + amount;
      break;
    case SuspectKind::exposure:
    case SuspectKind::stray_light:
    case SuspectKind::absorption:
      break;
  }
}

CompiledScene displaced_scene(const CompiledScene& scene, SuspectKind kind, double amount) {
  Scene moved = scene.scene;
  moved.flames.clear();
  displace(moved.camera, kind, amount);
  return compile(moved);
}

}  // namespace plenoflame
