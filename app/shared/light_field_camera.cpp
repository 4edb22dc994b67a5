#include "light_field_camera.h"

#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/scene_settings.h"
#include "plenoflame/scene/validate.h"

namespace plenoflame {

void check_camera_of(const SceneDocument& document, const std::string& path) {
  Scene alone;
  alone.camera = document.scene.camera;
  alone.channels = document.scene.channels;
  try {
    validate(alone, document.positions);
  } catch (const InputError& error) {
    if (error.position().file.empty()) throw InputError(SourcePosition{path}, error.what());
    throw;
  }
}

SceneDocument scene_of(const LightField& field, const std::string& name) {
  if (field.scene_text.empty())
    throw InputError(name + " holds no scene, so its camera is not known");
  SceneDocument document = for_camera(parse_embedded_scene(field.scene_text, name));
  check_camera_of(document, "scene of " + name);
  return document;
}

TakenThrough taken_through(const LightField& field) {
  Scene scene = scene_of(field, "the light field").scene;
  check_raw_image(field, scene.camera);
  return {std::move(scene.camera), std::move(scene.windows)};
}

}  // namespace plenoflame
