// Apertures with sides, as a pixel's rays see them. A part of the backward estimator's vector
// kernels, compiled once per instruction set.
#pragma once
#include "math/kernel_math.h"
#include "render/sampling/aim_edges_kernel.inl.h"
#include "render/sampling/backward_kernel.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

/// Margin of the bounds beyond the sides, as a share of their distance, for rounding.
constexpr float kSideRoom = 2e-5F;

/// The interval between a pair of sides on the line along e through a microlens' apertures, or on a
/// line across it.
template <class Real>
PLENOFLAME_INLINE void keep_between(Real half, Real slope, Real offset, Real middle, Real& least_at,
                                    Real& most_at) {
  constexpr Real kParallel = Real(1e-4);  // such a pair bounds the line only far away
  const Real steep = magnitude(slope) < kParallel ? kParallel : slope;
  const Real inverse = Real(1) / steep, at = middle - offset * inverse;
  const Real reach = half * magnitude(inverse);
  least_at = greatest(least_at, at - reach);
  most_at = least(most_at, at + reach);
}

/// The region between all sides of a microlens' two apertures, treated as a regular polygon or a
/// rectangle. Its members are the middle along e and across it, and half the distance of its sides.
template <class Real, int kPairs>
struct SidedAperture {
  Real p, q, half[kPairs];
  Real of_e[kPairs], of_q[kPairs];  ///< the normals along e and across it
  Real half_side(int pair) const {
    return kPairs == 2 ? half[1 - pair] : Real(0.577350269189625765) * half[pair];
  }
  Real area() const {
    Real sum = Real(0);
    for (int k = 0; k < kPairs; ++k) sum += half[k] * half_side(k);
    return Real(2) * sum;
  }
};

template <int kPairs, class Real>
PLENOFLAME_INLINE SidedAperture<Real, kPairs> sided_aperture(const KernelFrame<Real>& c, Real sx,
                                                             Real sy, Real ex, Real ey) {
  const Real far_shift = c.far_shift + c.far_bend * (sx * sx + sy * sy);
  SidedAperture<Real, kPairs> a{};
  Real sum = Real(0);
  for (int k = 0; k < kPairs; ++k) {
    const Real nx = c.side_x[k], ny = c.side_y[k], across = nx * sx + ny * sy;
    const Real near_at = c.near_shift * across, far_at = far_shift * across;
    const Real low = greatest(near_at - c.near_half[k], far_at - c.far_half[k]);
    const Real high = least(near_at + c.near_half[k], far_at + c.far_half[k]);
    a.of_e[k] = nx * ex + ny * ey;
    a.of_q[k] = ny * ex - nx * ey;
    a.half[k] = Real(0.5) * (high - low);
    sum += a.half[k];
    // The normals of kPairs pairs add up to kPairs / 2 times the identity.
    const Real middle = Real(1.0 / kPairs) * (low + high);
    a.p += a.of_e[k] * middle;
    a.q += a.of_q[k] * middle;
  }
  if constexpr (kPairs == 3)
    for (int k = 0; k < kPairs; ++k) a.half[k] = Real(1.0 / kPairs) * sum;
  return a;
}

/// Tells whether the region is open and the cuts remove at most the tips of its corners.
template <int kPairs, class Real>
PLENOFLAME_INLINE bool is_uncut(const SidedAperture<Real, kPairs>& a, Real low, Real high,
                                Real low_far, Real high_far, Real least_half) {
  constexpr Real kShare = Real(0.9);  // share of its reach
  Real along = Real(0), across = Real(0), smallest = a.half[0];
  for (int k = 0; k < kPairs; ++k) {
    // Corners of a hexagon are between two normals: 2 / 3 of the sum is the reach.
    constexpr Real kPart = kPairs == 2 ? Real(1) : Real(2.0 / 3);
    along += kPart * a.half[k] * magnitude(a.of_e[k]);
    across += kPart * a.half[k] * magnitude(a.of_q[k]);
    smallest = least(smallest, a.half[k]);
  }
  const Real cut2 =
      least((a.p - low) * (low_far - a.p), (high - a.p) * (a.p - high_far)) - a.q * a.q;
  return (smallest > least_half) & (a.p - kShare * along > low) & (a.p + kShare * along < high) &
         (cut2 > kShare * kShare * across * across);
}

