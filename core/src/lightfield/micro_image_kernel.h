// Data of the kernels that go through the pixels of a micro-image, and their entry points for
// every instruction set.
#pragma once

namespace plenoflame {

/// One square table of white light. The pixel at (x, y) reads the table at (x0 + xx x + xy y, y0 +
/// yx x + yy y), in the table's steps.
struct KernelWhitePart {
  const float* table;  ///< side x side values
  float weight;
  float x0, xx, xy, y0, yx, yy;
};

/// Pixels of a micro-image, projected to the plane that is refocused on.
struct KernelProjection {
  int count;
  const float *x, *y;      ///< of the pixels from the middle, upright [pixel]
  float scale_x, scale_y;  ///< 1 / radius [1/pixel]
  /// Their places in the picture [pixel]: over the monomials of degree up to 5 of (x, y) / radius,
  /// x^i y^j with i running faster.
  float along[21], across[21];
  float weight;  ///< how much the microlens counts
  const float* flux;
  const float* own;    ///< white light through this microlens
  const float* total;  ///< white light through all microlenses
};

/// Places of samples in the picture, relative to a pixel's middle, and what they bring.
struct KernelSamples {
  int *column, *row;    ///< the pixel to the upper left
  float *right, *down;  ///< from its middle, 0 to 1
  float *light, *white;
};

#define PLENOFLAME_MICRO_IMAGE_KERNELS                                                             \
  /* One microlens' white light in the pixels at x, y; negative sums count as none.             */ \
  void white_light(const KernelWhitePart* parts, int part_count, int side, int count,              \
                   const float* x, const float* y, float* out);                                    \
  /* Places, light and white light of pixels; false when one that counts is not finite.         */ \
  bool project(const KernelProjection&, const KernelSamples&);

namespace baseline {
PLENOFLAME_MICRO_IMAGE_KERNELS
}
namespace avx2 {
PLENOFLAME_MICRO_IMAGE_KERNELS
}
namespace avx512 {
PLENOFLAME_MICRO_IMAGE_KERNELS
}

}  // namespace plenoflame
