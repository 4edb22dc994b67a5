#include "plenoflame/sampling/sobol.h"

#include <algorithm>
#include <array>
#include <bit>

namespace plenoflame {
namespace {

/// Degree, coefficients of the primitive polynomial and initial numbers of a dimension.
struct Primitive {
  int degree;
  unsigned coefficients;
  std::array<std::uint32_t, 5> initial;
};

constexpr std::array<Primitive, kSobolDimensions - 1> kPrimitives{{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
}};

using Directions = std::array<std::array<std::uint32_t, 32>, kSobolDimensions>;

constexpr Directions make_directions() {
  Directions v{};
  for (int bit = 0; bit < 32; ++bit) v[0][static_cast<std::size_t>(bit)] = 1u << (31 - bit);
  for (std::size_t d = 1; d < kSobolDimensions; ++d) {
    const Primitive& p = kPrimitives[d - 1];
    const int s = p.degree;
    for (int i = 0; i < 32; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (i < s) {
        v[d][k] = p.initial[k] << (31 - i);
        continue;
      }
      const std::uint32_t back = v[d][static_cast<std::size_t>(i - s)];
      std::uint32_t value = back ^ (back >> s);
      for (int j = 1; j < s; ++j)
        if ((p.coefficients >> (s - 1 - j)) & 1u) value ^= v[d][static_cast<std::size_t>(i - j)];
      v[d][k] = value;
    }
  }
  return v;
}

constexpr Directions kDirections = make_directions();

/// From one point to the next the index changes in its lowest bits, up to the one that becomes 1.
/// The entry of this bit is the resulting change of the fraction.
constexpr Directions make_steps() {
  Directions steps = kDirections;
  for (auto& dimension : steps)
    for (std::size_t bit = 1; bit < dimension.size(); ++bit) dimension[bit] ^= dimension[bit - 1];
  return steps;
}

constexpr Directions kSteps = make_steps();
constexpr int kPoolWords = 1 << 16;  // 256 kB: stays in a second-level cache
// Scrambles differ in quality. With few of them in a picture, its error varies from seed to seed by
// more than its standard error. The number holds as long as a pool takes at most 16 MB:
constexpr int kLeastEntries = 128, kMostWords = 1 << 22;

int automatic_entries(int replicates, int points) {
  const std::int64_t words =
      std::int64_t{SobolPool::kDimensions} * std::int64_t{replicates} * std::int64_t{points};
  const auto least = std::clamp<std::int64_t>(kMostWords / words, 16, kLeastEntries);
  return static_cast<int>(std::clamp<std::int64_t>(kPoolWords / words, least, 4096));
}

}  // namespace

std::uint32_t sobol(std::uint32_t index, int dimension) {
  const auto& v = kDirections[static_cast<std::size_t>(dimension)];
  std::uint32_t fraction = 0;
  for (std::size_t bit = 0; index != 0; ++bit, index >>= 1)
    if (index & 1u) fraction ^= v[bit];
  return fraction;
}

namespace {

/// Bits that one hash decides the flips of: 1 + 2 + 4 + ... + 32 nodes of the tree.
constexpr int kLevels = 6;
/// Below this number of bits, flips differ between prefixes only, not between nodes. Nested flips
/// matter only down to the bits in which points differ: this suffices for 2^18 points.
constexpr int kNested = 3 * kLevels;

/// The hash for the nodes below a prefix of `above` bits, led by a one so that prefixes of
/// different lengths differ.
std::uint64_t tree_hash(std::uint64_t seed, std::uint32_t fraction, int above) {
  return mix64(seed ^ ((std::uint64_t{1} << above) | (std::uint64_t{fraction} >> (32 - above))));
}

/// Flips of six levels, as the bits on top. @param tree a heap whose root is bit 1
std::uint32_t six_flips(std::uint64_t tree, std::uint32_t fraction) {
  std::uint32_t flips = 0;
  for (int level = 0; level < kLevels; ++level) {
    const std::uint64_t node =
        (std::uint64_t{1} << level) | (std::uint64_t{fraction} >> (32 - level));
    flips |= static_cast<std::uint32_t>(tree >> node & 1) << (31 - level);
  }
  return flips;
}

std::uint32_t scramble_below(std::uint64_t root, std::uint32_t fraction, std::uint64_t seed) {
  std::uint32_t flips = six_flips(root, fraction);
  for (int above = kLevels; above < kNested; above += kLevels)
    flips |= six_flips(tree_hash(seed, fraction, above), fraction << above) >> above;
  flips |= static_cast<std::uint32_t>(tree_hash(seed, fraction, kNested) >> (32 + kNested));
  return fraction ^ flips;
}

}  // namespace

std::uint32_t owen_scramble(std::uint32_t fraction, std::uint64_t seed) {
  return scramble_below(tree_hash(seed, fraction, 0), fraction, seed);
}

SobolPool::SobolPool(int replicates, int points, std::uint32_t first, std::uint64_t seed,
                     int first_dimension, int entries)
    : entries_(entries > 0 ? entries : automatic_entries(replicates, points)),
      replicates_(replicates),
      points_(points),
      stride_(static_cast<std::size_t>(replicates) * static_cast<std::size_t>(points)) {
  data_.resize((static_cast<std::size_t>(entries_) * kDimensions * stride_ + 15) / 16 + 1);
  for (int entry = 0; entry < entries_; ++entry) fill(entry, first, seed, first_dimension);
  replicate_numbers_.resize(stride_ + 16);
  for (int r = 0; r < replicates_; ++r)
    std::fill_n(replicate_numbers_.begin() + std::ptrdiff_t{r} * points_, points_,
                replicate_number(r));
}

void SobolPool::fill(int entry, std::uint32_t first, std::uint64_t seed, int first_dimension) {
  for (int d = 0; d < kDimensions; ++d) {
    const auto& steps = kSteps[static_cast<std::size_t>(first_dimension + d)];
    std::uint32_t* out =
        data_.data()->words + static_cast<std::size_t>(entry * kDimensions + d) * stride_;
    for (int r = 0; r < replicates_; ++r) {
      const std::uint64_t key = mix64(
          seed + mix64(static_cast<std::uint64_t>((entry * replicates_ + r) * kDimensions + d)));
      const std::uint64_t root = tree_hash(key, 0, 0);
      std::uint32_t fraction = sobol(first, first_dimension + d);
      for (std::uint32_t i = 1; i <= static_cast<std::uint32_t>(points_); ++i) {
        *out++ = scramble_below(root, fraction, key);
        fraction ^= steps[static_cast<std::size_t>(std::min(std::countr_zero(first + i), 31))];
      }
    }
  }
}

}  // namespace plenoflame
