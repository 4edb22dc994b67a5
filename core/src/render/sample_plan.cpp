#include "render/sample_plan.h"

#include <algorithm>
#include <cmath>

namespace plenoflame {
namespace {

constexpr int kMostGrowth = 16;  ///< in one round: what is foreseen may be wrong
constexpr double kLeastGrowth = 1.125;
/// Fewer points in a round weigh unevenly where dim pixels get a part of them only.
constexpr int kLeastStep = 8;

double wanted(const TileNeed& tile, double price) {
  if (!(tile.difficulty > 0)) return tile.samples;
  const double n = std::pow(tile.difficulty / price, 1 / (2 * kErrorSlope + 1));
  return std::max(tile.samples, n);
}

/// The mean square error that is to be expected at a price of a sample.
double expected(const std::vector<TileNeed>& tiles, double price) {
  double squares = 0, lit = 0;
  for (const TileNeed& tile : tiles) {
    lit += tile.lit;
    if (tile.difficulty > 0)
      squares += tile.lit * tile.difficulty * std::pow(wanted(tile, price), -2 * kErrorSlope);
  }
  return lit > 0 ? squares / lit : 0;
}

/// @return at least `samples`, which is a sum of few powers of two again
int grown(double samples, double want, int limit) {
  const double growth = std::min<double>(want / samples, kMostGrowth);
  double n = samples;
  if (growth >= 1.875)
    n = samples * std::exp2(std::round(std::log2(growth)));
  else if (growth >= kLeastGrowth)
    n = samples +
        std::max<double>(kLeastStep, std::floor(samples / 4) * std::round(4 * (growth - 1)));
  return static_cast<int>(std::min<double>(n, limit));
}

}  // namespace

std::vector<int> plan_samples(const std::vector<TileNeed>& tiles, double goal, int limit) {
  // More samples, lower price: bisection of its logarithm.
  double low = -700, high = 700;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (expected(tiles, std::exp(middle)) > goal ? high : low) = middle;
  }
  std::vector<int> samples(tiles.size());
  // At a higher price than this nothing grows.
  double most = 0;
  for (const TileNeed& tile : tiles)
    if (static_cast<int>(tile.samples) < limit)
      most = std::max(most, tile.difficulty * std::pow(tile.samples, -2 * kErrorSlope - 1));
  // What is wanted may be less than the least growth everywhere, or nothing where the goal seems to
  // be met: then a little more is.
  double price = std::min(std::exp(low), most);
  for (int attempt = 0; attempt < 20; ++attempt, price /= 1.3) {
    bool any = false;
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      samples[i] = grown(tiles[i].samples, wanted(tiles[i], price), limit);
      any = any || samples[i] > static_cast<int>(tiles[i].samples);
    }
    if (any) break;
  }
  return samples;
}

}  // namespace plenoflame
