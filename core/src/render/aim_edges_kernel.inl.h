// Where the rays that a pixel aims begin to be stopped: part of the backward estimator's vector
// kernels, compiled once per instruction set.
#pragma once
#include "math/kernel_math.h"
#include "render/backward_kernel.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

/// Steps are believed up to so much of the way: of the first to the stop's edge, to the far face's
/// rim; of the second to the stop's edge, as a part of the first.
constexpr float kStopStep = 0.6F, kFarStep = 0.15F, kSecondStep = 0.5F;

/// Where none are, the whole way is looked at in so many parts, and the edge is enclosed in so many
/// steps; so many rays at a time (two vectors, each of which waits for itself).
constexpr int kProbes = 8, kRefinements = 4, kGroup = 32;
constexpr int kMarks = 16;  ///< that are looked at together

/// Where a ray from s to u crosses: at of_s * s + of_u * u.
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

/// How those factors change with u along v.
template <class Real>
PLENOFLAME_INLINE void crossing_changes(const KernelCrossing<Real>& c, Real sx, Real sy, Real ux,
                                        Real uy, Real vx, Real vy, Real& of_s, Real& of_u) {
  const Real* p = c.of_sensor;
  const Real* q = c.of_aim;
  const Real ss = sx * sx + sy * sy, sv = sx * vx + sy * vy;
  const Real su = sx * ux + sy * uy, uu = ux * ux + uy * uy;
  const Real uv = Real(2) * (ux * vx + uy * vy);  // the change of uu
  of_s = sv * (p[2] + ss * p[5] + uu * p[8] + Real(2) * p[7] * su) +
         uv * (p[3] + ss * p[6] + p[8] * su + Real(2) * p[9] * uu);
  of_u = sv * (q[2] + ss * q[5] + uu * q[8] + Real(2) * q[7] * su) +
         uv * (q[3] + ss * q[6] + q[8] * su + Real(2) * q[9] * uu);
}

/// A step of Newton's method back to a circle from a place beyond it. The height less the radius,
/// times the height, as their series in the difference of the squares: no root.
/// @param beyond the difference @param curvature the radius to the power of -2
/// @param slope half of how the square changes
template <class Real>
PLENOFLAME_INLINE Real step_to_rim(Real beyond, Real curvature, Real slope) {
  const Real part = beyond * curvature;
  return beyond * (Real(0.5) + part * (Real(0.125) - Real(0.0625) * part)) / slope;
}

/// Draws the bounds in to the rim of the microlens' far face, by a step of Newton's method. The
/// square of the step, which is more than the next one would be, is left.
template <class Real>
PLENOFLAME_INLINE void find_far_rim(const KernelPatch<Real>& c, int first, int count,
                                    const KernelBlock<Real>& block) {
  const Real* __restrict x = block.x + first;
  const Real* __restrict y = block.y + first;
  const Real* __restrict dx = block.dx + first;
  const Real* __restrict dy = block.dy + first;
  const Real* __restrict dz = block.dz + first;
  const Real* __restrict weight = block.weight + first;
  Real* __restrict reach = block.scratch[0] + first;
  const Real unit = c.per_unit;
  const Real radius2 = c.far_reach * c.far_reach, curvature = Real(1) / radius2;
  const KernelCrossing<Real> crossing = c.at_far;
  const int padded = (count + 15) & ~15;
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real sx = unit * x[i], sy = unit * y[i], vx = unit * dz[i], vy = unit * weight[i];
    const Real bound = reach[i];
    const Real ux = unit * dx[i] + bound * vx, uy = unit * dy[i] + bound * vy;
    Real of_s, of_u, change_s, change_u;
    cross(crossing, sx, sy, ux, uy, of_s, of_u);
    crossing_changes(crossing, sx, sy, ux, uy, vx, vy, change_s, change_u);
    const Real at_x = of_s * sx + of_u * ux, at_y = of_s * sy + of_u * uy;
    const Real slope = at_x * (change_s * sx + change_u * ux + of_u * vx) +
                       at_y * (change_s * sy + change_u * uy + of_u * vy);
    const Real by = step_to_rim(at_x * at_x + at_y * at_y - radius2, curvature, slope);
    const bool trusted = (slope > Real(0)) & (by < Real(kFarStep) * bound);
    reach[i] = bound - (trusted ? greatest(by - by * by, Real(0)) : Real(0));
  }
}

