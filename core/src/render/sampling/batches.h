#pragma once
#include <algorithm>
#include <cstddef>

#include "plenoflame/render/render.h"

namespace plenoflame {

/// The number of tiles between two moments at which the state can be saved.
class Batches {
 public:
  Batches(const RenderSettings& settings, std::size_t jobs, int threads)
      : threads_(static_cast<std::size_t>(threads)), most_(jobs), size_(jobs) {
    if (!settings.checkpoint) return;
    // Threads wait for each other at the end of each batch, so a batch has to be long.
    most_ = std::max(kLeast * threads_, jobs / kBatches);
    size_ = most_;
    wanted_ = kShare * settings.checkpoint_seconds;
    // The time per tile is still unknown.
    if (wanted_ > 0) size_ = std::min(most_, kFirst * threads_);
  }
  std::size_t size() const { return size_; }
  /// @param seconds that `tiles` took
  void learn(std::size_t tiles, double seconds) {
    if (!(wanted_ > 0)) return;
    const double fitting = static_cast<double>(tiles) * wanted_ / std::max(seconds, 1e-9);
    size_ = std::clamp(static_cast<std::size_t>(std::min(fitting, static_cast<double>(most_))),
                       std::min(threads_, most_), most_);
  }

 private:
  static constexpr std::size_t kBatches = 16;  ///< of a pass, unless kLeast is more
  static constexpr std::size_t kLeast = 8;     ///< tiles of a thread, if time allows
  static constexpr std::size_t kFirst = 2;     ///< the same before the time per tile is known
  static constexpr double kShare = 0.5;        ///< share of the time between two checkpoints

  std::size_t threads_, most_, size_;
  double wanted_ = 0;  ///< [s] length of a batch; 0: as long as possible
};

}  // namespace plenoflame
