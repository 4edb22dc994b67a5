// Kernels of the rows of operators; compiled once per instruction set. Formulas:
// docs/theory/reconstruction.md.
#include "media/voxels/interval_kernel.h"

#include "math/kernel_math.h"
#include "media/voxels/voxel_kernel_weights.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

constexpr int kCorners = RayInterval::kCorners;
constexpr double kNever = 1e300, kNoMovement = 1e-200;

/// The weight of corner c along axis a is begin[a][c] + step[a][c] * (place in the cell).
struct CornerWeights {
  double begin[3][kCorners], step[3][kCorners];
};
constexpr CornerWeights kLinear = {
    {{1, 0, 1, 0, 1, 0, 1, 0}, {1, 1, 0, 0, 1, 1, 0, 0}, {1, 1, 1, 1, 0, 0, 0, 0}},
    {{-1, 1, -1, 1, -1, 1, -1, 1}, {-1, -1, 1, 1, -1, -1, 1, 1}, {-1, -1, -1, -1, 1, 1, 1, 1}}};

/// A ray on its way through cells; a fourth axis, along which it does not move, fills the vectors.
struct CellWalk {
  alignas(32) double origin[4], direction[4];
  alignas(32) double cell[4], step[4], low[4], high[4];
  alignas(32) double crossing[4];           // where it leaves its cell
  alignas(32) double inverse[4], shift[4];  // crossing = cell * inverse + shift
};

PLENOFLAME_INLINE void start(const KernelLattice& lattice, const KernelLine& line, CellWalk& walk) {
  for (int a = 0; a < 4; ++a) {
    walk.origin[a] = walk.direction[a] = walk.cell[a] = walk.step[a] = walk.inverse[a] = 0;
    walk.low[a] = -1;
    walk.high[a] = 1;
    walk.shift[a] = walk.crossing[a] = kNever;
  }
  for (int a = 0; a < 3; ++a) {
    walk.origin[a] = line.origin[a];
    walk.direction[a] = line.direction[a];
    walk.low[a] = lattice.low[a];
    walk.high[a] = lattice.high[a];
    const double at = line.origin[a] + line.from * line.direction[a];
    const int whole = static_cast<int>(at);
    walk.cell[a] = clamp(whole - (static_cast<double>(whole) > at ? 1 : 0), lattice.low[a],
                         lattice.high[a] - 1);
    if (magnitude(line.direction[a]) < kNoMovement) continue;
    const bool up = line.direction[a] > 0;
    walk.step[a] = up ? 1 : -1;
    walk.inverse[a] = 1 / line.direction[a];
    walk.shift[a] = ((up ? 1 : 0) - line.origin[a]) * walk.inverse[a];
    walk.crossing[a] = walk.cell[a] * walk.inverse[a] + walk.shift[a];
  }
}

/// Steps over the next faces. @param t of these @return whether the ray leaves the lattice
PLENOFLAME_INLINE bool step_on(double t, CellWalk& walk) {
  double outside = 0;
#pragma omp simd reduction(+ : outside)
  for (int a = 0; a < 4; ++a) {
    walk.cell[a] += walk.crossing[a] <= t ? walk.step[a] : 0;
    walk.crossing[a] = walk.cell[a] * walk.inverse[a] + walk.shift[a];
    const bool leaves = (walk.cell[a] < walk.low[a]) | (walk.cell[a] >= walk.high[a]);
    outside += leaves ? 1.0 : 0.0;
  }
  return outside > 0;
}