/// The vector from its middle to its edge, even in the area that it sweeps.
/// @param turn -1/2 to 1/2
template <int kPairs, class Real>
PLENOFLAME_INLINE void way_to_edge(const SidedAperture<Real, kPairs>& a, Real turn, Real& vp,
                                   Real& vq) {
  const Real at = (turn + Real(0.5)) * Real(2 * kPairs);
  const int side = least(static_cast<int>(at), 2 * kPairs - 1);
  const Real beside = Real(2) * (at - static_cast<Real>(side)) - Real(1);
  const int pair = side < kPairs ? side : side - kPairs;
  const Real sign = side < kPairs ? Real(1) : Real(-1);
  Real out = a.half[0], along = a.half_side(0), e = a.of_e[0], q = a.of_q[0];
  for (int k = 1; k < kPairs; ++k) {
    out = pair == k ? a.half[k] : out;
    along = pair == k ? a.half_side(k) : along;
    e = pair == k ? a.of_e[k] : e;
    q = pair == k ? a.of_q[k] : q;
  }
  vp = sign * (e * out - q * beside * along);
  vq = sign * (q * out + e * beside * along);
}

/// A step of Newton's method from a bound beyond a side back to the side. The square of the step
/// stays as a margin, since it exceeds the next step.
/// @param slope derivative of the distance beyond the side
template <class Real>
PLENOFLAME_INLINE Real step_to_side(Real bound, Real beyond, Real slope) {
  const Real by = beyond / greatest(slope, Real(1e-30)) / bound;
  const bool trusted = (slope > Real(0)) & (by > Real(0)) & (by < Real(0.15));
  return trusted ? bound * (Real(1) - by + by * by) : bound;
}

/// Moves bounds in to the points where rays cross a pair of sides on the two faces of the
/// microlens. For the near face, the line is intersected with its sphere. For the far face, the
/// polynomials of its rim give the point.
template <class Real>
[[gnu::noinline]] void find_faces_sides(const KernelFrame<Real>& c, int pair, int first, int padded,
                                        Real per_distance, Real* __restrict reach,
                                        const KernelBlock<Real>& block) {
  const SensorSamples<Real> samples = sensor_samples(block, first);
  const PupilAims<Real> aims = pupil_aims(block, first);
  const Real* __restrict x = samples.x;
  const Real* __restrict y = samples.y;
  const Real* __restrict inner_x = aims.inner_x;
  const Real* __restrict inner_y = aims.inner_y;
  const Real* __restrict way_x = aims.way_x;
  const Real* __restrict way_y = aims.way_y;
  const Real nx = c.side_x[pair], ny = c.side_y[pair], curvature = c.near_curvature;
  const Real room = Real(1) + Real(kSideRoom), half = room * c.face_half[pair];
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real bound = reach[i], vx = way_x[i], vy = way_y[i];
    const Real ux = inner_x[i] + bound * vx, uy = inner_y[i] + bound * vy;
    // The line through u with the slope w meets the sphere at a depth behind its vertex. The depth
    // solves c (1 + w.w) depth^2 - 2 (1 - c u.w) depth + c u.u = 0.
    const Real wx = per_distance * (ux - x[i]), wy = per_distance * (uy - y[i]);
    const Real f = curvature * (ux * ux + uy * uy), g = Real(1) - curvature * (ux * wx + uy * wy);
    const Real squares = g * g - curvature * f * (Real(1) + wx * wx + wy * wy);
    const Real root = square_root(greatest(squares, Real(0.01)));
    const Real depth = f / (g + root), rise = curvature * (ux * vx + uy * vy) / root;
    const Real along = nx * wx + ny * wy, way = nx * vx + ny * vy;
    const Real at = nx * ux + ny * uy + depth * along;
    const Real towards = at < Real(0) ? Real(-1) : Real(1);
    const Real slope = towards * (way + depth * per_distance * way + rise * along);
    reach[i] = step_to_side(bound, towards * at - half, slope);
  }
  if (!c.finds_far) return;
  const Real unit = c.per_unit, far = c.far_reach * room * c.face_half[pair] * c.per_far_radius;
  const KernelCrossing<Real> crossing = c.at_far;
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real sx = unit * x[i], sy = unit * y[i], vx = unit * way_x[i], vy = unit * way_y[i];
    const Real bound = reach[i];
    const Real ux = unit * inner_x[i] + bound * vx, uy = unit * inner_y[i] + bound * vy;
    const EdgePoint<Real> on_face = edge_point(crossing, sx, sy, ux, uy, vx, vy);
    const Real at = nx * on_face.x + ny * on_face.y;
    const Real change = nx * on_face.change_x + ny * on_face.change_y;
    const Real towards = at < Real(0) ? Real(-1) : Real(1);
    reach[i] = step_to_side(bound, towards * at - far, towards * change);
  }
}

