#include "render/run/sample_plan.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace plenoflame {
namespace {

constexpr int kMostDoublings = 4;  ///< per round, as estimates may be wrong

/// Expected mean square error of a lit pixel.
double expected(const TileNeed& tile, double samples) {
  return tile.difficulty * std::pow(samples, -2 * kErrorSlope);
}

/// A candidate: a tile whose samples may be doubled.
struct Doubling {
  std::size_t tile;
  int doublings;  ///< before this one
  double from, to;
  double gain;  ///< decrease of its mean square error per sample

  bool operator<(const Doubling& other) const {
    return gain != other.gain ? gain < other.gain : tile > other.tile;
  }
};

}  // namespace

std::vector<int> plan_samples(const std::vector<TileNeed>& tiles, double goal, int limit) {
  std::vector<int> samples;
  std::priority_queue<Doubling> doublings;
  const auto offer = [&](std::size_t i, int before) {
    const double from = samples[i], to = std::min(2 * from, static_cast<double>(limit));
    const TileNeed& tile = tiles[i];
    if (before == kMostDoublings || !(to > from) || !(tile.difficulty > 0)) return;
    doublings.push(
        {i, before, from, to, (expected(tile, from) - expected(tile, to)) / (to - from)});
  };
  double squares = 0, lit = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    samples.push_back(static_cast<int>(tiles[i].samples));
    lit += tiles[i].lit;
    if (tiles[i].difficulty > 0) squares += tiles[i].lit * expected(tiles[i], samples[i]);
    offer(i, 0);
  }
  for (bool any = false; !doublings.empty() && (!any || squares > goal * lit); any = true) {
    const Doubling next = doublings.top();
    doublings.pop();
    const TileNeed& tile = tiles[next.tile];
    squares -= tile.lit * (expected(tile, next.from) - expected(tile, next.to));
    samples[next.tile] = static_cast<int>(next.to);
    offer(next.tile, next.doublings + 1);
  }
  return samples;
}

}  // namespace plenoflame
