#include "plenoflame/scene/glass_indices.h"

#include "plenoflame/optics/glass.h"

namespace plenoflame {
namespace {

void set_index(const std::string& glass, double wavelength, double& index, const std::string& path,
               const PositionMap& positions) {
  if (glass.empty()) return;
  try {
    index = Glass(glass).index(wavelength);
  } catch (const InputError& error) {
    throw InputError(positions.find(path), path + ": " + error.what());
  }
}

}  // namespace

double design_wavelength(const Scene& scene) {
  for (const ChannelSpec& channel : scene.channels)
    if ((channel.kind == ChannelKind::band || channel.kind == ChannelKind::line) &&
        channel.wavelength > 0)
      return channel.wavelength;
  return kLineD;
}

void set_indices(CameraSpec& camera, double wavelength, const PositionMap& positions) {
  for (std::size_t i = 0; i < camera.lens.surfaces.size(); ++i)
    set_index(camera.lens.surfaces[i].glass, wavelength, camera.lens.surfaces[i].index,
              "camera.lens.surfaces[" + std::to_string(i) + "].glass", positions);
  for (std::size_t i = 0; i < camera.array.types.size(); ++i)
    set_index(camera.array.types[i].glass, wavelength, camera.array.types[i].index,
              "camera.array.types[" + std::to_string(i) + "].glass", positions);
}

void set_indices(Scene& scene, const PositionMap& positions) {
  set_indices(scene.camera, design_wavelength(scene), positions);
}

}  // namespace plenoflame
