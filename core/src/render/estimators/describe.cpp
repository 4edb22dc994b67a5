#include "plenoflame/render/describe.h"

#include <cmath>

#include "plenoflame/base/version.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame {

void describe(const CompiledScene& scene, LightField& field) {
  describe(scene.scene, scene.camera, field);
}

void describe(const Scene& scene, const Camera& camera, LightField& field) {
  field.scene_text = write_scene(scene);
  field.version = version();
  const CameraSpec& spec = camera.spec();
  field.numbers["lens.focal_length"] = camera.lens_first_order().focal_length;
  field.numbers["lens.f_number"] =
      camera.lens_first_order().focal_length / camera.lens_first_order().entrance_pupil_diameter;
  field.numbers["lens.distance"] = camera.lens_distance();
  field.numbers["lens.exit_pupil"] = camera.exit_pupil();
  if (spec.focus.mode != FocusMode::distance && std::isfinite(spec.focus.object_distance))
    field.numbers["focus.object_distance"] = spec.focus.object_distance;
  field.numbers["sensor.position"] = camera.sensor();
  field.numbers["sensor.pixel_pitch"] = spec.sensor.pixel_pitch;
  if (!spec.sensor.square_pixels())
    field.numbers["sensor.pixel_pitch_y"] = spec.sensor.pixel_pitch_y;
  if (!spec.name.empty()) field.texts["camera"] = spec.name;
  if (!camera.has_array()) return;
  field.numbers["array.pitch"] = spec.array.pitch;
  field.numbers["array.position"] = camera.array_front();
  for (const Microlens& lens : camera.microlenses()) {
    field.numbers["array." + lens.name + ".focal_length"] = lens.first_order.focal_length;
    field.numbers["array." + lens.name + ".sensor_distance"] = lens.sensor_distance;
  }
}

}  // namespace plenoflame
