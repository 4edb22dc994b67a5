#include "commands/calibration/calibrate.h"

#include <CLI/CLI.hpp>

#include "commands/commands.h"

namespace plenoflame::cli {

void register_calibrate(const Registry& registry) {
  CLI::App& command =
      add_command(registry, "calibrate", "Find out what a real camera is from its own pictures",
                  "plenoflame calibrate white white.tif --camera nominal.toml -o camera.toml");
  command.require_subcommand(1);
  using Add = void (*)(CLI::App&, const Registry&);
  constexpr Add kSubcommands[] = {add_calibrate_white, add_calibrate_radiometry,
                                  add_calibrate_corners, add_calibrate_geometry, add_calibrate_rig};
  for (const Add add : kSubcommands) add(command, registry);
}

}  // namespace plenoflame::cli
