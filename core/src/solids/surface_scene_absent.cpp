#include "plenoflame/base/error.h"
#include "plenoflame/solids/surface_mesh.h"
#include "plenoflame/solids/surface_scene.h"

namespace plenoflame {

SurfaceMesh surface_mesh(const SolidSurfaceSpec&, const std::string&, const SurfaceMeshSettings&,
                         const Execution&) {
  throw InputError("the scene has surfaces; this program was built without them");
}

std::unique_ptr<SurfaceScene> make_surface_scene(const std::vector<SolidSurfaceSpec>&,
                                                 const std::string&,
                                                 const std::vector<SourceFunction>&,
                                                 const Execution&,
                                                 const std::function<std::string(int)>&) {
  throw InputError(
      "the scene has surfaces; this program was built without Embree, which traces them");
}

}  // namespace plenoflame
