#pragma once
#include <memory>

#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {

/// The camera that a light field was taken with. @throws InputError: the light field holds no
/// scene, or pixels that are not its camera's
CameraSpec camera_of(const LightField& field);

namespace pipeline {

/// The micro-images of the camera that was asked for last: tracing them takes longer than what
/// filters do with them.
class MicroImageCache {
 public:
  const MicroImages& get(const CameraSpec& camera, bool white, const Execution& execution) {
    if (!held_ || white_ != white || !(held_->camera().spec() == camera)) {
      held_ = std::make_unique<MicroImages>(Camera(camera), white, execution);
      white_ = white;
    }
    return *held_;
  }

 private:
  std::unique_ptr<MicroImages> held_;
  bool white_ = false;
};

}  // namespace pipeline
}  // namespace plenoflame
