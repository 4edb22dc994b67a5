#pragma once
#include <mutex>
#include <optional>

#include "commands/series/sweep_plan.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame::cli {

/// State that one worker keeps from run to run: the next scene takes over what it shares with the
/// last.
struct SweepWorker {
  std::optional<CompiledScene> last;
};

/// Makes a run: picture of each camera, truth, and NNNNNN.json, all at once in the set's runs/.
/// @param arrays held while HDF5 is used, which serves one thread at a time
/// @throws InputError with the place of the run; FileError; Cancelled
void make_run(const SweepPlan& plan, int run, SweepWorker& worker, std::mutex& arrays,
              const Execution& execution);

}  // namespace plenoflame::cli
