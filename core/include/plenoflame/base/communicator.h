#pragma once
#include <optional>
#include <string>

namespace plenoflame {

/// A message between ranks.
struct RankMessage {
  int from = 0;
  std::string bytes;
};

/// The processes that share a run, numbered from 0: what of MPI or the like is needed. All run the
/// same version on the same kind of machine. May be called from several threads.
class Communicator {
 public:
  virtual ~Communicator() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;
  /// Ranks on this machine, this one included.
  virtual int ranks_on_node() const { return size(); }
  /// Hands over a message and does not wait until it has arrived. Messages from one rank to another
  /// arrive in the order in which they were sent.
  virtual void send(int to, std::string bytes) = 0;
  /// A message that has come, from any rank; none when there is no further one. Does not wait.
  virtual std::optional<RankMessage> receive() = 0;
};

}  // namespace plenoflame
