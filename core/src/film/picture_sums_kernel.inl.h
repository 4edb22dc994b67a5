// Sums over the pixels of a picture; compiled once per instruction set.
#include "film/picture_sums_kernel.h"

#include "math/kernel_math.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

/// Calls `take` with a lane and the number of a pixel, for all pixels.
template <class Take>
PLENOFLAME_INLINE void for_lanes(int count, const Take& take) {
  int first = 0;
  for (; first + kSumLanes <= count; first += kSumLanes)
#pragma omp simd simdlen(8)
    for (int lane = 0; lane < kSumLanes; ++lane) take(lane, first + lane);
  for (int lane = 0; first + lane < count; ++lane) take(lane, first + lane);
}

}  // namespace

void add_lit(const float* flux, const float* standard_error, int count, double limit,
             LitSums& sums) {
  LitSums s = sums;
  for_lanes(
      count, [&](int lane, int i) __attribute__((always_inline)) {
        const double f = static_cast<double>(flux[i]), e = static_cast<double>(standard_error[i]);
        const double e2 = f > limit ? e * e : 0.0;  // no product: what is not lit may be no number
        s.squares[lane] += e2;
        s.fourth[lane] += e2 * e2;
        s.total[lane] += f > limit ? f : 0.0;
        s.pixels[lane] += f > limit ? 1.0 : 0.0;
        s.may_be[lane] += f + 2 * e > limit ? 1.0 : 0.0;
      });
  sums = s;
}

void add_pixels(const float* values, int count, double* sums) {
  double s[kSumLanes];
  for (int lane = 0; lane < kSumLanes; ++lane) s[lane] = sums[lane];
  for_lanes(
      count, [&](int lane, int i)
                 __attribute__((always_inline)) { s[lane] += static_cast<double>(values[i]); });
  for (int lane = 0; lane < kSumLanes; ++lane) sums[lane] = s[lane];
}

void keep_largest(const float* values, int count, float* largest) {
  float s[kSumLanes];
  for (int lane = 0; lane < kSumLanes; ++lane) s[lane] = largest[lane];
  for_lanes(
      count, [&](int lane, int i)
                 __attribute__((always_inline)) { s[lane] = greatest(values[i], s[lane]); });
  for (int lane = 0; lane < kSumLanes; ++lane) largest[lane] = s[lane];
}

}  // namespace plenoflame::PLENOFLAME_ISA
