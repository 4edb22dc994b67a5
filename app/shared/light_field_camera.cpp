#include "light_field_camera.h"

#include "plenoflame/base/error.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame {

CameraSpec camera_of(const LightField& field) {
  if (field.scene_text.empty())
    throw InputError("the light field holds no scene, so its camera is not known");
  const CameraSpec camera = parse_scene(field.scene_text, "scene of the light field").scene.camera;
  check_raw_image(field, camera);
  return camera;
}

}  // namespace plenoflame
