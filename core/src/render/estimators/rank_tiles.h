#pragma once
#include <cstddef>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "plenoflame/base/communicator.h"
#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"
#include "render/estimators/backward.h"

namespace plenoflame {

/// Shares the tiles of a rendering among ranks. This is the part of rank 0, which keeps the film
/// and makes all decisions. A tile goes to a free rank with its sums and comes back with more. The
/// film does not depend on the distribution of the work. While this object exists, the other ranks
/// serve this rendering.
class RankTiles {
 public:
  /// @param stop ends the run at once: tiles of other ranks are left to a later run
  RankTiles(Communicator& ranks, const RenderSettings& settings, std::stop_token stop);
  ~RankTiles();
  RankTiles(const RankTiles&) = delete;
  RankTiles& operator=(const RankTiles&) = delete;

  /// Starts the same pass on the other ranks. @param ranges of the pass's points, also in run()
  void begin_pass(const std::vector<PointRange>& ranges);
  /// Traces the jobs of the pass with the other ranks' help. @throws Error when one of them fails
  bool run(const BackwardPass& pass, const std::vector<TileJob>& jobs, const Execution& execution,
           Film& film, RenderStatistics& statistics, const TileDone& tile_done);
  /// Adds the counts of the other ranks, and their number.
  void end_pass(RenderStatistics& statistics);

 private:
  struct Rank {
    int threads = 0;                   ///< 0: its pass is not ready
    std::size_t has = 0;               ///< number of its tiles in work
    std::optional<WorkCounters> work;  ///< of the pass that ended
  };
  class Queue;
  void serve(Queue& queue, const Execution& execution, Film& film, const TileDone& tile_done);
  void hand_out(Queue& queue, Film& film);
  bool take(const RankMessage& message, Film* film, const TileDone* tile_done);
  void send_all(const std::string& bytes);
  std::size_t tiles_out() const;
  int other_threads() const;

  Communicator& ranks_;
  std::stop_token stop_;
  std::vector<Rank> others_;        ///< by rank; the entry of rank 0 is unused
  std::vector<PointRange> ranges_;  ///< of the pass
  int own_threads_ = 1;
};

}  // namespace plenoflame
