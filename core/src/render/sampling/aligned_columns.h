#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/sampling/backward_kernel.h"

namespace plenoflame {

/// Entries of every array of a block: kernels write a few entries beyond the last ray.
inline constexpr int kPaddedBlock = kBlockRays + 2 * kBlockSlack;

/// Arrays of kPaddedBlock numbers each, 64-byte aligned, initially 0.
template <class Real>
class AlignedColumns {
 public:
  explicit AlignedColumns(std::size_t count) : storage_(count * kPaddedBlock + kAlignment) {
    first_ = storage_.data();
    while (reinterpret_cast<std::uintptr_t>(first_) % 64 != 0) ++first_;
  }
  AlignedColumns(const AlignedColumns&) = delete;
  AlignedColumns& operator=(const AlignedColumns&) = delete;
  Real* operator[](std::size_t column) { return first_ + column * kPaddedBlock; }

 private:
  static constexpr std::size_t kAlignment = 64 / sizeof(Real);
  std::vector<Real> storage_;
  Real* first_ = nullptr;
};

}  // namespace plenoflame