/// The stop, as what a microlens' rays from s through u, both in units, have to pass.
template <class Real>
struct StopEdge {
  KernelCrossing<Real> at_pupil;
  Real field_x, field_y, radius2;
  Real l0, l1, l2, l3, l4, l5;  ///< StopMap::along
  Real m0, m1, m2, m3;          ///< StopMap::across
};

template <class Real>
PLENOFLAME_INLINE StopEdge<Real> stop_edge(const KernelPatch<Real>& c) {
  return {c.at_pupil,  c.field_x,  c.field_y,   c.stop_reach * c.stop_reach,
          c.along[0],  c.along[1], c.along[2],  c.along[3],
          c.along[4],  c.along[5], c.across[0], c.across[1],
          c.across[2], c.across[3]};
}

// From the exit pupil, at (a, b) along the field and across it, to the stop.
template <class Real>
PLENOFLAME_INLINE Real along_field(const StopEdge<Real>& e, Real a, Real aa, Real bb) {
  return e.l0 + a * (e.l1 + e.l2 * a + e.l4 * aa + e.l5 * bb) + e.l3 * bb;
}
template <class Real>
PLENOFLAME_INLINE Real across_field(const StopEdge<Real>& e, Real a, Real b, Real aa, Real bb) {
  return b * (e.m0 + e.m1 * a + e.m2 * aa + e.m3 * bb);
}

/// How far beyond the stop's edge a ray gets there: the difference of the squares.
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

/// Fills up to a whole group with the last of the numbers.
PLENOFLAME_INLINE int whole_groups(int* rays, int count) {
  for (int k = count; k % kGroup != 0; ++k) rays[k] = rays[count - 1];
  return count;
}

/// The numbers of those of `count` rays, a multiple of kMarks, that are marked with 1. Few are:
/// most groups have none.
PLENOFLAME_INLINE int list_marked(const int* marks, int count, int* rays) {
  int marked = 0;
  for (int begin = 0; begin < count; begin += kMarks) {
    int some = 0;
#pragma omp simd reduction(| : some)
    for (int i = begin; i < begin + kMarks; ++i) some |= marks[i];
    if (some == 0) continue;
    for (int i = begin; i < begin + kMarks; ++i) {
      rays[marked] = i;
      marked += marks[i];
    }
  }
  return whole_groups(rays, marked);
}

/// Of these rays those whose inner points the stop lets pass: of others no edge is looked for.
template <class Real>
PLENOFLAME_INLINE int keep_open(const StopEdge<Real>& edge, Real unit, int first, int* rays,
                                int count, const KernelBlock<Real>& block) {
  int kept = 0;
  for (int begin = 0; begin < count; begin += kGroup) {
    alignas(64) Real sx[kGroup], sy[kGroup], ux[kGroup], uy[kGroup];
    alignas(64) int open[kGroup], number[kGroup];
    for (int k = 0; k < kGroup; ++k) {
      number[k] = rays[begin + k];
      const int i = first + number[k];
      sx[k] = unit * block.x[i];
      sy[k] = unit * block.y[i];
      ux[k] = unit * block.dx[i];
      uy[k] = unit * block.dy[i];
    }
#pragma omp simd
    for (int k = 0; k < kGroup; ++k)
      open[k] = beyond_stop(edge, sx[k], sy[k], ux[k], uy[k]) <= Real(0) ? 1 : 0;
    for (int k = 0; k < least(kGroup, count - begin); ++k) {
      rays[kept] = number[k];
      kept += open[k];
    }
  }
  return whole_groups(rays, kept);
}

