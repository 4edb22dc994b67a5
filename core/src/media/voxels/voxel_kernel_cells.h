// Geometry and interpolation for the voxel kernels: sixteen lines in cell coordinates, and the two
// fields at the nodes of an interval. Included once per instruction set.
#pragma once

#include "math/kernel_math.h"
#include "media/voxels/voxel_kernel.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

using voxel::kApronSide;
using voxel::kBrickPairs;
using voxel::kLanes;
using voxel::LatticeView;

constexpr double kLargest = 1e20;  // of coordinates and lengths
constexpr int kMaxChannels = 16;   // processed together; more take another pass over the rays

template <class Real>
struct Limits;
template <>
struct Limits<float> {
  static constexpr float huge = 1e30f;   // beyond any t
  static constexpr float level = 1e-6f;  // cells: less than this is no movement along an axis
};
template <>
struct Limits<double> {
  static constexpr double huge = 1e300;
  static constexpr double level = 1e-13;
};

template <class T>
struct Triple {
  alignas(64) T x[kLanes];
  alignas(64) T y[kLanes];
  alignas(64) T z[kLanes];
};

// Lines origin + t * direction. Plane p of an axis is crossed at t = p * inverse + offset; never,
// along an axis without movement.
template <class Real>
struct Lines {
  Triple<Real> origin, direction, inverse, offset;
};

// @param end how far the line is followed: what decides whether it moves at all
template <class Real>
PLENOFLAME_INLINE void set_planes(const Real* __restrict origin, const Real* __restrict direction,
                                  const Real* __restrict end, Real* __restrict inverse,
                                  Real* __restrict offset) {
#pragma omp simd
  for (int l = 0; l < kLanes; ++l) {
    const Real d = direction[l];
    const bool moves = magnitude(d) * end[l] > Limits<Real>::level;
    const Real i = Real(1) / (moves ? d : Real(1));
    inverse[l] = moves ? i : Real(0);
    offset[l] = moves ? -origin[l] * i : Limits<Real>::huge;
  }
}

template <class Real>
PLENOFLAME_INLINE void set_planes(Lines<Real>& line, const Real* end) {
  set_planes(line.origin.x, line.direction.x, end, line.inverse.x, line.offset.x);
  set_planes(line.origin.y, line.direction.y, end, line.inverse.y, line.offset.y);
  set_planes(line.origin.z, line.direction.z, end, line.inverse.z, line.offset.z);
}

// Narrows [from, to] of sixteen lines to a slab.
void clip(double lower, double upper, const double* __restrict origin,
          const double* __restrict direction, double* __restrict from, double* __restrict to) {
#pragma omp simd
  for (int l = 0; l < kLanes; ++l) {
    const double o = origin[l], d = direction[l];
    const bool moves = magnitude(d) > 1e-200;
    const bool inside = (o >= lower) & (o <= upper);
    const double inverse = 1 / (moves ? d : 1.0);
    const double t0 = (lower - o) * inverse, t1 = (upper - o) * inverse;
    const double enter = moves ? least(t0, t1) : inside ? -1e300 : 1e300;
    const double leave = moves ? greatest(t0, t1) : inside ? 1e300 : -1e300;
    from[l] = greatest(from[l], enter);
    to[l] = least(to[l], leave);
  }
}

// Origin, plane offsets and cell in coordinates that count from the lowest cell of a brick.
template <class Real>
void enter(const Real* __restrict line_origin, const Real* __restrict direction,
           const Real* __restrict inverse, const Real* __restrict line_offset,
           const int* __restrict brick, const Real* __restrict t, Real* __restrict origin,
           Real* __restrict offset, int* __restrict cell, int* __restrict up) {
#pragma omp simd
  for (int l = 0; l < kLanes; ++l) {
    const Real low = static_cast<Real>(8 * brick[l]);
    offset[l] = line_offset[l] + low * inverse[l];
    origin[l] = line_origin[l] - low;
    cell[l] = clamp(static_cast<int>(origin[l] + t[l] * direction[l]), 0, 7);
    up[l] = direction[l] > 0 ? -1 : 0;
  }
}

// Origins and directions of sixteen lines along an axis of a lattice.
template <class Real>
void map_to_lattice(const voxel::Call<Real>& call, int first, const voxel::CellMap& map, int axis,
                    double* __restrict origin, double* __restrict direction) {
  const double m0 = map.linear[3 * axis], m1 = map.linear[3 * axis + 1],
               m2 = map.linear[3 * axis + 2], shift = map.origin[axis];
  const Real* __restrict x = call.x + first;
  const Real* __restrict y = call.y + first;
  const Real* __restrict z = call.z + first;
  const Real* __restrict dx = call.dx + first;
  const Real* __restrict dy = call.dy + first;
  const Real* __restrict dz = call.dz + first;
#pragma omp simd
  for (int l = 0; l < kLanes; ++l) {
    origin[l] = shift + m0 * static_cast<double>(x[l]) + m1 * static_cast<double>(y[l]) +
                m2 * static_cast<double>(z[l]);
    direction[l] = m0 * static_cast<double>(dx[l]) + m1 * static_cast<double>(dy[l]) +
                   m2 * static_cast<double>(dz[l]);
  }
}

template <class Real>
PLENOFLAME_INLINE Real plane(int p, Real inverse, Real offset) {
  return static_cast<Real>(p) * inverse + offset;
}

