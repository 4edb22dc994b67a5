#pragma once
#include "commands/command.h"

namespace plenoflame::cli {

// One function per command, in commands/NAME.cpp.

/// Registers every command, in the order in which --help lists them.
void register_commands(const Registry& registry);

}  // namespace plenoflame::cli