/// Draws bounds in to the stop's edge where no step towards it is to be believed: looks along the
/// whole direction, for the outermost place where it leads out of the stop, and encloses that. A
/// bound stays where none is found, or where the stop may open again outside of it.
/// @param rays their numbers, from list_marked(): overwritten
template <class Real>
PLENOFLAME_INLINE void search_stop(const StopEdge<Real>& edge, Real unit, int first, int* rays,
                                   int count, const KernelBlock<Real>& block) {
  count = keep_open(edge, unit, first, rays, count, block);
  for (int begin = 0; begin < count; begin += kGroup) {
    const int* __restrict at = rays + begin;
    alignas(64) Real sx[kGroup], sy[kGroup], ux[kGroup], uy[kGroup], vx[kGroup], vy[kGroup];
    alignas(64) Real bound[kGroup], beyond[kProbes + 1][kGroup];
    for (int k = 0; k < kGroup; ++k) {
      const int i = first + at[k];
      sx[k] = unit * block.x[i];
      sy[k] = unit * block.y[i];
      ux[k] = unit * block.dx[i];
      uy[k] = unit * block.dy[i];
      bound[k] = block.scratch[0][i];
      vx[k] = unit * bound[k] * block.dz[i];
      vy[k] = unit * bound[k] * block.weight[i];
    }
    for (int probe = 0; probe <= kProbes; ++probe) {
      const Real way = Real(probe) / Real(kProbes);
#pragma omp simd
      for (int k = 0; k < kGroup; ++k)
        beyond[probe][k] =
            beyond_stop(edge, sx[k], sy[k], ux[k] + way * vx[k], uy[k] + way * vy[k]);
    }
    // The bracket, in parts of the bound: the ray passes at `in` and is stopped at `out`.
    alignas(64) Real in[kGroup], out[kGroup], at_in[kGroup], at_out[kGroup], opens_again[kGroup];
#pragma omp simd
    for (int k = 0; k < kGroup; ++k) {
      in[k] = Real(-1);
      at_in[k] = at_out[k] = opens_again[k] = Real(0);
    }
    for (int probe = 0; probe < kProbes; ++probe) {
      const Real way = Real(probe) / Real(kProbes), next_way = Real(probe + 1) / Real(kProbes);
      const Real* before_it = beyond[probe > 0 ? probe - 1 : 0];
#pragma omp simd
      for (int k = 0; k < kGroup; ++k) {
        const Real before = before_it[k], here = beyond[probe][k], next = beyond[probe + 1][k];
        const bool leads_out = here <= Real(0);
        in[k] = leads_out ? way : in[k];
        at_in[k] = leads_out ? here : at_in[k];
        at_out[k] = leads_out ? next : at_out[k];
        // The lowest place of the parabola through three of them, and as much again for safety.
        const Real rise = next - before, bend = before - here + (next - here);
        const bool dips = (here > Real(0)) & (before > here) & (next > here) &
                          (Real(4) * here * bend < rise * rise);
        opens_again[k] = dips ? next_way : opens_again[k];
      }
    }
#pragma omp simd
    for (int k = 0; k < kGroup; ++k) {
      const bool found = (in[k] >= Real(0)) & (at_out[k] > Real(0)) & (opens_again[k] <= in[k]) &
                         (beyond[kProbes][k] > beyond[kProbes - 1][k]);
      // Where it was not, a bracket that stays where it is: at the bound.
      out[k] = found ? in[k] + Real(1) / Real(kProbes) : Real(1);
      in[k] = found ? in[k] : Real(1);
      at_in[k] = found ? at_in[k] : Real(-1);
      at_out[k] = found ? at_out[k] : Real(1);
    }
    // False position, where an end that stays counts for half (Dowell and Jarratt, BIT 11 (1971)
    // 168).
    for (int step = 0; step < kRefinements; ++step) {
#pragma omp simd
      for (int k = 0; k < kGroup; ++k) {
        const Real x = out[k] - at_out[k] * (out[k] - in[k]) / (at_out[k] - at_in[k]);
        const Real here = beyond_stop(edge, sx[k], sy[k], ux[k] + x * vx[k], uy[k] + x * vy[k]);
        const bool open = here <= Real(0);
        at_out[k] = open ? Real(0.5) * at_out[k] : here;
        at_in[k] = open ? here : Real(0.5) * at_in[k];
        in[k] = open ? x : in[k];
        out[k] = open ? out[k] : x;
      }
    }
#pragma omp simd
    for (int k = 0; k < kGroup; ++k) bound[k] *= out[k];
    for (int k = 0; k < kGroup; ++k) block.scratch[0][first + at[k]] = bound[k];
  }
}

