// Vector kernels of rays through walls of glass; compiled once per instruction set. The formulas
// are those of WindowSet (docs/theory/windows.md).
#include "render/transport/window_wall_kernel.h"

#include "math/kernel_exp.h"
#include "math/kernel_math.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

constexpr int kChunk = 256;  ///< rays traced together: their data stay in the first-level cache

/// Rays between the two faces, in the window's own frame.
template <class Real>
struct Between {
  Real x[kChunk], y[kChunk], z[kChunk];     ///< points of entry
  Real dx[kChunk], dy[kChunk], dz[kChunk];  ///< directions in the glass
  Real cos_in[kChunk], cos_glass[kChunk];   ///< of the angles with the first face's normal
  Real cos_second[kChunk], cos_out[kChunk], length[kChunk];
  int state[kChunk];  ///< 0: continues; 1: misses the wall; 2: odd
};

/// Refraction into the glass. @param nx, ny, nz normal against the ray
template <class Real>
PLENOFLAME_INLINE void enter(Real index, Real dx, Real dy, Real dz, Real nx, Real ny, Real nz,
                             Real cos_in, int i, Between<Real>& b) {
  const Real mu = Real(1) / index;
  const Real cos_glass = square_root(magnitude(Real(1) - mu * mu * (Real(1) - cos_in * cos_in)));
  const Real along = mu * cos_in - cos_glass;
  b.dx[i] = mu * dx + along * nx;
  b.dy[i] = mu * dy + along * ny;
  b.dz[i] = mu * dz + along * nz;
  b.cos_in[i] = cos_in;
  b.cos_glass[i] = cos_glass;
}

template <class Real>
PLENOFLAME_INLINE void meet_flat(const KernelWall<Real>& w, int first, int count,
                                 const KernelWays<Real>& ways, Between<Real>& b) {
  const Real* __restrict wx = ways.x + first;
  const Real* __restrict wy = ways.y + first;
  const Real* __restrict wz = ways.z + first;
  const Real* __restrict vx = ways.dx + first;
  const Real* __restrict vy = ways.dy + first;
  const Real* __restrict vz = ways.dz + first;
  const Real nx = w.normal[0][0], ny = w.normal[0][1], nz = w.normal[0][2];
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const Real x = w.turn[0] * wx[i] + w.turn[1] * wy[i] + w.turn[2] * wz[i] + w.at[0];
    const Real y = w.turn[3] * wx[i] + w.turn[4] * wy[i] + w.turn[5] * wz[i] + w.at[1];
    const Real z = w.turn[6] * wx[i] + w.turn[7] * wy[i] + w.turn[8] * wz[i] + w.at[2];
    const Real dx = w.turn[0] * vx[i] + w.turn[1] * vy[i] + w.turn[2] * vz[i];
    const Real dy = w.turn[3] * vx[i] + w.turn[4] * vy[i] + w.turn[5] * vz[i];
    const Real dz = w.turn[6] * vx[i] + w.turn[7] * vy[i] + w.turn[8] * vz[i];
    const Real cos_in = -(nx * dx + ny * dy + nz * dz);
    const Real t = (nx * x + ny * y + nz * z - w.offset[0]) / cos_in;
    const Real px = x + t * dx, py = y + t * dy;
    b.x[i] = px;
    b.y[i] = py;
    b.z[i] = z + t * dz;
    const bool fine = (cos_in > Real(0)) & (magnitude(px) < w.half_x) & (magnitude(py) < w.half_y) &
                      (px * px + py * py < w.radius2);
    b.state[i] = fine ? 0 : 2;
    enter(w.index, dx, dy, dz, nx, ny, nz, cos_in, i, b);
  }
}

