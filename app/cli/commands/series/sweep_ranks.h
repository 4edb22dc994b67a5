#pragma once
#include <functional>
#include <stop_token>
#include <vector>

#include "commands/series/sweep_plan.h"
#include "plenoflame/base/communicator.h"
#include "plenoflame/base/execution.h"

namespace plenoflame::cli {

class JobCommunicator;

/// First byte of the message with which rank 0 begins a sweep.
inline constexpr char kSweepBegins = 'w';

/// Makes runs: each thread takes the next one that nobody has, and so do other ranks. The files of
/// a run are written by whoever makes it and do not depend on who that is.
/// @param done called after each run, one at a time
/// @throws as make_run(), for the first run that cannot be made; Cancelled
void share_runs(const SweepPlan& plan, const std::vector<int>& runs, JobCommunicator* ranks,
                const std::function<void(int run)>& done, const Execution& execution);

/// The part of a rank above 0 in it.
/// @param begin message that begins with kSweepBegins @param threads unless rank 0 says how many
void serve_sweep(const RankMessage& begin, Communicator& ranks, int threads,
                 const std::stop_token& stop);

}  // namespace plenoflame::cli
