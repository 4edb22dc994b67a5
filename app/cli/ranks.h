#pragma once
#include <memory>
#include <stop_token>

#include "plenoflame/base/communicator.h"

namespace plenoflame::cli {

/// A communicator with its begin and end.
class JobCommunicator : public Communicator {
 public:
  virtual bool all_sent() = 0;
  /// After this there are no more messages. Waits for the others to come here.
  virtual void finish() = 0;
};

/// The ranks that mpirun started; nullptr where the process is alone. MPI is loaded only then.
/// @throws UsageError where there are others and this build has no MPI
std::unique_ptr<JobCommunicator> join_ranks();

/// Tells if this process is one of several and not the first, before anything is loaded: only the
/// first says what is wrong.
bool is_further_rank();

/// Worker threads of this rank unless the user says how many: the ranks of a node share it.
int default_threads(const JobCommunicator& ranks);

/// The work of a rank above 0: all requests of rank 0, until rank 0 quits.
void serve_ranks(JobCommunicator& ranks, const std::stop_token& stop);

/// Tells the others that there is no more to do, and waits for them a while.
/// @return false when not all answered: one is gone, and MPI cannot be ended in order
bool dismiss_ranks(JobCommunicator& ranks);

}  // namespace plenoflame::cli
