// Data of the vector kernels that take rays through the camera, and their entry points for every
// instruction set.
#pragma once

#include "optics/kernel_lens_limit.h"
#include "optics/kernel_types.h"
#include "optics/shape_kernel.h"

namespace plenoflame {

/// Rays traced together. What is worked on stays in the second cache; half as many would stay in
/// the first one, but what is done once a block, and half empty vectors at its end, take longer.
inline constexpr int kBlockRays = 1024;
inline constexpr int kBlockSlack = 16;  ///< generation may write this far beyond

/// The map of LensDistortion, as the kernels use it.
template <class Real>
struct KernelDistortion {
  bool present;
  Real pupil_gap;     ///< from the last reference plane to that of the entrance pupil
  Real per_distance;  ///< 1 / distance from there to the plane that stays sharp
  Real k1, k2, k3, p1, p2;
  Real limit2;  ///< square of the largest direction that can be undone
};
inline constexpr int kDistortionSteps = 8;  ///< of Newton's method

/// The optics between the aim plane and the scene.
template <class Real>
struct KernelCamera {
  bool ideal_lens;
  KernelIdealLens<Real> ideal;
  int surface_count;  ///< main lens, in the order of rays from the sensor
  KernelSurface<Real> surfaces[kMaxLensSurfaces];
  KernelShape<Real> shapes[kMaxLensSurfaces];
  bool refracts[kMaxLensSurfaces];       ///< false: a plane without index step
  int surface_number[kMaxLensSurfaces];  ///< counted from the scene, for status codes
  bool fresnel;                          ///< weights fall by what surfaces reflect
  KernelCoating<Real> coatings[kMaxLensSurfaces];
  int stop;              ///< which of the surfaces, in their order here
  Real per_stop_radius;  ///< [1/m] of the stop, or of what stands for it in an ideal lens
  bool moved;            ///< whether the main lens is decentred or tilted
  Real lens_turn[9];     ///< moved: camera to lens axes, row major
  Real lens_shift[3];    ///< moved: of the origin, applied after the turn
  KernelDistortion<Real> distortion;
  Real exit_gap;            ///< from the last reference plane to the anchor's plane
  Real rotation[9];         ///< camera to world, row major
  Real anchor_x, anchor_y;  ///< of the anchor, camera frame
};

/// One microlens type, or none (kind 0: rays start freely at the aim plane).
template <class Real>
struct KernelMicrolens {
  int kind;                         ///< 0 none, 1 real, 2 ideal
  KernelSurface<Real> surfaces[2];  ///< back, front
  KernelIdealLens<Real> ideal;
  KernelPolygon<Real> aperture;  ///< of both faces, beside the circles around it
  int surface_number[2];
  Real distance;  ///< sensor to aim plane
  bool fresnel;   ///< its faces reflect
  KernelCoating<Real> coatings[2];
  Real cover_index;  ///< of the sensor's cover glass; 0: none
  bool tilted;       ///< with the array: the rest holds then
  Real turn[9];      ///< camera to array axes, row major
  Real front;        ///< from the aim plane to the front vertices, along the array's axis
  Real depth;        ///< z of the lens' place in its aim plane, from the front of the array
};

/// A block of rays, structure of arrays; 64-byte aligned, kBlockRays + kBlockSlack long.
template <class Real>
struct KernelBlock {
  Real *x, *y, *z, *dx, *dy, *dz, *weight;
  Real* scratch[2];  ///< for the making of rays
  int* code;
  /// Places where rays cross the stop, in its radii, in the frame of the main lens; nullptr where
  /// nobody asks.
  Real *stop_x = nullptr, *stop_y = nullptr;
};

#define PLENOFLAME_CAMERA_KERNELS                                                                  \
  /* Through the microlens centred at (lens_x, lens_y): rays [first, first + count) of the         \
   * block,*/                                                                                      \
  /* relative to that centre before and to the optical axis afterwards; up to 15 rays behind the   \
   */                                                                                              \
  /* last are overwritten. Kind 0: nothing happens. */                                             \
  void pass_microlens(const KernelMicrolens<float>&, float lens_x, float lens_y, int first,        \
                      int count, const KernelBlock<float>&);                                       \
  void pass_microlens(const KernelMicrolens<double>&, double lens_x, double lens_y, int first,     \
                      int count, const KernelBlock<double>&);                                      \
  /* Main lens, then to the plane of the anchor and into world axes; `count` multiple of 16.    */ \
  void trace_lens(const KernelCamera<float>&, int count, const KernelBlock<float>&);               \
  void trace_lens(const KernelCamera<double>&, int count, const KernelBlock<double>&);             \
  /* Rays that have not ended, and have a weight. */                                               \
  int count_alive(const int* code, const float* weight, int count);                                \
  int count_alive(const int* code, const double* weight, int count);

namespace baseline {
PLENOFLAME_CAMERA_KERNELS
}
namespace avx2 {
PLENOFLAME_CAMERA_KERNELS
}
namespace avx512 {
PLENOFLAME_CAMERA_KERNELS
}

}  // namespace plenoflame
