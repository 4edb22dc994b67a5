#include "media/voxels/voxel_steps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "media/voxels/voxel_kernel.h"

namespace plenoflame::voxel {
namespace {

const float* sample(const float* pairs, int i, int j, int k) {
  return pairs + 2 * ((i * kApronSide + j) * kApronSide + k);
}

// The brick's samples.
struct Samples {
  const float* pairs;
  bool one_value, own_temperature;
  const float* extras;
  int extra_fields;
};

// Tells whether the block of side^3 cells whose lowest is (i, j, k) is uniform. Either all samples
// are equal or nothing absorbs; and the extra fields are constant.
bool uniform(const Samples& samples, int i, int j, int k, int side) {
  const float* const pairs = samples.pairs;
  const float* first = sample(pairs, i, j, k);
  const int reach = samples.one_value ? side : side + 1;
  for (int e = 0; e < samples.extra_fields; ++e) {
    const float* const field = samples.extras + e * kBrickPairs;
    const auto value = [&](int x, int y, int z) {
      return field[(x * kApronSide + y) * kApronSide + z];
    };
    for (int x = i; x < i + reach; ++x)
      for (int y = j; y < j + reach; ++y)
        for (int z = k; z < k + reach; ++z)
          if (value(x, y, z) != value(i, j, k)) return false;
  }
  bool equal = !samples.own_temperature, empty = true;
  for (int x = i; x < i + reach; ++x)
    for (int y = j; y < j + reach; ++y)
      for (int z = k; z < k + reach; ++z) {
        const float* at = sample(pairs, x, y, z);
        equal = equal && at[0] == first[0] && at[1] == first[1];
        empty = empty && at[1] == 0;
        if (!equal && !empty) return false;
      }
  return true;
}

}  // namespace

void StepPlanner::plan(const float* pairs, bool one_value_per_cell, bool own_temperature,
                       const float* extras, int extra_fields, int* words) const {
  const Samples samples{pairs, one_value_per_cell, own_temperature, extras, extra_fields};
  int codes[kBrickSide * kBrickSide * kBrickSide];
  std::fill(std::begin(codes), std::end(codes), kCellStep);
  if (!one_value_per_cell && !own_temperature && tolerance_ > 0) subdivide(pairs, codes);
  for (int level = 1; level <= 3; ++level) {
    const int side = 1 << level;
    for (int i = 0; i < kBrickSide; i += side)
      for (int j = 0; j < kBrickSide; j += side)
        for (int k = 0; k < kBrickSide; k += side)
          if (uniform(samples, i, j, k, side))
            for (int x = i; x < i + side; ++x)
              for (int y = j; y < j + side; ++y)
                for (int z = k; z < k + side; ++z)
                  codes[(x * kBrickSide + y) * kBrickSide + z] = kCellStep + level;
  }
  for (int w = 0; w < kStepWords; ++w) {
    unsigned word = 0;
    for (int k = 0; k < kBrickSide; ++k)
      word |= static_cast<unsigned>(codes[w * kBrickSide + k]) << (4 * k);
    words[w] = static_cast<int>(word);
  }
}

// S falls by a factor e^delta across a cell that is cut into m. Two Gauss nodes then miss the share
// (delta/m)^4 / 4320 of the cell's emission (the rule's remainder for an exponential). With delta
// from the slope at the hot end, where S is large, the emission is about kappa S h min(1, 1/delta).
// The error is compared with the largest kappa S of the brick over its 8 spacings.
void StepPlanner::subdivide(const float* pairs, int* codes) const {
  float coldest = sample(pairs, 0, 0, 0)[0], hottest = coldest;
  for (int s = 0; s < kBrickPairs; ++s) {
    coldest = std::min(coldest, pairs[2 * s]);
    hottest = std::max(hottest, pairs[2 * s]);
  }
  if (!(hottest > 0) || coldest == hottest) return;
  // S and its logarithmic slope at 65 temperatures.
  constexpr int kTable = 64;
  const double width = (double(hottest) - coldest) / kTable;
  for (const SourceFunction& channel : *channels_) {
    std::array<double, kTable + 1> source, slope;
    for (int n = 0; n <= kTable; ++n) {
      const double t = coldest + n * width;
      source[n] = channel(t);
      const double above = channel(t * (1 + 1e-4));
      slope[n] = source[n] > 0 ? std::log(above / source[n]) / (1e-4 * t) : 0;
    }
    const auto at = [&](double t) {
      return std::min(kTable, static_cast<int>(std::ceil((t - coldest) / width)));
    };
    double brick = 0;
    for (int s = 0; s < kBrickPairs; ++s)
      brick = std::max(brick, pairs[2 * s + 1] * source[at(pairs[2 * s])]);
    brick *= kBrickSide;
    if (!(brick > 0)) continue;
    for (int i = 0; i < kBrickSide; ++i)
      for (int j = 0; j < kBrickSide; ++j)
        for (int k = 0; k < kBrickSide; ++k) {
          float low = hottest, high = coldest, kappa = 0;
          for (int m = 0; m < 8; ++m) {
            const float* corner = sample(pairs, i + (m >> 2), j + (m >> 1 & 1), k + (m & 1));
            low = std::min(low, corner[0]);
            high = std::max(high, corner[0]);
            kappa = std::max(kappa, corner[1]);
          }
          if (!(high > low) || !(kappa > 0)) continue;
          const int hot = at(high);
          const double delta = slope[hot] * (double(high) - low);
          const double error = kappa * source[hot] * std::min(1.0, 1 / delta) *
                               (delta * delta * delta * delta / 4320) / (brick * tolerance_);
          int halvings = 0;
          while (halvings < 5 && error > std::exp2(4 * halvings)) ++halvings;
          int& code = codes[(i * kBrickSide + j) * kBrickSide + k];
          code = std::min(code, kCellStep - halvings);
        }
  }
}

}  // namespace plenoflame::voxel