/// Moves the bounds in to the sides of the microlens' apertures, if the inner point is between
/// them. Rays beyond a side are blocked.
template <class Real>
[[gnu::noinline]] void find_sides(const KernelFrame<Real>& c, int first, int count, Real distance,
                                  const KernelBlock<Real>& block) {
  const SensorSamples<Real> samples = sensor_samples(block, first);
  const PupilAims<Real> aims = pupil_aims(block, first);
  const Real* __restrict x = samples.x;
  const Real* __restrict y = samples.y;
  const Real* __restrict inner_x = aims.inner_x;
  const Real* __restrict inner_y = aims.inner_y;
  const Real* __restrict way_x = aims.way_x;
  const Real* __restrict way_y = aims.way_y;
  Real* __restrict bounds = aims.bound;
  const int padded = (count + 15) & ~15;
  alignas(64) Real reach[kBlockRays + kBlockSlack];
  for (int i = 0; i < padded; ++i) reach[i] = bounds[i];
  for (int pair = 0; pair < c.side_pairs; ++pair) {
    const Real nx = c.side_x[pair], ny = c.side_y[pair];
    const Real near = c.near_half[pair], far = c.far_half[pair];
    const Real near_shift = c.near_shift, far_shift = c.far_shift, far_bend = c.far_bend;
#pragma omp simd
    for (int i = 0; i < padded; ++i) {
      const Real sx = x[i], sy = y[i];
      const Real across = nx * sx + ny * sy;
      const Real at = nx * inner_x[i] + ny * inner_y[i];
      const Real from_near = at - near_shift * across;
      const Real from_far = at - (far_shift + far_bend * (sx * sx + sy * sy)) * across;
      const Real way = nx * way_x[i] + ny * way_y[i];
      const Real inverse = Real(1) / greatest(magnitude(way), Real(1e-30));
      const Real towards = way < Real(0) ? Real(-1) : Real(1);
      const Real room = least(near - towards * from_near, far - towards * from_far);
      const bool inside = (magnitude(from_near) < near) & (magnitude(from_far) < far);
      // Once a point is outside of a pair of sides, its bound stays unchanged for all pairs.
      const Real nearer = least(reach[i], room * inverse);
      reach[i] = inside & (reach[i] > Real(0)) ? nearer : Real(-1);
    }
  }
  if (c.finds_sides)
    for (int pair = 0; pair < c.side_pairs; ++pair)
      find_faces_sides(c, pair, first, padded, Real(1) / distance, reach, block);
#pragma omp simd
  for (int i = 0; i < padded; ++i) bounds[i] = reach[i] > Real(0) ? reach[i] : bounds[i];
}

}  // namespace
}  // namespace plenoflame::PLENOFLAME_ISA