/// The same for the stop, by a step of Newton's method and one along the parabola through what is
/// known: distance from the edge and its slope before the first step, and distance after it.
/// @tparam kSearches whether it is searched for where they are not to be believed
template <bool kSearches, class Real>
PLENOFLAME_INLINE void find_stop(const KernelPatch<Real>& c, int first, int count,
                                 const KernelBlock<Real>& block) {
  const Real* __restrict x = block.x + first;
  const Real* __restrict y = block.y + first;
  const Real* __restrict dx = block.dx + first;
  const Real* __restrict dy = block.dy + first;
  const Real* __restrict dz = block.dz + first;
  const Real* __restrict weight = block.weight + first;
  Real* __restrict reach = block.scratch[0] + first;
  const Real unit = c.per_unit;
  const StopEdge<Real> edge = stop_edge(c);
  const Real fx = edge.field_x, fy = edge.field_y, curvature = Real(1) / edge.radius2;
  const int padded = (count + 15) & ~15;
  // Where the ray crosses the exit pupil, along the field and across it. Of the other two first how
  // that changes; then the first step, and how far beyond the edge the place before it is, in
  // squares, less half of what the slope there says that the step changes.
  alignas(64) Real steps[kBlockRays + kBlockSlack], beyond_line[kBlockRays + kBlockSlack];
  alignas(64) Real seen_along[kBlockRays + kBlockSlack], seen_across[kBlockRays + kBlockSlack];
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real sx = unit * x[i], sy = unit * y[i], vx = unit * dz[i], vy = unit * weight[i];
    const Real bound = reach[i];
    const Real ux = unit * dx[i] + bound * vx, uy = unit * dy[i] + bound * vy;
    Real of_s, of_u, change_s, change_u;
    cross(edge.at_pupil, sx, sy, ux, uy, of_s, of_u);
    crossing_changes(edge.at_pupil, sx, sy, ux, uy, vx, vy, change_s, change_u);
    const Real at_x = of_s * sx + of_u * ux, at_y = of_s * sy + of_u * uy;
    const Real change_x = change_s * sx + change_u * ux + of_u * vx,
               change_y = change_s * sy + change_u * uy + of_u * vy;
    seen_along[i] = fx * at_x + fy * at_y;
    seen_across[i] = fx * at_y - fy * at_x;
    steps[i] = fx * change_x + fy * change_y;
    beyond_line[i] = fx * change_y - fy * change_x;
  }
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real a = seen_along[i], b = seen_across[i], da = steps[i], db = beyond_line[i];
    const Real bound = reach[i];
    const Real aa = a * a, bb = b * b;
    const Real along = along_field(edge, a, aa, bb), across = across_field(edge, a, b, aa, bb);
    const Real slope =
        along * (da * (edge.l1 + Real(2) * edge.l2 * a + Real(3) * edge.l4 * aa + edge.l5 * bb) +
                 db * Real(2) * b * (edge.l3 + edge.l5 * a)) +
        across * (db * (edge.m0 + edge.m1 * a + edge.m2 * aa + Real(3) * edge.m3 * bb) +
                  da * b * (edge.m1 + Real(2) * edge.m2 * a));
    const Real beyond = along * along + across * across - edge.radius2;
    const Real by = step_to_rim(beyond, curvature, slope);
    // Where the line does not lead outwards, or the edge is not ahead, none is in sight; and
    // where the bounds lie well outside of the edge there may be another one between.
    const bool in_sight = (slope > Real(0)) & (by > Real(0)) & (by < Real(kStopStep) * bound);
    steps[i] = in_sight ? by : Real(kSearches && beyond > Real(0) ? -1 : 0);
    beyond_line[i] = beyond - by * slope;
  }
  alignas(64) int unsure[kBlockRays + kBlockSlack];
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real sx = unit * x[i], sy = unit * y[i];
    const Real bound = reach[i], step = steps[i], to = unit * (bound - step);
    const Real ux = unit * dx[i] + to * dz[i], uy = unit * dy[i] + to * weight[i];
    const Real beyond = beyond_stop(edge, sx, sy, ux, uy);
    const Real part = beyond / (Real(2) * (beyond_line[i] - beyond));
    const Real second = magnitude(part) * step;
    // What the next step would be, as the edge bends: by the two that were made, or as a
    // circle; and by as much as the parabola may miss the slope.
    const Real left = second * (greatest(second, Real(2) * part * part) + Real(0.5) * step * step);
    // Where the second step is no small one, there was no edge.
    const bool trusted = (step > Real(0)) & (magnitude(part) <= Real(kSecondStep));
    reach[i] = bound - (trusted ? greatest(step + step * part - left, Real(0)) : Real(0));
    if (kSearches) unsure[i] = (step != Real(0)) & !trusted ? 1 : 0;
  }
  if (!kSearches) return;
  alignas(64) int rays[kBlockRays + kBlockSlack + kGroup];
  const int all = list_marked(unsure, padded, rays);
  search_stop(edge, unit, first, rays, all, block);
}

}  // namespace
}  // namespace plenoflame::PLENOFLAME_ISA