/// Samples and weights of an interval that begins at t, in a cell of a trilinear field.
PLENOFLAME_INLINE void set_linear(const KernelLattice& lattice, const CellWalk& walk, double t,
                                  RayInterval& out) {
  const int i = static_cast<int>(walk.cell[0]), j = static_cast<int>(walk.cell[1]),
            k = static_cast<int>(walk.cell[2]);
  const int* count = lattice.count;
  const int first = (i * count[1] + j) * count[2] + k;
  for (int c = 0; c < kCorners; ++c)
    out.sample[c] = static_cast<std::uint32_t>(first + lattice.corner[c]);
  for (int n = 0; n < 2; ++n) {
    alignas(32) double place[4];
    const double at = t + kGaussNodes[n] * out.length;
#pragma omp simd
    for (int a = 0; a < 4; ++a)
      place[a] = clamp(walk.origin[a] - walk.cell[a] + at * walk.direction[a], 0.0, 1.0);
#pragma omp simd
    for (int c = 0; c < kCorners; ++c)
      out.weight[n][c] = (kLinear.begin[0][c] + kLinear.step[0][c] * place[0]) *
                         (kLinear.begin[1][c] + kLinear.step[1][c] * place[1]) *
                         (kLinear.begin[2][c] + kLinear.step[2][c] * place[2]);
  }
  out.count = kCorners;
  const bool inside =
      (i >= 0) & (j >= 0) & (k >= 0) & (i + 1 < count[0]) & (j + 1 < count[1]) & (k + 1 < count[2]);
  if (inside) return;
  for (int c = 0; c < kCorners; ++c) {
    const int x = i + (c & 1), y = j + (c >> 1 & 1), z = k + (c >> 2);
    if ((x >= 0) & (y >= 0) & (z >= 0) & (x < count[0]) & (y < count[1]) & (z < count[2])) continue;
    out.sample[c] = 0;
    out.weight[0][c] = out.weight[1][c] = 0;
  }
}

PLENOFLAME_INLINE void set_constant(const KernelLattice& lattice, const CellWalk& walk,
                                    RayInterval& out) {
  const int i = static_cast<int>(walk.cell[0]), j = static_cast<int>(walk.cell[1]),
            k = static_cast<int>(walk.cell[2]);
  for (int c = 0; c < kCorners; ++c) {
    out.sample[c] = static_cast<std::uint32_t>((i * lattice.count[1] + j) * lattice.count[2] + k);
    out.weight[0][c] = out.weight[1][c] = c == 0 ? 1 : 0;
  }
  out.count = 1;
}

}  // namespace

int cut_at_cells(const KernelLattice& lattice, const KernelLine& line, RayInterval* out) {
  CellWalk walk;
  start(lattice, line, walk);
  int size = 0;
  for (double t = line.from; t < line.to;) {
    const double face = least(walk.crossing[0], least(walk.crossing[1], walk.crossing[2]));
    const double next = clamp(face, t, line.to);
    if (next > t) {
      RayInterval& interval = out[size++];
      interval.length = next - t;
      if (lattice.is_linear)
        set_linear(lattice, walk, t, interval);
      else
        set_constant(lattice, walk, interval);
    }
    t = next;
    if (step_on(face, walk)) break;
  }
  return size;
}

void add_up_depths(const RayInterval* __restrict intervals, int count,
                   const double* __restrict absorption, double ratio, double* __restrict near,
                   double* __restrict far) {
  for (int i = 0; i < count; ++i) {
    const RayInterval& interval = intervals[i];
    double first = 0, second = 0;
#pragma omp simd reduction(+ : first, second)
    for (int c = 0; c < kCorners; ++c) {
      const double value = absorption[static_cast<int>(interval.sample[c])];
      first += interval.weight[0][c] * value;
      second += interval.weight[1][c] * value;
    }
    const double half = 0.5 * interval.length * ratio;
    near[i] = half * greatest(first, 0.0);
    far[i] = half * greatest(second, 0.0);
  }
}

void weigh_nodes(bool emission, int count, const KernelTransfers& all) {
  const double* __restrict near_depth = all.near_depth;
  const double* __restrict far_depth = all.far_depth;
  double* __restrict transmittance = all.transmittance;
  double* __restrict near = all.near;
  double* __restrict far = all.far;
  if (emission) {
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      const auto weights = line_weights(near_depth[i], far_depth[i]);
      transmittance[i] = interval_weights(near_depth[i], far_depth[i]).transmittance;
      near[i] = weights.near;
      far[i] = weights.far;
    }
    return;
  }
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const auto weights = interval_weights(near_depth[i], far_depth[i]);
    transmittance[i] = weights.transmittance;
    near[i] = weights.near;
    far[i] = weights.far;
  }
}

void sum_nodes(RayInterval* intervals, int count, double factor, const double* __restrict near,
               const double* __restrict far) {
  for (int i = 0; i < count; ++i) {
    RayInterval& interval = intervals[i];
    const double first = factor * near[i], second = factor * far[i];
#pragma omp simd
    for (int c = 0; c < kCorners; ++c)
      interval.weight[0][c] = first * interval.weight[0][c] + second * interval.weight[1][c];
  }
}

}  // namespace plenoflame::PLENOFLAME_ISA
