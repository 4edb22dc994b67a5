// The stages of drawing rays, as columns of a block. A block holds one stage after the other. Each
// stage overwrites columns that are no longer needed, so that fewer columns stay in the first-level
// cache.
#pragma once
#include "math/kernel_math.h"
#include "render/sampling/backward_kernel.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

/// Points on the sensor, and the two numbers that later select a point of the pupil. `x`, `y` and
/// `area` stay valid through all stages.
template <class Real>
struct SensorSamples {
  Real *x, *y;         ///< [m] from the microlens' centre
  Real* area;          ///< [m^2] area of the pixel that the point represents
  Real* pupil_radius;  ///< share of the pupil's area within the point, 0 to 1
  Real* pupil_turn;    ///< direction of that point, -1/2 to 1/2 of a turn
};

/// Bounds of the unvignetted part of the aperture, as the sensor point sees it (PupilCut) [m].
template <class Real>
struct PupilExtents {
  Real *low, *high, *low_far, *high_far;
};

/// Half lines in the aim plane, from a point inside the unvignetted pupil. A ray passes at inner +
/// sqrt(share) * bound * way.
template <class Real>
struct PupilAims {
  Real *inner_x, *inner_y;  ///< [m] from the microlens' centre
  Real *way_x, *way_y;      ///< [m] direction; any length
  Real* bound;              ///< distance to the pupil's edge, in multiples of `way`
  Real* root_share;         ///< share of the bound at which the ray passes, 0 to 1
  /// [m^4] pi times the area of the ellipse of the ways, times the area of the pixel.
  Real* area;
};

template <class Real>
PLENOFLAME_INLINE SensorSamples<Real> sensor_samples(const KernelBlock<Real>& block, int first) {
  return {block.x + first, block.y + first, block.z + first, block.dx + first, block.dy + first};
}

template <class Real>
PLENOFLAME_INLINE PupilExtents<Real> pupil_extents(const KernelBlock<Real>& block, int first) {
  return {block.dz + first, block.weight + first, block.scratch[0] + first,
          block.scratch[1] + first};
}

template <class Real>
PLENOFLAME_INLINE PupilAims<Real> pupil_aims(const KernelBlock<Real>& block, int first) {
  return {block.dx + first,     block.dy + first,         block.dz + first,
          block.weight + first, block.scratch[0] + first, block.scratch[1] + first,
          block.z + first};
}

}  // namespace
}  // namespace plenoflame::PLENOFLAME_ISA
