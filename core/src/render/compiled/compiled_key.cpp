#include <fmt/format.h>

#include <algorithm>

#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"
#include "plenoflame/base/version.h"
#include "plenoflame/render/compiled_camera.h"
#include "plenoflame/scene/scene_differences.h"
#include "plenoflame/scene/scene_file.h"
#include "render/compiled/bundle_file.h"

namespace plenoflame {
namespace {

/// The camera alone, without properties that change no ray.
Scene camera_scene(const CameraSpec& camera) {
  Scene scene;
  scene.camera = camera;
  scene.camera.name.clear();
  const SensorSpec all = camera.sensor;
  SensorSpec& sensor = scene.camera.sensor;
  sensor = {};
  sensor.columns = all.columns;
  sensor.rows = all.rows;
  sensor.pixel_pitch = all.pixel_pitch;
  sensor.pixel_pitch_y = all.pixel_pitch_y;
  sensor.blur = all.blur;
  for (PupilFilterSpec& filter : scene.camera.pupil_filters)
    filter.name.clear(), filter.transmission.clear();
  scene.camera.transmission.filter.clear();
  return scene;
}

/// Refractive indices of a path's glasses at its wavelength, which the scene's text does not hold.
std::string indices_of(const CameraSpec& camera) {
  std::string text;
  for (const SurfaceSpec& surface : camera.lens.surfaces)
    text += fmt::format(" {:.17g}", surface.index);
  for (const MicrolensSpec& type : camera.array.types) text += fmt::format(" {:.17g}", type.index);
  if (camera.transmission.fresnel) text += fmt::format(" at {:.17g} m", camera.wavelength);
  return text;
}

constexpr const char* kIndices = "# indices";

}  // namespace

std::string compiled_key(const CompiledScene& scene) {
  std::string key = write_scene(camera_scene(scene.scene.camera));
  key += std::string(kIndices) + indices_of(scene.scene.camera) + "\n";
  for (const CompiledScene& path : scene.paths())
    key += std::string(kIndices) + indices_of(path.scene.camera) + "\n";
  return key;
}

void check_content(const CompiledScene& scene) {
  const auto refuse = [](const char* what) {
    throw InputError(std::string("a compiled camera sees flames only, and the scene has ") + what +
                     ": render it as it is");
  };
  if (scene.windows) refuse("windows, which bend rays");
  if (scene.surfaces) refuse("solid surfaces");
  if (!scene.scene.lights.empty()) refuse("lights");
  if (!scene.scatterers.empty()) refuse("flames that scatter");
}

void check_compiled(const CompiledScene& scene, const CompiledCamera& camera,
                    const std::string& name) {
  check_content(scene);
  if (camera.version != version())
    throw InputError(fmt::format("{}: was compiled by version {}, and this is {}; compile it again",
                                 name, camera.version, version()));
  const std::string key = compiled_key(scene);
  if (key != camera.key) {
    std::string where = "its wavelengths are others";
    const auto split = [](const std::string& text) { return text.substr(0, text.find(kIndices)); };
    if (split(key) != split(camera.key)) {
      const Scene before = parse_scene(split(camera.key), name).scene;
      const auto differences = scene_differences(before, parse_scene(split(key), name).scene);
      where = "it differs";
      if (!differences.empty())
        where = fmt::format(
            "{} is {} there, {} here", differences.front().path,
            differences.front().before.empty() ? "not given" : differences.front().before,
            differences.front().after.empty() ? "not given" : differences.front().after);
    }
    throw InputError(
        fmt::format("{}: belongs to another camera ({}); compile this one", name, where));
  }
  if (!scene.medium) return;
  Box hull;
  for (const Box& part : scene.medium->occupied()) {
    if (part.empty()) continue;
    if (hull.empty()) hull = part;
    hull.lower = {std::min(hull.lower.x, part.lower.x), std::min(hull.lower.y, part.lower.y),
                  std::min(hull.lower.z, part.lower.z)};
    hull.upper = {std::max(hull.upper.x, part.upper.x), std::max(hull.upper.y, part.upper.y),
                  std::max(hull.upper.z, part.upper.z)};
  }
  if (!hull.empty()) check_region(camera, hull, "the flame", name);
}

void check_region(const CompiledCamera& camera, const Box& box, const std::string& what,
                  const std::string& name) {
  const Box& region = camera.region;
  const Vec3 below = region.lower - box.lower, above = box.upper - region.upper;
  const double beyond = std::max({below.x, below.y, below.z, above.x, above.y, above.z});
  if (beyond > 1e-6 * length(region.upper - region.lower))
    throw mended_by(
        InputError(fmt::format(
            "{}: {} reaches {:.3g} mm beyond the region that it was compiled for; compile the "
            "camera with a larger one",
            name, what, 1e3 * beyond)),
        {"region", "margin"});
}

}  // namespace plenoflame
