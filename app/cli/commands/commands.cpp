#include "commands/commands.h"

namespace plenoflame::cli {

void register_commands([[maybe_unused]] const Registry& registry) {}

}  // namespace plenoflame::cli
