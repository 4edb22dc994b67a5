#include "commands/series/sweep_ranks.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "commands/render/run_queue.h"
#include "commands/series/sweep_run.h"
#include "commands/series/sweep_set.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/ranks.h"
#include "ranks.h"

namespace plenoflame::cli {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

// First bytes of the messages within a sweep; what follows them.
constexpr char kReady = 'r';  ///< to rank 0: how many runs it makes at a time
constexpr char kRun = 'n';    ///< from rank 0: number of a run
constexpr char kDone = 'd';   ///< to rank 0: number of a run
constexpr char kSaid = 's';   ///< to rank 0: a warning
constexpr char kEnds = 'e';   ///< from rank 0: "stop": those in work are given up
constexpr char kEnded = 'x';  ///< to rank 0

constexpr auto kPause = 1ms;

/// Calls visit(name, value) for everything that the command line says of a sweep.
template <class Visitor>
void visit_arguments(SweepArguments& a, Visitor visit) {
  RenderOptions& options = a.render.options;
  visit("scene", options.scene);
  visit("set", options.set);
  visit("cameras", options.cameras);
  visit("truth", options.truth);
  visit("threads", options.threads);
  visit("samples", a.render.samples);
  visit("target_error", a.render.target_error);
  visit("window", a.render.window);
  visit("output", a.output);
  visit("format", a.format);
  visit("lattice", a.lattice);
  visit("region", a.region);
  visit("part", a.part);
}

std::string beginning(const SweepPlan& plan, std::size_t runs_each) {
  Json json;
  SweepArguments arguments = plan.arguments;
  arguments.part = plan.part.is_whole() ? "" : to_string(plan.part);  // rank 0 has it from Slurm
  visit_arguments(arguments,
                  [&](const char* name, auto& value) { json["arguments"][name] = value; });
  for (const SettingRow<SweepRequest>& row : setting_rows<SweepRequest>())
    json["sweep"][std::string(row.name)] = text_of_row(row, arguments.sweep);
  json["plan"] = plan.text;
  json["runs_each"] = runs_each;
  return kSweepBegins + json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// The number of runs that are made side by side; threads that are left over share one.
int workers_of(const Execution& execution, std::size_t runs) {
  const auto threads = static_cast<std::size_t>(execution.thread_count());
  return static_cast<int>(std::clamp<std::size_t>(runs, 1, threads));
}

void make_runs(const SweepPlan& plan, int workers, RunQueue& queue,
               const std::function<void(int)>& done, const Execution& execution) {
  std::vector<SweepWorker> kept(static_cast<std::size_t>(workers));
  std::mutex arrays;
  Execution sharing = execution;
  sharing.threads = workers;
  Execution one = execution;
  one.threads = std::max(1, execution.thread_count() / workers);
  one.progress = nullptr;
  parallel_for(sharing, static_cast<std::size_t>(workers), [&](std::size_t, int worker) {
    try {
      while (!execution.stop.stop_requested()) {
        const std::optional<int> run = queue.next();
        if (!run) return;
        make_run(plan, *run, kept[static_cast<std::size_t>(worker)], arrays, one);
        done(*run);
      }
    } catch (...) {
      queue.close(true);
      throw;
    }
  });
}

/// Rank 0's view of the others.
class OtherRanks {
 public:
  OtherRanks(const SweepPlan& plan, std::size_t runs_each, JobCommunicator& ranks)
      : ranks_(ranks), others_(static_cast<std::size_t>(ranks.size())) {
    send_all(beginning(plan, runs_each));
  }

  /// Hands out runs until there are no more and all that were handed out are done.
  void share(RunQueue& queue, const std::function<void(int)>& done, const Execution& execution) {
    while (!execution.stop.stop_requested() && (queue.left() > 0 || out() > 0)) {
      if (!take(done, execution)) std::this_thread::sleep_for(kPause);
      for (int rank = 1; rank < ranks_.size(); ++rank) hand_out(rank, queue);
    }
  }

  /// @param give_up true: runs in work are not waited for
  void end(bool give_up, const std::function<void(int)>& done, const Execution& execution) {
    send_all(std::string(1, kEnds) + (give_up ? "stop" : ""));
    const auto ended = [](const Rank& other) { return other.ended; };
    while (!std::all_of(others_.begin() + 1, others_.end(), ended))
      if (!take(done, execution)) std::this_thread::sleep_for(kPause);
  }

 private:
  struct Rank {
    std::size_t at_a_time = 0;  ///< 0: it has not answered yet
    std::size_t has = 0;
    bool ended = false;
  };

  void send_all(const std::string& bytes) {
    for (int rank = 1; rank < ranks_.size(); ++rank) ranks_.send(rank, bytes);
  }
  std::size_t out() const {
    std::size_t count = 0;
    for (const Rank& other : others_) count += other.ended ? 0 : other.has;
    return count;
  }
  void hand_out(int rank, RunQueue& queue) {
    Rank& other = others_[static_cast<std::size_t>(rank)];
    while (!other.ended && other.has < other.at_a_time && queue.left() > 0) {
      const std::optional<int> run = queue.next();
      if (!run) return;
      ranks_.send(rank, kRun + std::to_string(*run));
      ++other.has;
    }
  }
  /// @return whether a message had come
  bool take(const std::function<void(int)>& done, const Execution& execution) {
    const std::optional<RankMessage> message = ranks_.receive();
    if (!message) return false;
    Rank& other = others_.at(static_cast<std::size_t>(message->from));
    const std::string text = message->bytes.substr(1);
    switch (message->bytes.front()) {
      case kReady:
        other.at_a_time = std::stoul(text);
        break;
      case kDone:
        --other.has;
        done(std::stoi(text));
        break;
      case kSaid:
        execution.warn(text);
        break;
      case kEnded:
        other.ended = true;
        break;
      case rank_message::kFailed:
        throw Error(text);
      default:
        break;
    }
    return true;
  }

  JobCommunicator& ranks_;
  std::vector<Rank> others_;
};

}  // namespace

void share_runs(const SweepPlan& plan, const std::vector<int>& runs, JobCommunicator* ranks,
                const std::function<void(int run)>& done, const Execution& execution) {
  std::mutex telling;
  std::set<std::string> said;
  Execution telling_once = execution;
  telling_once.message = [&](Severity severity, const std::string& text) {
    const std::lock_guard lock(telling);
    if (execution.message && said.insert(text).second) execution.message(severity, text);
  };
  const auto done_alone = [&](int run) {
    const std::lock_guard lock(telling);
    done(run);
  };
  RunQueue queue(runs);
  if (!ranks || runs.empty()) {
    make_runs(plan, workers_of(execution, runs.size()), queue, done_alone, telling_once);
    return;
  }
  const auto size = static_cast<std::size_t>(ranks->size());
  const std::size_t each = (runs.size() + size - 1) / size;
  OtherRanks others(plan, each, *ranks);
  std::exception_ptr failure;
  std::jthread service([&] {
    try {
      others.share(queue, done_alone, telling_once);
    } catch (...) {
      failure = std::current_exception();
      queue.close(true);
    }
  });
  std::exception_ptr own_failure;
  try {
    make_runs(plan, workers_of(execution, each), queue, done_alone, telling_once);
  } catch (...) {
    own_failure = std::current_exception();
  }
  service.join();
  const bool give_up = failure || own_failure || execution.stop.stop_requested();
  try {
    others.end(give_up, done_alone, telling_once);
  } catch (...) {
    if (!failure) failure = std::current_exception();
  }
  if (own_failure) std::rethrow_exception(own_failure);
  if (failure && !execution.stop.stop_requested()) std::rethrow_exception(failure);
}

void serve_sweep(const RankMessage& begin, Communicator& ranks, int threads,
                 const std::stop_token& stop) {
  std::stop_source giving_up;
  const std::stop_callback pass_on(stop, [&] { giving_up.request_stop(); });
  const Json json = Json::parse(begin.bytes.substr(1));
  SweepArguments arguments;
  visit_arguments(arguments, [&](const char* name, auto& value) {
    json.at("arguments").at(name).get_to(value);
  });
  for (const auto& [name, text] : json.at("sweep").items())
    if (text != "") set_setting(arguments.sweep, {}, name, text.get<std::string>());
  Execution execution;
  execution.threads =
      arguments.render.options.threads > 0 ? arguments.render.options.threads : threads;
  execution.stop = giving_up.get_token();
  execution.message = [&](Severity severity, const std::string& text) {
    if (severity == Severity::warning) ranks.send(0, kSaid + text);
  };
  RunQueue queue;
  std::jthread work([&] {
    try {
      const SweepPlan plan = plan_sweep(arguments, execution.threads_only(), RunsAre::checked);
      if (const std::string other = plan_difference(json.at("plan"), plan.text); !other.empty())
        throw InputError("a rank finds another " + other +
                         " than rank 0; give all ranks the same files under the same names");
      const int workers = workers_of(execution, json.at("runs_each").get<std::size_t>());
      ranks.send(0, kReady + std::to_string(workers));
      make_runs(
          plan, workers, queue, [&](int run) { ranks.send(0, kDone + std::to_string(run)); },
          execution);
    } catch (const Cancelled&) {
      // Rank 0 has said so, or a signal.
    } catch (const std::exception& error) {
      ranks.send(0, rank_message::kFailed + std::string(error.what()));
    }
    if (stop.stop_requested())
      ranks.send(0,
                 rank_message::kFailed +
                     fmt::format("rank {} was stopped; the same command continues", ranks.rank()));
  });
  for (;;) {
    const RankMessage message = wait_for_message(ranks);
    if (message.bytes.front() == kRun) queue.add(std::stoi(message.bytes.substr(1)));
    if (message.bytes.front() != kEnds) continue;
    if (message.bytes.size() > 1) giving_up.request_stop();
    queue.close(message.bytes.size() > 1);
    break;
  }
  work.join();
  ranks.send(0, std::string(1, kEnded));
}

}  // namespace plenoflame::cli
