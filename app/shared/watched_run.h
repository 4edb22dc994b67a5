#pragma once
#include <functional>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "settings.h"

namespace plenoflame {

/// Calls `task` on a thread of its own, so that the calling thread stays free to watch it.
/// @param threads workers of the task; 0: one per processor
/// @param watch called on the calling thread with the fraction done, some 20 times a second, also
///        without progress. If it returns true, the task is stopped
/// @param warnings gets those of the task, in their order, also when it throws
/// @throws what the task throws
void watched_run(int threads, const std::function<bool(double fraction)>& watch,
                 std::vector<std::string>& warnings,
                 const std::function<void(const Execution&)>& task);

/// The message of the exception that is being handled. @param names for the settings that mend it
std::string message_of_current_exception(const SettingNames& names);

}  // namespace plenoflame
