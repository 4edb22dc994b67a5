#include <algorithm>
#include <chrono>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/render/ranks.h"
#include "render/estimators/backward.h"
#include "render/estimators/rank_bytes.h"
#include "render/estimators/rank_protocol.h"
#include "render/run/check_settings.h"

namespace plenoflame {
namespace {

using namespace std::chrono_literals;
constexpr auto kWait = 500us;  ///< longest interval of checks for messages
constexpr auto kShortestWait = 10us;

RenderSettings settings_from(const RankSettings& sent) {
  RenderSettings settings;
  settings.replicates = sent.replicates;
  settings.seed = sent.seed;
  settings.window = sent.window;
  settings.skip = sent.skip;
  settings.control_variate = sent.control_variate;
  settings.precision = sent.precision;
  settings.isa = sent.isa;
  if (!is_supported(settings.isa))
    throw UsageError("this processor does not support " + std::string(name(settings.isa)) +
                     ", which that of rank 0 does: run all ranks on machines of one kind");
  return settings;
}

/// The tiles of a pass that rank 0 sends, for the threads of this rank.
class Inbox {
 public:
  Inbox(Communicator& ranks, Film& film, const std::stop_token& stop)
      : ranks_(ranks), film_(film), stop_(stop) {}

  /// Waits for a tile; none if the pass has ended.
  std::optional<TileJob> next() {
    for (;; std::this_thread::sleep_for(kWait)) {
      const std::lock_guard lock(mutex_);
      while (end_ == 0) {
        const std::optional<RankMessage> message = ranks_.receive();
        if (!message) break;
        take(*message);
      }
      if (!jobs_.empty() && !is_over()) {
        const TileJob job = jobs_.front();
        jobs_.pop_front();
        return job;
      }
      if (end_ != 0) return std::nullopt;
    }
  }
  /// First byte of the message that ended the pass.
  char end() const { return end_; }

 private:
  bool is_over() const {
    return stop_.stop_requested() || end_ == kRenderEnds || end_ == rank_message::kQuit;
  }
  void take(const RankMessage& message) {
    const char what = message.bytes.front();
    if (what != kTile) {
      end_ = what;
      return;
    }
    RankReader reader(std::string_view(message.bytes).substr(1));
    jobs_.push_back(reader.get<TileJob>());
    if (std::vector<double> sums = reader.get_all<double>(); !sums.empty())
      film_.tile_sums(jobs_.back().tile) = std::move(sums);
  }

  Communicator& ranks_;
  Film& film_;
  const std::stop_token& stop_;
  std::mutex mutex_;
  std::deque<TileJob> jobs_;
  char end_ = 0;
};

/// @return first byte of the message that ended the pass
char serve_pass(const BackwardPass& pass, Film& film, Communicator& ranks,
                const Execution& execution) {
  Inbox inbox(ranks, film, execution.stop);
  std::string ready(1, kPassReady);
  put(ready, execution.thread_count());
  ranks.send(0, std::move(ready));
  RenderStatistics statistics;
  Execution working = execution;
  working.stop = {};  // the inbox ends it, since rank 0 needs the answer
  pass.run([&] { return inbox.next(); }, working, film, statistics,
           [&](const TileJob& job, double rays) {
             std::string bytes(1, kTileDone);
             put(bytes, job);
             put(bytes, rays);
             std::vector<double> sums;
             if (!std::as_const(film).tile_sums(job.tile).empty())
               sums = std::move(film.tile_sums(job.tile));
             film.tile_sums_taken(job.tile);
             put_all(bytes, sums);
             ranks.send(0, std::move(bytes));
           });
  if (inbox.end() != kPassEnds) return inbox.end();
  std::string bytes(1, kPassEnded);
  put(bytes, static_cast<const WorkCounters&>(statistics));
  ranks.send(0, std::move(bytes));
  return inbox.end();
}

}  // namespace

RankMessage wait_for_message(Communicator& ranks, const std::stop_token& stop) {
  for (std::chrono::nanoseconds pause = kShortestWait;;
       pause = std::min<std::chrono::nanoseconds>(pause * 5 / 4, kWait)) {
    if (std::optional<RankMessage> message = ranks.receive()) return std::move(*message);
    if (stop.stop_requested()) throw Cancelled();
    std::this_thread::sleep_for(pause);
  }
}

bool serve_render(const CompiledScene& scene, const RankMessage& begin, Communicator& ranks,
                  const Execution& execution) {
  std::optional<RenderSettings> settings;
  std::optional<BackwardShared> shared;
  bool is_ready = false;
  Film film;
  const auto fail = [&](const std::string& what) {
    ranks.send(0, std::string(1, rank_message::kFailed) + what);
    is_ready = false;
  };
  const auto guarded = [&](const auto& work) {
    try {
      work();
    } catch (const std::bad_alloc&) {
      fail("not enough memory");
    } catch (const std::exception& error) {
      fail(error.what());
    }
  };
  guarded([&] {
    const auto sent = RankReader(std::string_view(begin.bytes).substr(1)).get<RankSettings>();
    settings = settings_from(sent);
    shared.emplace(scene, *settings, execution);
    film = Film(window_of(*settings, scene.scene.camera.sensor),
                static_cast<int>(scene.scene.channels.size()), settings->replicates);
    is_ready = true;
  });
  for (;;) {
    const RankMessage message = wait_for_message(ranks);
    char what = message.bytes.front();
    if (what == kPassBegins && is_ready)
      guarded([&] {
        RankReader reader(std::string_view(message.bytes).substr(1));
        const BackwardPass pass(scene, *settings, reader.get_all<PointRange>(), *shared,
                                execution.threads);
        what = serve_pass(pass, film, ranks, execution);
      });
    if (what == kRenderEnds) return true;
    if (what == rank_message::kQuit) return false;
  }
}

}  // namespace plenoflame
