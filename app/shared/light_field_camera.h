#pragma once
#include <memory>
#include <string>
#include <vector>

#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame {

/// The scene that a light field holds, of its one camera, which is checked; what burns may have
/// moved. No file that the scene names is opened.
/// @param name of the light field, for messages
/// @throws InputError also for a light field without a scene
SceneDocument scene_of(const LightField& field, const std::string& name);

/// Validates the part of a scene with which a light field is evaluated: the camera, and the
/// channels of its filters.
/// @param path of the scene, for messages @throws InputError
void check_camera_of(const SceneDocument& document, const std::string& path);

/// Through which optics a light field was taken.
struct TakenThrough {
  CameraSpec camera;
  std::vector<WindowSpec> windows;  ///< with their indices set
};

/// @throws InputError: the light field holds no scene, or pixels that are not its camera's
TakenThrough taken_through(const LightField& field);

namespace pipeline {

/// The micro-images of the latest requested camera, seen through its windows. Tracing them takes
/// longer than the filters' use of them.
class MicroImageCache {
 public:
  const MicroImages& get(const TakenThrough& optics, bool white, const Execution& execution) {
    if (!held_ || white_ != white || !(held_->camera().spec() == optics.camera)) {
      held_ = std::make_unique<MicroImages>(Camera(optics.camera), white, execution);
      white_ = white;
    }
    held_->look_through(optics.windows);
    return *held_;
  }

 private:
  std::unique_ptr<MicroImages> held_;
  bool white_ = false;
};

}  // namespace pipeline
}  // namespace plenoflame
