#include "render/estimators/rank_tiles.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <thread>
#include <utility>

#include "plenoflame/render/ranks.h"
#include "render/estimators/rank_bytes.h"
#include "render/estimators/rank_protocol.h"

namespace plenoflame {
namespace {

using namespace std::chrono_literals;

/// The longest time that rank 0 waits before it checks for messages. A tile takes far longer, and
/// the other ranks already have their next tile.
constexpr auto kLongestPause = 1000us;
constexpr auto kShortestPause = 50us;

}  // namespace

/// The jobs of a run, for the threads of rank 0 and for the other ranks.
class RankTiles::Queue {
 public:
  explicit Queue(const std::vector<TileJob>& jobs) : jobs_(jobs) {}
  std::optional<TileJob> next() {
    const std::lock_guard lock(mutex_);
    if (closed_ || next_ == jobs_.size()) return std::nullopt;
    return jobs_[next_++];
  }
  std::size_t left() const {
    const std::lock_guard lock(mutex_);
    return closed_ ? 0 : jobs_.size() - next_;
  }
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  /// @return true when all jobs were handed out
  bool finished() const {
    const std::lock_guard lock(mutex_);
    return next_ == jobs_.size();
  }

 private:
  mutable std::mutex mutex_;
  const std::vector<TileJob>& jobs_;
  std::size_t next_ = 0;
  bool closed_ = false;
};

RankTiles::RankTiles(Communicator& ranks, const RenderSettings& settings, std::stop_token stop)
    : ranks_(ranks), stop_(std::move(stop)), others_(static_cast<std::size_t>(ranks.size())) {
  std::string bytes(1, rank_message::kRender);
  put(bytes, RankSettings{settings.replicates, settings.seed, settings.window, settings.skip,
                          settings.control_variate, settings.precision, settings.isa});
  send_all(bytes);
}

RankTiles::~RankTiles() {
  try {
    send_all(std::string(1, kRenderEnds));
  } catch (...) {  // out of memory: the other ranks are told to quit later
  }
}

void RankTiles::send_all(const std::string& bytes) {
  for (int rank = 1; rank < ranks_.size(); ++rank) ranks_.send(rank, bytes);
}

void RankTiles::begin_pass(const std::vector<PointRange>& ranges) {
  for (Rank& other : others_) other = {};
  ranges_ = ranges;
  std::string bytes(1, kPassBegins);
  put_all(bytes, ranges);
  send_all(bytes);
}

std::size_t RankTiles::tiles_out() const {
  std::size_t count = 0;
  for (const Rank& other : others_) count += other.has;
  return count;
}

int RankTiles::other_threads() const {
  int threads = 0;
  for (const Rank& other : others_) threads += other.threads;
  return threads;
}

/// Gives a tile to each thread of the other ranks, and some more in advance while many are left.
void RankTiles::hand_out(Queue& queue, Film& film) {
  for (int rank = 1; rank < ranks_.size(); ++rank) {
    Rank& other = others_[static_cast<std::size_t>(rank)];
    if (other.threads == 0) continue;
    const auto threads = static_cast<std::size_t>(other.threads);
    for (;;) {
      const auto all = static_cast<std::size_t>(own_threads_ + other_threads());
      const std::size_t ahead = queue.left() > 2 * all ? (threads + 1) / 2 : 0;
      if (other.has >= threads + ahead) break;
      const std::optional<TileJob> job = queue.next();
      if (!job) return;
      std::string bytes(1, kTile);
      put(bytes, *job);
      put_all(bytes, std::as_const(film).tile_sums(job->tile));
      ranks_.send(rank, std::move(bytes));
      ++other.has;
    }
  }
}

/// @return true if the message concerned a tile or a pass
bool RankTiles::take(const RankMessage& message, Film* film, const TileDone* tile_done) {
  Rank& other = others_.at(static_cast<std::size_t>(message.from));
  RankReader reader(std::string_view(message.bytes).substr(1));
  switch (message.bytes.front()) {
    case kPassReady:
      other.threads = reader.get<int>();
      return true;
    case kTileDone: {
      const auto job = reader.get<TileJob>();
      const auto rays = reader.get<double>();
      --other.has;
      if (!film) return true;  // the run ended before this tile
      std::vector<double> sums = reader.get_all<double>();
      if (!sums.empty()) film->tile_sums(job.tile) = std::move(sums);
      film->add_samples(job.tile, ranges_[job.range].points);
      if (*tile_done) (*tile_done)(job, rays);
      return true;
    }
    case kPassEnded:
      other.work = reader.get<WorkCounters>();
      return true;
    case rank_message::kFailed:
      throw Error("rank " + std::to_string(message.from) + ": " + message.bytes.substr(1));
    default:
      return false;
  }
}

void RankTiles::serve(Queue& queue, const Execution& execution, Film& film,
                      const TileDone& tile_done) {
  for (std::chrono::microseconds pause = kShortestPause;;) {
    if (execution.stop.stop_requested()) queue.close();
    bool busy = false;
    while (const std::optional<RankMessage> message = ranks_.receive())
      busy = take(*message, &film, &tile_done) || busy;
    if (stop_.stop_requested()) return;
    hand_out(queue, film);
    if (queue.left() == 0 && tiles_out() == 0) return;
    pause = busy ? kShortestPause : std::min<std::chrono::microseconds>(2 * pause, kLongestPause);
    std::this_thread::sleep_for(pause);
  }
}

bool RankTiles::run(const BackwardPass& pass, const std::vector<TileJob>& jobs,
                    const Execution& execution, Film& film, RenderStatistics& statistics,
                    const TileDone& tile_done) {
  own_threads_ = execution.thread_count();
  Queue queue(jobs);
  std::mutex mutex;
  const TileDone done_alone = [&](const TileJob& job, double rays) {
    const std::lock_guard lock(mutex);
    if (tile_done) tile_done(job, rays);
  };
  std::exception_ptr failure;
  std::jthread service([&] {
    try {
      serve(queue, execution, film, done_alone);
    } catch (...) {
      failure = std::current_exception();
      queue.close();
    }
  });
  try {
    pass.run([&] { return queue.next(); }, execution, film, statistics, done_alone);
  } catch (...) {
    queue.close();
    service.join();
    throw;
  }
  service.join();
  if (failure) std::rethrow_exception(failure);
  return queue.finished() && tiles_out() == 0;
}

void RankTiles::end_pass(RenderStatistics& statistics) {
  send_all(std::string(1, kPassEnds));
  const auto answered = [&] {
    return std::all_of(others_.begin() + 1, others_.end(),
                       [](const Rank& other) { return other.work.has_value(); });
  };
  while (!answered() && !stop_.stop_requested()) {
    if (const std::optional<RankMessage> message = ranks_.receive())
      take(*message, nullptr, nullptr);
    else
      std::this_thread::sleep_for(kLongestPause);
  }
  for (const Rank& other : others_)
    if (other.work) statistics += *other.work;
  statistics.ranks = ranks_.size();
  statistics.threads = std::max(statistics.threads, own_threads_ + other_threads());
}

}  // namespace plenoflame