template <class Real>
PLENOFLAME_INLINE void meet_round(const KernelWall<Real>& w, int first, int count,
                                  const KernelWays<Real>& ways, Between<Real>& b) {
  const Real* __restrict wx = ways.x + first;
  const Real* __restrict wy = ways.y + first;
  const Real* __restrict wz = ways.z + first;
  const Real* __restrict vx = ways.dx + first;
  const Real* __restrict vy = ways.dy + first;
  const Real* __restrict vz = ways.dz + first;
  const Real square = w.radius[0] * w.radius[0], inverse = Real(1) / w.radius[0];
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const Real x = w.turn[0] * wx[i] + w.turn[1] * wy[i] + w.turn[2] * wz[i] + w.at[0];
    const Real y = w.turn[3] * wx[i] + w.turn[4] * wy[i] + w.turn[5] * wz[i] + w.at[1];
    const Real z = w.turn[6] * wx[i] + w.turn[7] * wy[i] + w.turn[8] * wz[i] + w.at[2];
    const Real dx = w.turn[0] * vx[i] + w.turn[1] * vy[i] + w.turn[2] * vz[i];
    const Real dy = w.turn[3] * vx[i] + w.turn[4] * vy[i] + w.turn[5] * vz[i];
    const Real dz = w.turn[6] * vx[i] + w.turn[7] * vy[i] + w.turn[8] * vz[i];
    // From the point nearest to the axis on, which avoids the subtraction of large numbers.
    const Real per_a = Real(1) / (dx * dx + dy * dy), aside = x * dy - y * dx;
    const Real room = square - aside * aside * per_a;
    const Real t = -(x * dx + y * dy) * per_a - square_root(magnitude(room) * per_a);
    const Real px = x + t * dx, py = y + t * dy, pz = z + t * dz;
    const Real nx = inverse * px, ny = inverse * py, cos_in = -(nx * dx + ny * dy);
    b.x[i] = px;
    b.y[i] = py;
    b.z[i] = pz;
    const bool fine = (cos_in > Real(0)) & (pz > w.low) & (pz < w.high);
    b.state[i] = room > Real(0) ? (fine ? 0 : 2) : (room <= Real(0) ? 1 : 2);
    enter(w.index, dx, dy, dz, nx, ny, Real(0), cos_in, i, b);
  }
}

/// Traces from the first face to the second one, and out of the glass.
template <class Real>
PLENOFLAME_INLINE void leave(const KernelWall<Real>& w, int first, int count,
                             const KernelWays<Real>& ways, Between<Real>& b) {
  Real* __restrict wx = ways.x + first;
  Real* __restrict wy = ways.y + first;
  Real* __restrict wz = ways.z + first;
  Real* __restrict vx = ways.dx + first;
  Real* __restrict vy = ways.dy + first;
  Real* __restrict vz = ways.dz + first;
  int* __restrict odd = ways.odd + first;
  const bool is_round = w.is_round;
  const Real square = w.radius[1] * w.radius[1],
             inverse = is_round ? Real(1) / w.radius[1] : Real(0);
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const Real dx = b.dx[i], dy = b.dy[i], dz = b.dz[i], x = b.x[i], y = b.y[i], z = b.z[i];
    Real nx = w.normal[1][0], ny = w.normal[1][1], nz = w.normal[1][2], t;
    Real room = Real(1);
    if (is_round) {
      const Real per_a = Real(1) / (dx * dx + dy * dy), aside = x * dy - y * dx;
      room = square - aside * aside * per_a;
      t = -(x * dx + y * dy) * per_a - square_root(magnitude(room) * per_a);
      nx = -inverse * (x + t * dx);
      ny = -inverse * (y + t * dy);
      nz = Real(0);
    } else {
      t = (w.offset[1] - (nx * x + ny * y + nz * z)) / (nx * dx + ny * dy + nz * dz);
    }
    const Real px = x + t * dx, py = y + t * dy, pz = z + t * dz;
    const Real cosine = nx * dx + ny * dy + nz * dz;
    const Real square_out = Real(1) - w.index * w.index * (Real(1) - cosine * cosine);
    const Real cos_out = square_root(magnitude(square_out));
    const Real along = cos_out - w.index * cosine;
    const Real ex = w.index * dx + along * nx, ey = w.index * dy + along * ny,
               ez = w.index * dz + along * nz;
    const bool on_flat =
        (magnitude(px) < w.half_x) & (magnitude(py) < w.half_y) & (px * px + py * py < w.radius2);
    const bool on_round = (room > Real(0)) & (pz > w.low) & (pz < w.high);
    const bool fine = (is_round ? on_round : on_flat) & (cosine > Real(0)) &
                      (square_out > Real(0)) & (t > Real(0));
    const int state = b.state[i] == 0 ? (fine ? 0 : 2) : b.state[i];
    const bool goes = state == 0;
    const Real ox = px - w.at[0], oy = py - w.at[1], oz = pz - w.at[2];
    const Real x_new = w.turn[0] * ox + w.turn[3] * oy + w.turn[6] * oz;
    const Real y_new = w.turn[1] * ox + w.turn[4] * oy + w.turn[7] * oz;
    const Real z_new = w.turn[2] * ox + w.turn[5] * oy + w.turn[8] * oz;
    wx[i] = goes ? x_new : wx[i];
    wy[i] = goes ? y_new : wy[i];
    wz[i] = goes ? z_new : wz[i];
    const Real dx_new = w.turn[0] * ex + w.turn[3] * ey + w.turn[6] * ez;
    const Real dy_new = w.turn[1] * ex + w.turn[4] * ey + w.turn[7] * ez;
    const Real dz_new = w.turn[2] * ex + w.turn[5] * ey + w.turn[8] * ez;
    vx[i] = goes ? dx_new : vx[i];
    vy[i] = goes ? dy_new : vy[i];
    vz[i] = goes ? dz_new : vz[i];
    b.cos_second[i] = cosine;
    b.cos_out[i] = cos_out;
    b.length[i] = t;
    b.state[i] = state;
    odd[i] = state == 2 ? 1 : odd[i];
  }
}

