#pragma once
#include "commands/command.h"

namespace plenoflame::cli {

// Subcommands of `calibrate`, each in commands/calibrate_NAME.cpp; calibrate.cpp lists them.
void add_calibrate_white(CLI::App& calibrate, const Registry& registry);
void add_calibrate_radiometry(CLI::App& calibrate, const Registry& registry);
void add_calibrate_corners(CLI::App& calibrate, const Registry& registry);
void add_calibrate_rig(CLI::App& calibrate, const Registry& registry);
void add_calibrate_geometry(CLI::App& calibrate, const Registry& registry);

}  // namespace plenoflame::cli
