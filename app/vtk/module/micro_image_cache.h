#pragma once
#include <memory>

#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame::pipeline {

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

}  // namespace plenoflame::pipeline