/// Attenuates light by absorption and by Fresnel's reflections at both faces (wall_transmission()).
template <class Real>
PLENOFLAME_INLINE void weaken(const KernelWall<Real>& w, int first, int count,
                              const KernelWays<Real>& ways, const Between<Real>& b) {
  Real* __restrict through = ways.through + first;
  const Real n = w.index, absorption = w.absorption;
  const bool reflects = w.reflects;
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const Real clear = exponential(-absorption * b.length[i]);
    const Real c1 = b.cos_in[i], g1 = b.cos_glass[i], c2 = b.cos_out[i], g2 = b.cos_second[i];
    const Real across1 = (c1 - n * g1) / (c1 + n * g1), along1 = (n * c1 - g1) / (n * c1 + g1);
    const Real across2 = (c2 - n * g2) / (c2 + n * g2), along2 = (n * c2 - g2) / (n * c2 + g2);
    const Real a1 = across1 * across1, a2 = across2 * across2, b1 = along1 * along1,
               b2 = along2 * along2, square = clear * clear;
    const Real passed = Real(0.5) * clear *
                        ((Real(1) - a1) * (Real(1) - a2) / (Real(1) - a1 * a2 * square) +
                         (Real(1) - b1) * (Real(1) - b2) / (Real(1) - b1 * b2 * square));
    const Real left = reflects ? passed : clear;
    through[i] *= b.state[i] == 0 ? left : Real(1);
  }
}

template <class Real>
PLENOFLAME_INLINE void pass(const KernelWall<Real>& wall, int count, const KernelWays<Real>& ways) {
  const KernelWall<Real> w = wall;
  alignas(64) Between<Real> between;
  for (int first = 0; first < count; first += kChunk) {
    const int some = count - first < kChunk ? count - first : kChunk;
    if (w.is_round)
      meet_round(w, first, some, ways, between);
    else
      meet_flat(w, first, some, ways, between);
    leave(w, first, some, ways, between);
    if (w.reflects || w.absorption > Real(0)) weaken(w, first, some, ways, between);
  }
}

template <class Real>
PLENOFLAME_INLINE void move(int count, const KernelWays<Real>& ways) {
  Real* __restrict x = ways.x;
  Real* __restrict y = ways.y;
  Real* __restrict z = ways.z;
  const Real* __restrict dx = ways.dx;
  const Real* __restrict dy = ways.dy;
  const Real* __restrict dz = ways.dz;
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const Real t = -(x[i] * dx[i] + y[i] * dy[i] + z[i] * dz[i]);
    x[i] += t * dx[i];
    y[i] += t * dy[i];
    z[i] += t * dz[i];
  }
}

}  // namespace

void pass_wall(const KernelWall<float>& wall, int count, const KernelWays<float>& ways) {
  pass(wall, count, ways);
}
void pass_wall(const KernelWall<double>& wall, int count, const KernelWays<double>& ways) {
  pass(wall, count, ways);
}
void move_to_anchor(int count, const KernelWays<float>& ways) {
  move(count, ways);
}
void move_to_anchor(int count, const KernelWays<double>& ways) {
  move(count, ways);
}

}  // namespace plenoflame::PLENOFLAME_ISA
