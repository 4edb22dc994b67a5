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

/// Everything by hand: thin main lens f = 100 mm, 40 mm wide, which images an object at 1 m at
/// 111.11 mm; one type of thin microlenses f = 0.2 mm, D = 0.1 mm, B = 0.25 mm, sharp at
/// a = 1 mm, where that image lies; pixels of p = 0.01 mm: s / p = 2.5 |1 - v|, v = 1 mm / a.
inline CameraSpec thin_camera() {
  CameraSpec spec = preset_camera("raytrix-r29");
  spec.lens.focal_length = 100e-3;
  spec.lens.diameter = 40e-3;
  spec.array.model = LensModel::ideal;
  spec.array.lattice = Lattice::square;
  spec.array.pitch = spec.array.diameter = 0.1e-3;
  spec.array.thickness = 0;
  spec.array.sensor_distance = 0.25e-3;
  spec.array.types = {{"one", kInfinity, kInfinity, 1.5, 0.2e-3}};
  spec.sensor = {1000, 500, 0.01e-3};
  spec.focus = {FocusMode::paraxial, 0, 1.0, "one"};
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
