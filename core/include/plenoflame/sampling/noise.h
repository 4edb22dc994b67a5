#pragma once
#include <cstdint>

namespace plenoflame {

/// Random numbers of one object (for example a pixel of a frame), counted by the Philox generator.
/// The same key and number give the same sequence, in any order of calls.
class NoiseStream {
 public:
  NoiseStream(std::uint64_t key, std::uint64_t number) : key_(key), number_(number) {}
  /// Uniform in (0, 1), with 53 bits.
  double uniform();
  /// Standard normal: Box and Muller, Ann. Math. Stat. 29 (1958) 610.
  double gaussian();
  /// Poisson's law with this mean >= 0: by inversion below 30, above by transformed rejection
  /// (PTRS: Hormann, Insurance: Mathematics and Economics 12 (1993) 39).
  double poisson(double mean);

 private:
  std::uint64_t key_, number_, block_ = 0;
  std::uint32_t words_[4] = {};
  int left_ = 0;
};

}  // namespace plenoflame