template <class Real>
PLENOFLAME_INLINE int next_brick(int brick, int low, int rest, bool crosses, bool up, Real p) {
  const int inside = clamp(static_cast<int>(p * Real(0.125)), low, low + rest);
  const int stays = rest == 0 ? brick : inside;
  return crosses ? (up ? low + rest + 1 : low - 1) : stays;
}

template <class Real>
PLENOFLAME_INLINE Real within_cell(Real p, int cell) {
  return clamp(p - static_cast<Real>(cell), Real(0), Real(1));
}

// The cell behind a crossed face; elsewhere the cell at p of the block of rest + 1 cells from
// `low`.
template <bool kPlain, class Real>
PLENOFLAME_INLINE int next_cell(int low, int rest, bool crosses, int up, Real p) {
  const int beyond = low - 1 + ((rest + 2) & up);
  const int stays = kPlain ? low : clamp(static_cast<int>(p), low, low + rest);
  return crosses ? beyond : stays;
}

template <class Real>
PLENOFLAME_INLINE int floor_of(Real x) {
  // Far outside of every lattice one cell is like another, and int holds this one.
  const Real held = clamp(x, Real(-1e9), Real(1e9));
  const int whole = static_cast<int>(held);
  return whole - (static_cast<Real>(whole) > held ? 1 : 0);
}

// 2^e for -126 <= e <= 127.
PLENOFLAME_INLINE float power_of_two(int e) {
  return __builtin_bit_cast(float, (127 + e) << 23);
}

// Entry of a brick's table, -1 outside.
PLENOFLAME_INLINE int find_brick(const LatticeView& cells, int x, int y, int z) {
  const bool inside = (x >= 0) & (x < cells.bricks[0]) & (y >= 0) & (y < cells.bricks[1]) &
                      (z >= 0) & (z < cells.bricks[2]);
  if (!inside) return -1;
  const int block = cells.top[((x >> 3) * cells.blocks[1] + (y >> 3)) * cells.blocks[2] + (z >> 3)];
  return block < 0 ? -1 : cells.table[block + ((x & 7) << 6 | (y & 7) << 3 | (z & 7))];
}

// The brick that holds the values of an entry.
PLENOFLAME_INLINE int data_of(const LatticeView& cells, int entry) {
  if (entry < 0) return cells.blank;
  return entry & 1 ? cells.constant_data[entry >> 1] : entry >> 1;
}

// Four numbers: the two fields of a sample and of its neighbour along z.
typedef float Float4 __attribute__((vector_size(16)));
typedef double Double4 __attribute__((vector_size(32)));
typedef float Float4Unaligned __attribute__((vector_size(16), aligned(4), may_alias));
template <class Real>
struct Quad;
template <>
struct Quad<float> {
  using type = Float4;
};
template <>
struct Quad<double> {
  using type = Double4;
};
PLENOFLAME_INLINE void load(const float* p, Float4& out) {
  out = *reinterpret_cast<const Float4Unaligned*>(p);
}
PLENOFLAME_INLINE void load(const float* p, Double4& out) {
  out = Double4{p[0], p[1], p[2], p[3]};
}

// An interval's length and cell: the number of the cell's lowest pair in its brick, or coordinates.
// At the two Gauss nodes: the place within the cell [0, 1]^3 and the fields as pairs (temperature,
// absorption).
template <class Real>
struct Intervals {
  alignas(64) Real length[kLanes];
  alignas(64) int pair[kLanes];
  Triple<int> cell;
  Triple<Real> at[2];
  alignas(64) Real fields[2][2 * kLanes];
};

// The half of each interval that belongs to each node: all near temperatures, behind them the far
// ones, and the halves' optical thickness.
// @returns how many intervals are thicker than `limit`
template <class Real>
PLENOFLAME_INLINE int split_at_nodes(const Intervals<Real>& now, Real limit,
                                     Real (&temperature)[2 * kLanes], Real (&tau)[2][kLanes]) {
  int thick = 0;
#pragma omp simd reduction(+ : thick)
  for (int l = 0; l < kLanes; ++l) {
    const Real half = Real(0.5) * now.length[l];
    temperature[l] = now.fields[0][2 * l];
    temperature[kLanes + l] = now.fields[1][2 * l];
    tau[0][l] = half * greatest(now.fields[0][2 * l + 1], Real(0));
    tau[1][l] = half * greatest(now.fields[1][2 * l + 1], Real(0));
    thick += tau[0][l] + tau[1][l] > limit;
  }
  return thick;
}

// Fields of lane l at its two nodes, in a cell whose lowest corner is at `corner`.
template <class Real>
PLENOFLAME_INLINE void interpolate(const float* corner, const Triple<Real> (&at)[2], int l,
                                   Real (&out)[2][2]) {
  using Q = typename Quad<Real>::type;
  Q v00, v01, v10, v11;
  load(corner, v00);
  load(corner + 2 * kApronSide, v01);
  load(corner + 2 * kApronSide * kApronSide, v10);
  load(corner + 2 * kApronSide * (kApronSide + 1), v11);
  const Q d0 = v10 - v00, d1 = v11 - v01;
  for (int n = 0; n < 2; ++n) {
    const Q b0 = v00 + at[n].x[l] * d0;
    const Q b1 = v01 + at[n].x[l] * d1;
    const Q c = b0 + at[n].y[l] * (b1 - b0);
    const Q up = __builtin_shufflevector(c, c, 2, 3, 2, 3);
    const Q r = c + at[n].z[l] * (up - c);
    out[n][0] = r[0];
    out[n][1] = r[1];
  }
}

}  // namespace
}  // namespace plenoflame::PLENOFLAME_ISA
