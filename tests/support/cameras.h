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

/// The paper's array behind a double Gauss of six elements, whose stop is in its middle: pupil
/// aberrations, and rims that cut the pupil.
inline CameraSpec double_gauss_camera() {
  CameraSpec spec = preset_camera("paper-plenoptic2");
  spec.lens = parse_scene("[camera.lens]\npreset = \"double-gauss-100mm\"\n", "test.toml")
                  .scene.camera.lens;
  spec.sensor.columns = spec.sensor.rows = 1500;
  return spec;
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
