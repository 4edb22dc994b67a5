#include "model/scene_changes.h"

namespace plenoflame::desktop {
namespace {

/// Without what has no effect on any figure. Types of microlenses keep their names: the focus may
/// refer to them. So do channels: the image's names follow them.
Scene without_names(Scene scene) {
  for (FlameSpec& flame : scene.flames) {
    flame.name.clear();
    for (EllipsoidSpec& layer : flame.layers) layer.name.clear();
  }
  for (SolidSurfaceSpec& surface : scene.surfaces) surface.name.clear();
  for (LightSpec& light : scene.lights) light.name.clear();
  return scene;
}

}  // namespace

SceneChanges changes_between(const Scene& first, const Scene& second) {
  const Scene a = without_names(first), b = without_names(second);
  SceneChanges changes;
  const bool moved = first.file != second.file;  // relative paths start elsewhere
  changes.camera = !(a.camera == b.camera);
  changes.flames = !(a.flames == b.flames) || (moved && !b.flames.empty());
  changes.solids =
      !(a.surfaces == b.surfaces && a.lights == b.lights) || (moved && !b.surfaces.empty());
  changes.channels = !(a.channels == b.channels);
  changes.samples = a.render.samples != b.render.samples;
  RenderSpec rest = a.render;
  rest.samples = b.render.samples;
  changes.sampling = !(rest == b.render);
  changes.develop = !(a.develop == b.develop);
  changes.names = !(first == second) && !changes.any();
  return changes;
}

}  // namespace plenoflame::desktop
