// Vector kernels for rows of pixels; compiled once per instruction set.
#include "render/visibility/pixel_row_kernel.h"

#include "math/kernel_math.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

/// The same as plenoflame::mix64 (sampling/sobol.h).
PLENOFLAME_INLINE std::uint64_t mixed(std::uint64_t key) {
  key += 0x9e3779b97f4a7c15u;
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9u;
  key = (key ^ (key >> 27)) * 0x94d049bb133111ebu;
  return key ^ (key >> 31);
}

// Doubles in place of ints: loops with ints are compiled to narrower vectors.
constexpr double kLanes[kRowLanes] = {0, 1, 2, 3, 4, 5, 6, 7};
constexpr std::uint64_t kLaneNumbers[kRowLanes] = {0, 1, 2, 3, 4, 5, 6, 7};

}  // namespace

// Each step is a loop over all pixels, because a single row is too short to keep several vectors in
// flight. Arithmetic on lengths uses full vectors only: results must not depend on the number of
// pixels. (Integers and comparisons are exact in any vector.)
void set_up_rows(const KernelRows& rows, const KernelRowPixels& pixels) {
  const KernelRows r = rows;
  const int count = r.rows * r.count, padded = (count + kRowLanes - 1) / kRowLanes * kRowLanes;
  const double half = 0.5 * r.pitch + r.blur_x, half_y = 0.5 * r.pitch_y + r.blur_y;
  double* __restrict at_x = pixels.x;
  double* __restrict at_y = pixels.y;
  std::uint64_t* __restrict place = pixels.place;
  double* __restrict x_low = pixels.x_low;
  double* __restrict x_width = pixels.x_width;
  double* __restrict far2 = pixels.far2;
  int* __restrict level = pixels.level;
  int* __restrict sector = pixels.sector;
  const double* closes = rows.closes;
  alignas(64) double from_centre2[kRowsPixels], sector_found[kRowsPixels], level_found[kRowsPixels];
  // Each row's last vector may extend beyond the row; the next row overwrites the excess.
  for (int row = 0; row < r.rows; ++row) {
    const double y = r.y[row];
    const std::uint64_t number = r.row + static_cast<std::uint64_t>(row);
    for (int first = 0; first < r.count; first += kRowLanes) {
      const int k = row * r.count + first;
      const double start = static_cast<double>(static_cast<int>(r.column) + first);
      const std::uint64_t start_number = r.column + static_cast<std::uint64_t>(first);
#pragma omp simd simdlen(8)
      for (int i = 0; i < kRowLanes; ++i) {
        const double column = start + kLanes[i];
        at_x[k + i] = (r.half_columns - (column + 0.5)) * r.pitch - r.lens_x;
        at_y[k + i] = y;
        place[k + i] = (start_number + kLaneNumbers[i]) << 32 | number;
      }
    }
  }
  for (int k = count; k < padded; ++k) {
    at_x[k] = at_x[0];
    at_y[k] = at_y[0];
    place[k] = place[0];
  }
  for (int k = 0; k < padded; k += kRowLanes)
#pragma omp simd simdlen(8)
    for (int i = k; i < k + kRowLanes; ++i) {
      const double vx = at_x[i] - r.centre_x, far_x = magnitude(vx) + half;
      const double vy = at_y[i] - r.centre_y, far_y = magnitude(vy) + half_y;
      far2[i] = far_x * far_x + far_y * far_y;
      const double distance2 = vx * vx + vy * vy;
      from_centre2[i] = distance2;
      // Squares with the sign of their number: they have the same order and need no root.
      const double along = vx * r.field_x + vy * r.field_y, along2 = along * magnitude(along);
      double of_direction = 0;
#pragma GCC unroll 8
      for (int n = 0; n < kCutAzimuths - 1; ++n)
        of_direction += along2 < kCutBorders[n] * magnitude(kCutBorders[n]) * distance2 ? 1.0 : 0.0;
      sector_found[i] = distance2 > r.clear2 ? of_direction : double(kCutAzimuths);
    }
#pragma omp simd
  for (int i = 0; i < padded; ++i) sector[i] = static_cast<int>(sector_found[i]);
  // Columns inside the lit disc of the sector.
  for (int k = 0; k < padded; k += kRowLanes)
#pragma omp simd simdlen(8)
    for (int i = k; i < k + kRowLanes; ++i) {
      const double near_y = greatest(magnitude(at_y[i] - r.centre_y) - half_y, 0.0);
      const double radius = closes[sector[i]];
      const double vx = at_x[i] - r.centre_x;
      const double reach = square_root(greatest(radius * radius - near_y * near_y, 0.0));
      const double low = greatest(vx - half, -reach);
      x_low[i] = r.centre_x + low;
      x_width[i] = least(vx + half, reach) - low;
    }
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const double distance2 = from_centre2[i], width = x_width[i];
    double of_rings = 0, of_parts = 0;
#pragma GCC unroll 8
    for (int k = 0; k < kWorthRings; ++k) {
      of_rings += distance2 > r.rings[k] ? 1.0 : 0.0;
      of_parts += width <= r.parts[k] ? 1.0 : 0.0;
    }
    level_found[i] = of_rings + of_parts;
  }
#pragma omp simd
  for (int i = 0; i < padded; ++i) level[i] = static_cast<int>(level_found[i]);
  std::uint64_t* __restrict a = pixels.random[0];
  std::uint64_t* __restrict b = pixels.random[1];
  std::uint64_t* __restrict c = pixels.random[2];
  std::uint64_t* __restrict d = pixels.random[3];
  std::uint64_t* __restrict e = pixels.random[4];
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const std::uint64_t one = mixed(place[i] ^ r.key);
    a[i] = one;
    b[i] = mixed(one + 1);
    c[i] = mixed(one + 2);
    d[i] = mixed(one + 3);
    e[i] = mixed(one + 4);
  }
}

}  // namespace plenoflame::PLENOFLAME_ISA
