// Sums over the pixels of a picture in vectors, and their entry points for every instruction set.
#pragma once

namespace plenoflame {

/// Sums go on side by side: one alone would wait for each of its additions.
inline constexpr int kSumLanes = 8;

/// Over the pixels that are lit.
struct LitSums {
  double squares[kSumLanes], fourth[kSumLanes];  ///< of the standard errors
  double total[kSumLanes];                       ///< of the flux
  double pixels[kSumLanes];                      ///< that are lit
  double may_be[kSumLanes];                      ///< that may be lit
};

#define PLENOFLAME_PICTURE_SUMS_KERNELS                                                            \
  /* Pixels above `limit` are lit, those within two standard errors of it may be. */               \
  void add_lit(const float* flux, const float* standard_error, int count, double limit, LitSums&); \
  /* Adds to kSumLanes sums. */                                                                    \
  void add_pixels(const float* values, int count, double* sums);                                   \
  /* Keeps the largest of kSumLanes. */                                                            \
  void keep_largest(const float* values, int count, float* largest);

namespace baseline {
PLENOFLAME_PICTURE_SUMS_KERNELS
}
namespace avx2 {
PLENOFLAME_PICTURE_SUMS_KERNELS
}
namespace avx512 {
PLENOFLAME_PICTURE_SUMS_KERNELS
}

}  // namespace plenoflame
