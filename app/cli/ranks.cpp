#include "ranks.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <thread>

#include "commands/render/render_ranks.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/render/ranks.h"

namespace plenoflame::cli {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr char kGoodbye = 'B';  ///< to rank 0, in answer to kQuit

int number_of(const char* name) {
  const char* const text = std::getenv(name);
  return text ? std::atoi(text) : 0;
}

/// The variables that the launcher sets say so: mpirun of Open MPI, or Slurm's srun with PMIx.
bool is_one_of_several() {
  return number_of("OMPI_COMM_WORLD_SIZE") > 1 ||
         (std::getenv("PMIX_RANK") && number_of("SLURM_NTASKS") > 1);
}

/// The library beside the command, as those of other parts (vtk_commands.cpp).
JobCommunicator* make_communicator() {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* place : {"plugins", PLENOFLAME_PLUGIN_FOLDER}) {
    const fs::path path = (folder / place / "libplenoflame_mpi.so").lexically_normal();
    if (!fs::exists(path, error)) continue;
    // Open MPI loads parts of its own, which look for it.
    void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL);
    void* const make = library ? dlsym(library, "plenoflame_make_communicator") : nullptr;
    if (!make) {
      const char* const reason = dlerror();
      throw FileError("cannot load MPI: " + std::string(reason ? reason : path.string()));
    }
    return reinterpret_cast<JobCommunicator* (*)()>(make)();
  }
  throw UsageError(
      "mpirun started several processes, and this build has no MPI; get it with the package "
      "plenoflame-mpi, or with tools/setup.sh mpi and cmake --preset release "
      "-DPLENOFLAME_WITH_MPI=ON, or make parts (docs/user/clusters.md)");
}

}  // namespace

std::unique_ptr<JobCommunicator> join_ranks() {
  if (!is_one_of_several()) return nullptr;
  std::unique_ptr<JobCommunicator> ranks(make_communicator());
  return ranks;
}

bool is_further_rank() {
  return is_one_of_several() &&
         (number_of("OMPI_COMM_WORLD_RANK") > 0 || number_of("PMIX_RANK") > 0);
}

int default_threads(const JobCommunicator& ranks) {
  // Bound to some processors it has those; else each rank has its share.
  const auto there = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
  const int share = std::max(1, there / std::max(1, ranks.ranks_on_node()));
  return std::min(Execution().thread_count(), share);
}

void serve_ranks(JobCommunicator& ranks, const std::stop_token& stop) {
  serve_renderings(ranks, default_threads(ranks), stop);
  ranks.send(0, std::string(1, kGoodbye));
  while (!ranks.all_sent()) std::this_thread::sleep_for(1ms);
}

bool dismiss_ranks(JobCommunicator& ranks) {
  for (int rank = 1; rank < ranks.size(); ++rank)
    ranks.send(rank, std::string(1, rank_message::kQuit));
  // A tile that is being traced is finished first.
  const auto end = std::chrono::steady_clock::now() + 10s;
  for (int left = ranks.size() - 1; left > 0;) {
    const std::optional<RankMessage> message = ranks.receive();
    if (message && message->bytes.front() == kGoodbye) --left;
    if (message) continue;
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(1ms);
  }
  return true;
}

}  // namespace plenoflame::cli
