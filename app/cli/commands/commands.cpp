#include "commands/commands.h"

namespace plenoflame::cli {

void register_commands(const Registry& registry) {
  register_render(registry);
  register_merge(registry);
  register_submit(registry);
  register_sweep(registry);
  register_rays(registry);
  register_corners(registry);
  register_bench(registry);
  register_design(registry);
  register_optimize(registry);
  register_develop(registry);
  register_pyrometry(registry);
  register_operator(registry);
  register_truth(registry);
  register_views(registry);
  register_refocus(registry);
  register_export(registry);
#if defined(PLENOFLAME_HAS_VOLUMES)
  register_reconstruct(registry);
  register_flame(registry);
#else
  add_missing(registry.app, "flame", "OpenVDB", "Write a flame to a .vdb file");
#endif
#if defined(PLENOFLAME_HAS_VTK)
  register_picture(registry);
#else
  add_missing(registry.app, "picture", "VTK", "Draw a scene in 3-D: flame, camera, rays");
#endif
  register_import(registry);
  register_calibrate(registry);
  register_compare(registry);
  register_camera(registry);
  register_info(registry);
}

}  // namespace plenoflame::cli
