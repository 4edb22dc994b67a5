#include "model/scene_changes.h"

namespace plenoflame::desktop {
namespace {

/// The part of a sensor that decides about the light that its pixels get.
SensorSpec optical(const SensorSpec& sensor) {
  SensorSpec part;
  part.columns = sensor.columns;
  part.rows = sensor.rows;
  part.pixel_pitch = sensor.pixel_pitch;
  part.pixel_pitch_y = sensor.pixel_pitch_y;
  return part;
}

/// Without what has no effect on any figure. Types of microlenses keep their names: the focus may
/// refer to them. So do channels: the image's names follow them.
Scene without_names(Scene scene) {
  for (FlameSpec& flame : scene.flames) {
    flame.name.clear();
    for (EllipsoidSpec& layer : flame.layers) layer.name.clear();
  }
  for (SolidSurfaceSpec& surface : scene.surfaces) surface.name.clear();
  for (LightSpec& light : scene.lights) light.name.clear();
  if (scene.cameras.empty()) scene.camera.name.clear();  // those of several say which is shown
  return scene;
}

/// The same but for how the cameras' sensors turn light into numbers.
Scene without_electronics(Scene scene) {
  scene.camera.sensor = optical(scene.camera.sensor);
  for (CameraSpec& camera : scene.cameras) camera.sensor = optical(camera.sensor);
  return scene;
}

}  // namespace

SceneChanges changes_between(const Scene& first, const Scene& second) {
  const Scene a = without_names(first), b = without_names(second);
  SceneChanges changes;
  const bool moved = first.file != second.file;  // relative paths start elsewhere
  const Scene optics_a = without_electronics(a), optics_b = without_electronics(b);
  changes.camera = !(optics_a.camera == optics_b.camera && optics_a.cameras == optics_b.cameras &&
                     a.windows == b.windows);
  changes.flames = !(a.flames == b.flames) || (moved && !b.flames.empty());
  changes.solids =
      !(a.surfaces == b.surfaces && a.lights == b.lights) || (moved && !b.surfaces.empty());
  changes.channels = !(a.channels == b.channels);
  changes.samples = a.render.samples != b.render.samples;
  RenderSpec rest = a.render;
  rest.samples = b.render.samples;
  changes.sampling = !(rest == b.render);
  changes.develop = !(a.develop == b.develop) ||
                    (!changes.camera && !(a.camera == b.camera && a.cameras == b.cameras));
  changes.names = !(first == second) && !changes.any();
  return changes;
}

}  // namespace plenoflame::desktop
