// Data of the backward estimator's vector kernels, and their entry points for every instruction set.
#pragma once
#include <cstdint>

#include "optics/kernel_types.h"

namespace plenoflame {

inline constexpr int kMaxLensSurfaces = 64;
inline constexpr int kBlockRays = 512;   ///< rays traced together: a block stays in the first cache
inline constexpr int kBlockSlack = 16;   ///< generation may write this far beyond

/// The optics between the aim plane and the scene.
template <class Real>
struct KernelCamera {
  bool ideal_lens;
  KernelIdealLens<Real> ideal;
  int surface_count;                        ///< main lens, in the order of rays from the sensor
  KernelSurface<Real> surfaces[kMaxLensSurfaces];
  bool refracts[kMaxLensSurfaces];          ///< false: a plane without index step
  int surface_number[kMaxLensSurfaces];     ///< counted from the scene, for status codes
  Real exit_gap;                            ///< from the last reference plane to the anchor's plane
  Real rotation[9];                         ///< camera to world, row major
  Real anchor_x, anchor_y;                  ///< of the anchor, camera frame
};

/// One microlens type, or none (kind 0: rays start freely at the aim plane).
template <class Real>
struct KernelMicrolens {
  int kind;                          ///< 0 none, 1 real, 2 ideal
  KernelSurface<Real> surfaces[2];   ///< back, front
  KernelIdealLens<Real> ideal;
  int surface_number[2];
  Real distance;                     ///< sensor to aim plane
};

/// A microlens and the discs that bound what passes it (camera/pupil_sampling.h): everything
/// relative to its centre (without array: to the optical axis).
template <class Real>
struct KernelPatch {
  Real outer_x, outer_y, outer_radius2;  ///< the micro-image's outer disc
  Real lens_x, lens_y;          ///< centre of the microlens
  Real field_x, field_y;        ///< unit vector away from the optical axis
  Real centre, centre2, coma;
  Real coupling[3], radius[3];
  Real radius_odd;              ///< divided by the aperture radius
  Real flattening[2];
  Real coupling_sign;
  Real cut_margin;              ///< factor on circles of curvature
  Real aim_radius, inverse_aim2;
  Real bound_radius;            ///< nothing passes beyond it around the microlens' axis
  Real aim_x, aim_y, aim_shift; ///< centre of the aperture disc: (aim_x, aim_y) + aim_shift * s
};

/// A pixel that the microlens of a patch may light, and its random numbers.
template <class Real>
struct KernelPixel {
  Real x_low, x_width;          ///< columns inside the outer disc
  Real y0, y1;                  ///< rows
  const std::uint32_t* fractions[4];
  std::uint32_t shift[4];       ///< digital shift of each dimension
  int first, count;             ///< rays of the block
  bool open;                    ///< the stop cuts nothing of the aperture anywhere in the pixel
};

/// A block of rays, structure of arrays; 64-byte aligned, kBlockRays + kBlockSlack long.
template <class Real>
struct KernelBlock {
  Real *x, *y, *z, *dx, *dy, *dz, *weight;
  int* code;
};

#define PLENOFLAME_BACKWARD_KERNELS                                                              \
  /* Fills the rays of all pixels, which follow one another in the block, and takes them through */ \
  /* the microlens; up to 16 rays behind the last are overwritten.                               */ \
  void generate(const KernelPatch<float>&, const KernelPixel<float>*, int pixels,                \
                const KernelMicrolens<float>&, const KernelBlock<float>&);                       \
  void generate(const KernelPatch<double>&, const KernelPixel<double>*, int pixels,              \
                const KernelMicrolens<double>&, const KernelBlock<double>&);                     \
  /* Main lens, then to the plane of the anchor and into world axes; `count` multiple of 16.   */ \
  void trace_lens(const KernelCamera<float>&, int count, const KernelBlock<float>&);             \
  void trace_lens(const KernelCamera<double>&, int count, const KernelBlock<double>&);           \
  /* Sum of weight * radiance, in double.                                                      */ \
  double accumulate(const float* weight, const float* radiance, int count);                      \
  double accumulate(const double* weight, const double* radiance, int count);                    \
  int count_alive(const int* code, int count);

namespace baseline {
PLENOFLAME_BACKWARD_KERNELS
}
namespace avx2 {
PLENOFLAME_BACKWARD_KERNELS
}
namespace avx512 {
PLENOFLAME_BACKWARD_KERNELS
}

}  // namespace plenoflame
