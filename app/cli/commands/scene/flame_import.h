#pragma once
#include "commands/command.h"

namespace plenoflame::cli {

/// Adds `import` to the command `flame`. @return what it does once it was chosen
StoppableAction add_flame_import(CLI::App& flame);

}  // namespace plenoflame::cli
