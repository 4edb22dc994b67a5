#pragma once
#include "commands/command.h"

namespace plenoflame::cli {

// One function per command, in commands/NAME.cpp.
void register_render(const Registry& registry);
void register_rays(const Registry& registry);
void register_corners(const Registry& registry);
void register_bench(const Registry& registry);
void register_design(const Registry& registry);
void register_develop(const Registry& registry);
void register_pyrometry(const Registry& registry);
void register_flame(const Registry& registry);
void register_reconstruct(const Registry& registry);  ///< only with PLENOFLAME_HAS_VOLUMES
void register_picture(const Registry& registry);      ///< only with PLENOFLAME_HAS_VTK
void register_operator(const Registry& registry);
void register_optimize(const Registry& registry);
void register_truth(const Registry& registry);
void register_merge(const Registry& registry);
void register_submit(const Registry& registry);
void register_sweep(const Registry& registry);
void register_views(const Registry& registry);
void register_refocus(const Registry& registry);
void register_export(const Registry& registry);
void register_compare(const Registry& registry);
void register_camera(const Registry& registry);
void register_calibrate(const Registry& registry);
void register_info(const Registry& registry);
void register_import(const Registry& registry);

/// Registers every command, in the order in which --help lists them.
void register_commands(const Registry& registry);

}  // namespace plenoflame::cli
