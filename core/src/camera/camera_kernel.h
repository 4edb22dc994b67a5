// Data of the vector kernels that trace rays through the camera, and their entry points for every
// instruction set.
#pragma once

#include "optics/kernel_lens_limit.h"
#include "optics/kernel_types.h"
#include "optics/shape_kernel.h"

namespace plenoflame {

/// Number of rays that are traced together. Their data fit into the second-level cache. Half as
/// many rays would fit into the first level, but fixed costs per block and partly filled vectors at
/// its end take longer.
inline constexpr int kBlockRays = 1024;
inline constexpr int kBlockSlack = 16;  ///< entries that the generation may write beyond

/// The map of LensDistortion in the kernels.
template <class Real>
struct KernelDistortion {
  bool present;
  Real pupil_gap;     ///< from the last reference plane to the plane of the entrance pupil
  Real per_distance;  ///< 1 / distance from the entrance pupil to the plane that stays sharp
  Real k1, k2, k3, p1, p2;
  Real limit2;  ///< square of the largest direction with an inverse
};
inline constexpr int kDistortionSteps = 8;  ///< steps of Newton's method

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
  bool fresnel;                          ///< weights decrease by the reflection at surfaces
  KernelCoating<Real> coatings[kMaxLensSurfaces];
  int stop;              ///< index of the stop among the surfaces, in their order here
  Real per_stop_radius;  ///< [1/m] of the stop, or of its substitute in an ideal lens
  bool moved;            ///< true if the main lens is decentred or tilted
  Real lens_turn[9];     ///< moved: camera to lens axes, row major
  Real lens_shift[3];    ///< moved: shift of the origin, applied after the turn
  KernelDistortion<Real> distortion;
  Real exit_gap;            ///< from the last reference plane to the anchor's plane
  Real rotation[9];         ///< camera to world, row major
  Real anchor_x, anchor_y;  ///< position in the camera frame
};

/// One microlens type, or none (kind 0: rays start without a microlens at the aim plane).
template <class Real>
struct KernelMicrolens {
  int kind;                         ///< 0 none, 1 real, 2 ideal
  KernelSurface<Real> surfaces[2];  ///< back, front
  KernelIdealLens<Real> ideal;
  KernelPolygon<Real> aperture;  ///< sides of both faces, inside of the circles around them
  int surface_number[2];
  Real distance;  ///< sensor to aim plane
  bool fresnel;   ///< its faces reflect
  KernelCoating<Real> coatings[2];
  Real cover_index;  ///< of the sensor's cover glass; 0: none
  bool tilted;       ///< tilted with the array: the members below apply
  Real turn[9];      ///< camera to array axes, row major
  Real front;        ///< from the aim plane to the front vertices, along the array's axis
  Real depth;        ///< z of the lens' place in its aim plane, from the front of the array
};

/// A block of rays, structure of arrays; 64-byte aligned, kBlockRays + kBlockSlack long.
template <class Real>
struct KernelBlock {
  Real *x, *y, *z, *dx, *dy, *dz, *weight;
  Real* scratch[2];  ///< buffers for the generation of rays
  int* code;
  /// Points where rays cross the stop, in units of its radius, in the frame of the main lens;
  /// nullptr if they are not needed.
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
