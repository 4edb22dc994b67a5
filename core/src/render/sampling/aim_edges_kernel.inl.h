// Moves the bounds of a pixel's rays to the edges at which rays begin to be blocked. A part of the
// backward estimator's vector kernels, compiled once per instruction set.
#pragma once
#include "math/kernel_math.h"
#include "render/sampling/backward_kernel.h"
#include "render/sampling/ray_stages_kernel.inl.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

/// Largest steps that are trusted. The first step to the stop's edge and the step to the far face's
/// rim are shares of the bound. The second step to the stop's edge is a share of the first one.
constexpr float kStopStep = 0.6F, kFarStep = 0.15F, kSecondStep = 0.5F;

/// The point where a ray from s to u crosses the surface: of_s * s + of_u * u.
template <class Real>
PLENOFLAME_INLINE void cross(const KernelCrossing<Real>& c, Real sx, Real sy, Real ux, Real uy,
                             Real& of_s, Real& of_u) {
  const Real* p = c.of_sensor;
  const Real* q = c.of_aim;
  const Real ss = sx * sx + sy * sy, su = sx * ux + sy * uy, uu = ux * ux + uy * uy;
  of_s = p[0] + ss * (p[1] + ss * p[4]) + su * (p[2] + ss * p[5] + uu * p[8] + su * p[7]) +
         uu * (p[3] + ss * p[6] + uu * p[9]);
  of_u = q[0] + ss * (q[1] + ss * q[4]) + su * (q[2] + ss * q[5] + uu * q[8] + su * q[7]) +
         uu * (q[3] + ss * q[6] + uu * q[9]);
}

/// Derivatives of these factors with u along v.
template <class Real>
PLENOFLAME_INLINE void crossing_changes(const KernelCrossing<Real>& c, Real sx, Real sy, Real ux,
                                        Real uy, Real vx, Real vy, Real& of_s, Real& of_u) {
  const Real* p = c.of_sensor;
  const Real* q = c.of_aim;
  const Real ss = sx * sx + sy * sy, sv = sx * vx + sy * vy;
  const Real su = sx * ux + sy * uy, uu = ux * ux + uy * uy;
  const Real uv = Real(2) * (ux * vx + uy * vy);  // derivative of uu
  of_s = sv * (p[2] + ss * p[5] + uu * p[8] + Real(2) * p[7] * su) +
         uv * (p[3] + ss * p[6] + p[8] * su + Real(2) * p[9] * uu);
  of_u = sv * (q[2] + ss * q[5] + uu * q[8] + Real(2) * q[7] * su) +
         uv * (q[3] + ss * q[6] + q[8] * su + Real(2) * q[9] * uu);
}

/// A point on a surface behind the microlens, and its derivative with the aim point along the way.
template <class Real>
struct EdgePoint {
  Real x, y, change_x, change_y;
};

/// The point where a ray from s to u crosses a surface, and its derivative with u along v.
template <class Real>
PLENOFLAME_INLINE EdgePoint<Real> edge_point(const KernelCrossing<Real>& crossing, Real sx, Real sy,
                                             Real ux, Real uy, Real vx, Real vy) {
  Real of_s, of_u, change_s, change_u;
  cross(crossing, sx, sy, ux, uy, of_s, of_u);
  crossing_changes(crossing, sx, sy, ux, uy, vx, vy, change_s, change_u);
  return {of_s * sx + of_u * ux, of_s * sy + of_u * uy, change_s * sx + change_u * ux + of_u * vx,
          change_s * sy + change_u * uy + of_u * vy};
}

/// A step of Newton's method from a point beyond a circle back to it. The product of height and
/// (height - radius) is a series in the difference of the squares, which needs no root.
/// @param beyond the difference of the squares @param curvature the radius to the power of -2
/// @param slope half of the derivative of the square
template <class Real>
PLENOFLAME_INLINE Real step_to_rim(Real beyond, Real curvature, Real slope) {
  const Real part = beyond * curvature;
  return beyond * (Real(0.5) + part * (Real(0.125) - Real(0.0625) * part)) / slope;
}

/// Moves the bounds in to the rim of the microlens' far face by a step of Newton's method. The
/// square of the step stays as a margin, since it exceeds the next step.
template <class Real>
PLENOFLAME_INLINE void find_far_rim(const KernelFrame<Real>& c, int first, int count,
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
  const Real unit = c.per_unit;
  const Real radius2 = c.far_reach * c.far_reach, curvature = Real(1) / radius2;
  const KernelCrossing<Real> crossing = c.at_far;
  const int padded = (count + 15) & ~15;
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real sx = unit * x[i], sy = unit * y[i], vx = unit * way_x[i], vy = unit * way_y[i];
    const Real bound = bounds[i];
    const Real ux = unit * inner_x[i] + bound * vx, uy = unit * inner_y[i] + bound * vy;
    const EdgePoint<Real> at = edge_point(crossing, sx, sy, ux, uy, vx, vy);
    const Real slope = at.x * at.change_x + at.y * at.change_y;
    const Real by = step_to_rim(at.x * at.x + at.y * at.y - radius2, curvature, slope);
    const bool trusted = (slope > Real(0)) & (by < Real(kFarStep) * bound);
    bounds[i] = bound - (trusted ? greatest(by - by * by, Real(0)) : Real(0));
  }
}

/// The stop as the limit of a microlens' rays from s through u, both in units.
template <class Real>
struct StopEdge {
  KernelCrossing<Real> at_pupil;
  Real field_x, field_y, radius2;
  Real l0, l1, l2, l3, l4, l5;  ///< StopMap::along
  Real m0, m1, m2, m3;          ///< StopMap::across
};

