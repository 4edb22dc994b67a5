#pragma once
#include <string>

#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame::test {

/// The layered flame of the preset, 1 m in front of the paper's camera, with a sensor of a few
/// hundred pixels; `shift` [m] moves the flame to the right of the picture.
inline Scene paper_flame(int columns, int rows, double shift = 0) {
  Scene scene = parse_scene(
                    "[camera]\npreset = \"paper-plenoptic2\"\n[[flames]]\npreset = "
                    "\"paper-layered\"\nposition = [\"1 m\", \"0 m\", \"-29 mm\"]\n",
                    "test.toml")
                    .scene;
  scene.camera.sensor.columns = columns;
  scene.camera.sensor.rows = rows;
  scene.flames[0].position.y = -shift;  // the world's y is the camera's left
  return scene;
}

/// The same without array: a sensor of large pixels in the focus of an ideal lens.
inline Scene bare_flame(int columns, int rows, double pixel_pitch) {
  Scene scene = paper_flame(columns, rows);
  scene.camera.array = {};
  scene.camera.focus.conjugate = "sensor";
  scene.camera.lens.model = LensModel::ideal;
  scene.camera.sensor.pixel_pitch = pixel_pitch;
  return scene;
}

}  // namespace plenoflame::test
