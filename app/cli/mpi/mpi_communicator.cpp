// The only file that knows MPI: a library that the command loads under mpirun (ranks.cpp), so that
// it starts without MPI, and faster, everywhere else.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <limits>
#include <list>
#include <mutex>
#include <utility>

#include "plenoflame/base/error.h"
#include "ranks.h"

namespace plenoflame::cli {
namespace {

void check(int status, const char* what) {
  if (status != MPI_SUCCESS) throw Error(std::string("MPI: ") + what + " failed");
}

class MpiCommunicator final : public JobCommunicator {
 public:
  MpiCommunicator() {
    int provided = MPI_THREAD_SINGLE;
    check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided), "MPI_Init_thread");
    if (provided < MPI_THREAD_SERIALIZED)
      throw Error("this MPI cannot be called from several threads in turn");
    check(MPI_Comm_rank(MPI_COMM_WORLD, &rank_), "MPI_Comm_rank");
    check(MPI_Comm_size(MPI_COMM_WORLD, &size_), "MPI_Comm_size");
    MPI_Comm node = MPI_COMM_NULL;
    check(MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &node),
          "MPI_Comm_split_type");
    check(MPI_Comm_size(node, &on_node_), "MPI_Comm_size");
    MPI_Comm_free(&node);
  }
  int rank() const override { return rank_; }
  int size() const override { return size_; }
  int ranks_on_node() const override { return on_node_; }

  void send(int to, std::string bytes) override {
    if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      throw Error("a message to another rank is too long");
    const std::lock_guard lock(mutex_);
    sent_.push_back({std::move(bytes), MPI_REQUEST_NULL});
    Sent& last = sent_.back();
    check(MPI_Isend(last.bytes.data(), static_cast<int>(last.bytes.size()), MPI_BYTE, to, 0,
                    MPI_COMM_WORLD, &last.request),
          "MPI_Isend");
  }

  std::optional<RankMessage> receive() override {
    const std::lock_guard lock(mutex_);
    release();
    int found = 0;
    MPI_Message message = MPI_MESSAGE_NULL;
    MPI_Status status;
    check(MPI_Improbe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &found, &message, &status), "MPI_Improbe");
    if (!found) return std::nullopt;
    int count = 0;
    check(MPI_Get_count(&status, MPI_BYTE, &count), "MPI_Get_count");
    RankMessage result{status.MPI_SOURCE, std::string(static_cast<std::size_t>(count), '\0')};
    check(MPI_Mrecv(result.bytes.data(), count, MPI_BYTE, &message, MPI_STATUS_IGNORE),
          "MPI_Mrecv");
    return result;
  }

  bool all_sent() override {
    const std::lock_guard lock(mutex_);
    release();
    return sent_.empty();
  }
  void finish() override {
    const std::lock_guard lock(mutex_);
    MPI_Finalize();
  }

 private:
  struct Sent {
    std::string bytes;
    MPI_Request request;
  };
  /// Frees the memory of what has gone.
  void release() {
    for (auto at = sent_.begin(); at != sent_.end();) {
      int done = 0;
      check(MPI_Test(&at->request, &done, MPI_STATUS_IGNORE), "MPI_Test");
      at = done ? sent_.erase(at) : std::next(at);
    }
  }

  std::mutex mutex_;
  std::list<Sent> sent_;
  int rank_ = 0, size_ = 1, on_node_ = 1;
};

}  // namespace
}  // namespace plenoflame::cli

extern "C" plenoflame::cli::JobCommunicator* plenoflame_make_communicator() {
  return new plenoflame::cli::MpiCommunicator();
}