template <class Real>
PLENOFLAME_INLINE StopEdge<Real> stop_edge(const KernelFrame<Real>& c) {
  return {c.at_pupil,  c.field_x,  c.field_y,   c.stop_reach * c.stop_reach,
          c.along[0],  c.along[1], c.along[2],  c.along[3],
          c.along[4],  c.along[5], c.across[0], c.across[1],
          c.across[2], c.across[3]};
}

// Maps the exit pupil, at (a, b) along the field and across it, to the stop.
template <class Real>
PLENOFLAME_INLINE Real along_field(const StopEdge<Real>& e, Real a, Real aa, Real bb) {
  return e.l0 + a * (e.l1 + e.l2 * a + e.l4 * aa + e.l5 * bb) + e.l3 * bb;
}
template <class Real>
PLENOFLAME_INLINE Real across_field(const StopEdge<Real>& e, Real a, Real b, Real aa, Real bb) {
  return b * (e.m0 + e.m1 * a + e.m2 * aa + e.m3 * bb);
}

/// Distance of a ray beyond the stop's edge, as the difference of the squares.
template <class Real>
PLENOFLAME_INLINE Real beyond_stop(const StopEdge<Real>& e, Real sx, Real sy, Real ux, Real uy) {
  Real of_s, of_u;
  cross(e.at_pupil, sx, sy, ux, uy, of_s, of_u);
  const Real at_x = of_s * sx + of_u * ux, at_y = of_s * sy + of_u * uy;
  const Real a = e.field_x * at_x + e.field_y * at_y, b = e.field_x * at_y - e.field_y * at_x;
  const Real aa = a * a, bb = b * b;
  const Real along = along_field(e, a, aa, bb), across = across_field(e, a, b, aa, bb);
  return along * along + across * across - e.radius2;
}

/// Moves the bounds in to the stop's edge by a step of Newton's method and a second step along a
/// parabola. The parabola has the distance from the edge and its slope before the first step, and
/// the distance after it.
template <class Real>
PLENOFLAME_INLINE void find_stop(const KernelFrame<Real>& c, int first, int count,
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
  const Real unit = c.per_unit;
  const StopEdge<Real> edge = stop_edge(c);
  const Real fx = edge.field_x, fy = edge.field_y, curvature = Real(1) / edge.radius2;
  const int padded = (count + 15) & ~15;
  // The point where the ray crosses the exit pupil is at seen_along and seen_across, along the
  // field and across it. The derivatives of that point are first in steps and beyond_line. The
  // second loop writes the Newton step to steps. It writes to beyond_line the squared distance from
  // the edge before the step, less half of the change that its slope predicts.
  alignas(64) Real steps[kBlockRays + kBlockSlack], beyond_line[kBlockRays + kBlockSlack];
  alignas(64) Real seen_along[kBlockRays + kBlockSlack], seen_across[kBlockRays + kBlockSlack];
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real sx = unit * x[i], sy = unit * y[i], vx = unit * way_x[i], vy = unit * way_y[i];
    const Real bound = bounds[i];
    const Real ux = unit * inner_x[i] + bound * vx, uy = unit * inner_y[i] + bound * vy;
    const EdgePoint<Real> at = edge_point(edge.at_pupil, sx, sy, ux, uy, vx, vy);
    seen_along[i] = fx * at.x + fy * at.y;
    seen_across[i] = fx * at.y - fy * at.x;
    steps[i] = fx * at.change_x + fy * at.change_y;
    beyond_line[i] = fx * at.change_y - fy * at.change_x;
  }
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real a = seen_along[i], b = seen_across[i], da = steps[i], db = beyond_line[i];
    const Real bound = bounds[i];
    const Real aa = a * a, bb = b * b;
    const Real along = along_field(edge, a, aa, bb), across = across_field(edge, a, b, aa, bb);
    const Real slope =
        along * (da * (edge.l1 + Real(2) * edge.l2 * a + Real(3) * edge.l4 * aa + edge.l5 * bb) +
                 db * Real(2) * b * (edge.l3 + edge.l5 * a)) +
        across * (db * (edge.m0 + edge.m1 * a + edge.m2 * aa + Real(3) * edge.m3 * bb) +
                  da * b * (edge.m1 + Real(2) * edge.m2 * a));
    const Real beyond = along * along + across * across - edge.radius2;
    const Real by = step_to_rim(beyond, curvature, slope);
    // No step is made if the line does not lead outwards, or if the edge is not ahead. Bounds far
    // outside of the edge are kept, too, because another edge may lie between.
    const bool in_sight = (slope > Real(0)) & (by > Real(0)) & (by < Real(kStopStep) * bound);
    steps[i] = in_sight ? by : Real(0);
    beyond_line[i] = beyond - by * slope;
  }
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real sx = unit * x[i], sy = unit * y[i];
    const Real bound = bounds[i], step = steps[i], to = unit * (bound - step);
    const Real ux = unit * inner_x[i] + to * way_x[i], uy = unit * inner_y[i] + to * way_y[i];
    const Real beyond = beyond_stop(edge, sx, sy, ux, uy);
    const Real part = beyond / (Real(2) * (beyond_line[i] - beyond));
    const Real second = magnitude(part) * step;
    // Estimate of the next step from the curvature of the edge: from the two steps, or from a
    // circle. It includes the error of the parabola's slope.
    const Real left = second * (greatest(second, Real(2) * part * part) + Real(0.5) * step * step);
    // A large second step means that there was no edge.
    const bool trusted = (step > Real(0)) & (magnitude(part) <= Real(kSecondStep));
    bounds[i] = bound - (trusted ? greatest(step + step * part - left, Real(0)) : Real(0));
  }
}

}  // namespace
}  // namespace plenoflame::PLENOFLAME_ISA
