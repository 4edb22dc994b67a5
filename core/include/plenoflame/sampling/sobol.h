#pragma once
#include <cstdint>
#include <vector>

namespace plenoflame {

inline constexpr int kSobolDimensions = 8;

/// Point `index` of the Sobol sequence in `dimension` (< kSobolDimensions) as a 32-bit fraction.
/// Direction numbers: Joe and Kuo, SIAM J. Sci. Comput. 30 (2008), 2635, set D(6).
std::uint32_t sobol(std::uint32_t index, int dimension);

/// Nested uniform (Owen) scrambling of a 32-bit fraction (Owen, MCQMC 1994 (1995), 299). The flip
/// of a bit depends on the seed and on all higher bits, below the 18th bit only on the highest 18.
/// Points that agree in the highest 18 bits therefore keep their distance.
/// @param seed well mixed: seeds that differ in their low 19 bits only share some of the flips
std::uint32_t owen_scramble(std::uint32_t fraction, std::uint64_t seed);

/// 64 well mixed bits from a 64-bit key (splitmix64; Steele, Lea, Flood 2014).
constexpr std::uint64_t mix64(std::uint64_t key) {
  key += 0x9e3779b97f4a7c15u;
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9u;
  key = (key ^ (key >> 27)) * 0x94d049bb133111ebu;
  return key ^ (key >> 31);
}

/// A pool of independently Owen-scrambled stretches of the Sobol sequence in four dimensions (its
/// first, or later ones that fit). A pixel takes one entry at random and shifts it digitally (XOR)
/// by its own random bits. An Owen-scrambled net stays one under the shift, so each pixel's points
/// are Owen-scrambled as well. The cost is one load and one XOR a number. Each replicate needs its
/// own shift. With a common shift the errors of an entry's replicates would be correlated, and so
/// would the errors of all pixels that take this entry.
class SobolPool {
 public:
  static constexpr int kDimensions = 4;
  /// @param replicates independent ones per entry
  /// @param points of each
  /// @param first index of the first point in the sequence (to continue an earlier run)
  /// @param first_dimension of the sequence, at most kSobolDimensions - kDimensions
  /// @param entries 0: the number that fits into a second-level cache, at least 16. A pixel's entry
  ///        depends on this number: a pool that continues another one needs the same
  SobolPool(int replicates, int points, std::uint32_t first, std::uint64_t seed,
            int first_dimension = 0, int entries = 0);

  int entries() const { return entries_; }
  int replicates() const { return replicates_; }
  int points() const { return points_; }
  /// replicates * points fractions of one dimension, one replicate after the other, followed by at
  /// least 16 readable words (not zeros: those of the next dimension).
  const std::uint32_t* fractions(int entry, int dimension) const {
    return data_.data()->words +
           static_cast<std::size_t>(entry * kDimensions + dimension) * stride_;
  }
  /// A number of the replicate of each point of an entry, followed by an equal number of words. It
  /// is 0 for the first replicate and odd for the others. A replicate's shift is first ^ second *
  /// number.
  const std::uint32_t* replicate_numbers() const { return replicate_numbers_.data(); }
  static std::uint32_t replicate_number(int replicate) {
    return replicate == 0
               ? 0
               : static_cast<std::uint32_t>(mix64(static_cast<std::uint64_t>(replicate))) | 1u;
  }

 private:
  void fill(int entry, std::uint32_t first, std::uint64_t seed, int first_dimension);
  int entries_, replicates_, points_;
  /// An entry of 2^n points begins with a line of a cache, or shares one.
  struct alignas(64) CacheLine {
    std::uint32_t words[16];
  };
  std::size_t stride_;
  std::vector<CacheLine> data_;
  std::vector<std::uint32_t> replicate_numbers_;
};

}  // namespace plenoflame
