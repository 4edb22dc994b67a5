#pragma once
#include <cstdint>
#include <vector>

#include "plenoflame/render/work_counters.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// A deposit of one chunk of bundles on the film.
struct ForwardDeposit {
  int column, row, replicate;
};
struct ForwardChunk {
  std::vector<ForwardDeposit> deposits;
  std::vector<double> flux;      ///< one value per channel for every deposit
  WorkCounters work;             ///< its rays are bundles; arrivals are those on the sensor
  std::size_t most_waiting = 0;  ///< largest number of arrivals kept at a time
  bool done = false;
};

/// Appends the scene's channels, summed over the nodes that represent each of them.
/// @param pupil_part part of the stop that the light passed
inline void append_channels(const CompiledScene& scene, const double* nodes, int pupil_part,
                            std::vector<double>& flux) {
  const std::size_t first = flux.size();
  const ChannelMix& mix =
      scene.part_mixes.empty() ? scene.mix : scene.part_mixes[static_cast<std::size_t>(pupil_part)];
  if (mix.empty()) {
    flux.insert(flux.end(), nodes, nodes + scene.node_count());
    return;
  }
  flux.resize(first + scene.scene.channels.size());
  for (int c = 0; c < mix.channels(); ++c)
    for (int n = 0; n < mix.nodes(); ++n)
      flux[first + static_cast<std::size_t>(c)] += mix.weight(c, n) * nodes[n];
}

/// Traces numbered energy bundles; immutable.
class BundleSource {
 public:
  virtual ~BundleSource() = default;
  /// Traces bundles first to end - 1; bundle i belongs to replicate i modulo their number. If the
  /// run is stopped, the chunk stays incomplete.
  virtual void trace(std::int64_t first, std::int64_t end, ForwardChunk& chunk) const = 0;
};

}  // namespace plenoflame
