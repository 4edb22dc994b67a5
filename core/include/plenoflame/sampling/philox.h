#pragma once
#include <array>
#include <cstdint>

namespace plenoflame {

/// Philox 4x32-10: four random words as a function of a 128-bit counter and a 64-bit key. Nothing
/// is carried from one call to the next, so that the numbers of a sample depend on its index only.
/// Source: Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11 (2011).
constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                              std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53u} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57u} * counter[2];
    counter = {
        static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
        static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

/// The random words of one sample: block `block` of sample `index` of the run with this seed.
constexpr std::array<std::uint32_t, 4> philox(std::uint64_t seed, std::uint64_t index,
                                              std::uint64_t block) {
  return philox({static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32),
                 static_cast<std::uint32_t>(block), static_cast<std::uint32_t>(block >> 32)},
                {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
}

/// Uniform in (0, 1): the middles of 2^32 equal intervals.
constexpr double unit_uniform(std::uint32_t word) {
  return (word + 0.5) * 0x1p-32;
}

/// Uniform in (0, 1) with 52 bits, where 32 are too coarse (choosing among many).
constexpr double unit_uniform(std::uint32_t high, std::uint32_t low) {
  const std::uint64_t bits = (static_cast<std::uint64_t>(high) << 20) | (low >> 12);
  return (static_cast<double>(bits) + 0.5) * 0x1p-52;
}

}  // namespace plenoflame
