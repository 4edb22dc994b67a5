#include "plenoflame/solids/surface_scene.h"

namespace plenoflame {

std::string surface_name(const std::vector<SolidSurfaceSpec>& surfaces, int surface) {
  const std::string& name = surfaces[static_cast<std::size_t>(surface)].name;
  return name.empty() ? "surface " + std::to_string(surface) : "surface \"" + name + "\"";
}

}  // namespace plenoflame
