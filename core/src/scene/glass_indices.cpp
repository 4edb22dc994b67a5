#include "plenoflame/scene/glass_indices.h"

#include "plenoflame/optics/glass.h"
#include "plenoflame/scene/channel_kinds.h"

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
    if (const double wavelength = own_wavelength(channel); wavelength > 0) return wavelength;
  return kLineD;
}

void set_indices(CameraSpec& camera, double wavelength, const PositionMap& positions,
                 const std::string& path) {
  for (std::size_t i = 0; i < camera.lens.surfaces.size(); ++i)
    set_index(camera.lens.surfaces[i].glass, wavelength, camera.lens.surfaces[i].index,
              path + ".lens.surfaces[" + std::to_string(i) + "].glass", positions);
  for (std::size_t i = 0; i < camera.array.types.size(); ++i)
    set_index(camera.array.types[i].glass, wavelength, camera.array.types[i].index,
              path + ".array.types[" + std::to_string(i) + "].glass", positions);
}

void set_indices(std::vector<WindowSpec>& windows, double wavelength,
                 const PositionMap& positions) {
  for (std::size_t i = 0; i < windows.size(); ++i)
    set_index(windows[i].glass, wavelength, windows[i].index,
              "windows[" + std::to_string(i) + "].glass", positions);
}

void set_indices(Scene& scene, const PositionMap& positions) {
  const double wavelength = design_wavelength(scene);
  set_indices(scene.camera, wavelength, positions);
  for (std::size_t i = 0; i < scene.cameras.size(); ++i)
    set_indices(scene.cameras[i], wavelength, positions, "cameras[" + std::to_string(i) + "]");
  set_indices(scene.windows, wavelength, positions);
}

}  // namespace plenoflame
