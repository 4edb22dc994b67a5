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

/// Shares the tiles of a rendering among ranks: the part of rank 0, which keeps the film and
/// decides everything. A tile goes to whoever is free, with the sums that it has so far, and comes
/// back with more: the film does not depend on who worked on what. While it exists the other ranks
/// serve this rendering.
class RankTiles {
 public:
  /// @param stop ends the run at once: tiles that others have are left to a later one
  RankTiles(Communicator& ranks, const RenderSettings& settings, std::stop_token stop);
  ~RankTiles();
  RankTiles(const RankTiles&) = delete;
  RankTiles& operator=(const RankTiles&) = delete;

  /// The other ranks make the same pass.
  void begin_pass(const std::vector<PointRange>& ranges);
  /// Does the work with the other ranks' help. @throws Error when one of them fails
  bool run(const TileWork& work, const std::vector<PointRange>& ranges,
           const std::vector<TileJob>& jobs, const Execution& execution, Film& film,
           RenderStatistics& statistics, const TileDone& tile_done);
  /// Adds what the other ranks counted, and how many they are.
  void end_pass(RenderStatistics& statistics);

 private:
  struct Rank {
    int threads = 0;                   ///< 0: its pass is not ready
    std::size_t has = 0;               ///< tiles
    std::optional<WorkCounters> work;  ///< of the pass that ended
  };
  class Queue;
  void serve(Queue& queue, const std::vector<PointRange>& ranges, const Execution& execution,
             Film& film, const TileDone& tile_done);
  void hand_out(Queue& queue, Film& film);
  bool take(const RankMessage& message, const std::vector<PointRange>* ranges, Film* film,
            const TileDone* tile_done);
  void send_all(const std::string& bytes);
  std::size_t tiles_out() const;
  int other_threads() const;

  Communicator& ranks_;
  std::stop_token stop_;
  std::vector<Rank> others_;  ///< by rank; that of rank 0 is not used
  std::vector<TileJob> out_;  ///< what the others have
  int own_threads_ = 1;
};

}  // namespace plenoflame
