#pragma once
#include <memory>
#include <string>
#include <utility>

#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame::test {

inline CameraSpec preset_camera(const std::string& name) {
  return parse_scene("[camera]\npreset = \"" + name + "\"\n", "test.toml").scene.camera;
}

inline Execution threads(int count) {
  Execution execution;
  execution.threads = count;
  return execution;
}
inline Execution one_thread() {
  return threads(1);
}

/// A scene of one camera and any medium, without files.
inline CompiledScene scene_of(const CameraSpec& camera, std::shared_ptr<const Medium> medium) {
  Scene scene;
  scene.camera = camera;
  Camera compiled(camera);
  PupilSampling pupils(compiled);
  return {std::move(scene), std::move(compiled), std::move(pupils), std::move(medium)};
}

}  // namespace plenoflame::test
