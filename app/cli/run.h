#pragma once
#include <optional>

#include "interrupt.h"

namespace plenoflame::cli {

/// Exit statuses of the command.
inline constexpr int kSuccess = 0;
inline constexpr int kFailure = 1;  ///< the input or the machine is at fault
inline constexpr int kBadUse = 2;   ///< the command line is at fault

/// The command `plenoflame`: parses, calls the chosen command, turns every exception into one line
/// on standard error.
/// @param interrupt handles signals since before; given up for a command that does not look at it
/// @return the exit status
int run(int argc, const char* const* argv, std::optional<InterruptHandler>& interrupt);

/// The same for a whole process, with a handler of signals where the system has a thread for it.
/// Once a command that looks at signals has returned, they are ignored: the process ends at once.
int run(int argc, const char* const* argv);

}  // namespace plenoflame::cli
