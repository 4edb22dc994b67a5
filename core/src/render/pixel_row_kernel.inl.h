// Vector kernels of what is asked of rows of pixels; compiled once per instruction set.
#include "render/pixel_row_kernel.h"

#include "math/kernel_math.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

/// As plenoflame::mix64 (sampling/sobol.h).
PLENOFLAME_INLINE std::uint64_t mixed(std::uint64_t key) {
  key += 0x9e3779b97f4a7c15u;
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9u;
  key = (key ^ (key >> 27)) * 0x94d049bb133111ebu;
  return key ^ (key >> 31);
}

PLENOFLAME_INLINE int place_at(double at) {
  return static_cast<int>(clamp(at, 0.0, kRasterSide - 1.0));
}

}  // namespace

void survey_row(const KernelRow& row, const KernelRowPixels& pixels) {
  const KernelRow r = row;
  const double half = 0.5 * r.pitch, y = r.y - r.centre_y;
  const double y_off = magnitude(y), near_y = greatest(y_off - half, 0.0), far_y = y_off + half;
  // No remainder: what is found must not depend on how many pixels there are.
  const int padded = (r.count + 7) & ~7;
  double* __restrict at_x = pixels.x;
  double* __restrict x_low = pixels.x_low;
  double* __restrict x_width = pixels.x_width;
  double* __restrict far2 = pixels.far2;
  int* __restrict level = pixels.level;
  int* __restrict sector = pixels.sector;
  const double* closes = r.closes;
#pragma omp simd simdlen(8)
  for (int i = 0; i < padded; ++i) {
    const double column = static_cast<double>(static_cast<int>(r.column) + i);
    const double x = (r.half_columns - (column + 0.5)) * r.pitch - r.lens_x;
    at_x[i] = x;
    const double vx = x - r.centre_x, x_off = magnitude(vx);
    const double far_x = x_off + half;
    far2[i] = far_x * far_x + far_y * far_y;
    const double distance2 = vx * vx + y * y;
    // Squares with their signs: in the order of the numbers, without a root.
    const double along = vx * r.field_x + y * r.field_y, along2 = along * magnitude(along);
    double of_direction = 0;
#pragma GCC unroll 8
    for (int k = 0; k < kCutAzimuths - 1; ++k)
      of_direction += along2 < kCutBorders[k] * magnitude(kCutBorders[k]) * distance2 ? 1.0 : 0.0;
    const int number = static_cast<int>(distance2 > r.clear2 ? of_direction : kCutAzimuths);
    sector[i] = number;
    // Columns inside of the disc that the sector's light comes from.
    const double radius = closes[number];
    const double reach = square_root(greatest(radius * radius - near_y * near_y, 0.0));
    const double low = greatest(vx - half, -reach), width = least(vx + half, reach) - low;
    x_low[i] = r.centre_x + low;
    x_width[i] = width;
    double of_worth = 0;
#pragma GCC unroll 8
    for (int k = 0; k < kWorthRings; ++k) {
      of_worth += distance2 > r.rings[k] ? 1.0 : 0.0;
      of_worth += width <= r.parts[k] ? 1.0 : 0.0;
    }
    level[i] = static_cast<int>(of_worth);
  }
  std::uint64_t* __restrict a = pixels.random[0];
  std::uint64_t* __restrict b = pixels.random[1];
  std::uint64_t* __restrict c = pixels.random[2];
  std::uint64_t* __restrict d = pixels.random[3];
  std::uint64_t* __restrict e = pixels.random[4];
#pragma omp simd simdlen(8)
  for (int i = 0; i < padded; ++i) {
    const std::uint64_t column = r.column + static_cast<std::uint64_t>(i);
    const std::uint64_t first = mixed((column << 32 | r.row) ^ r.key), second = mixed(first),
                        third = mixed(second), fourth = mixed(third + kSecondShiftSeed);
    a[i] = first;
    b[i] = second;
    c[i] = third;
    d[i] = fourth;
    e[i] = mixed(fourth);
  }
}

void judge_row(const KernelRow& row, const KernelBeam& of_beam, const KernelRowPixels& pixels) {
  const KernelRow r = row;
  const KernelBeam b = of_beam;
  const double* radii = b.radius;
  const double* inners = b.inner;
  const float* raster = b.to_lit;
  const double* __restrict at_x = pixels.x;
  int* __restrict verdict = pixels.verdict;
  const int padded = (r.count + 7) & ~7;
  const double y = r.y, vy = y - r.centre_y;
#pragma omp simd simdlen(8)
  for (int i = 0; i < padded; ++i) {
    const double x = at_x[i], vx = x - r.centre_x;
    const double px = b.middle_x[0] + b.middle_x[1] * x + b.middle_x[2] * y;
    const double py = b.middle_y[0] + b.middle_y[1] * x + b.middle_y[2] * y;
    const double axis_x = b.axis_x[0] + b.axis_x[1] * x + b.axis_x[2] * y;
    const double axis_y = b.axis_y[0] + b.axis_y[1] * x + b.axis_y[2] * y;
    const double half_way = 0.5 * square_root(axis_x * axis_x + axis_y * axis_y);
    const int bin =
        static_cast<int>(least(square_root(vx * vx + vy * vy) * b.bins_per_metre, kBeamBins - 1.0));
    const double radius = radii[bin], inner = inners[bin];
    const double near_x = clamp(px, b.lower_x, b.upper_x), near_y = clamp(py, b.lower_y, b.upper_y);
    const int place = place_at((near_y - b.lower_y) * b.scale_y) * kRasterSide +
                      place_at((near_x - b.lower_x) * b.scale_x);
    const double in = static_cast<double>(raster[place]);
    const double out_x = px - near_x, out_y = py - near_y;
    const double out2 = out_x * out_x + out_y * out_y, reach = radius + half_way;
    // No && here: what branches is not vectorised. Beams that are longer than wide, between the
    // planes, are looked at in parts: not here.
    const bool is_short = half_way <= 0.25 * radius;
    const bool beyond = out2 + in * in > reach * reach * (1 + kBeamRounding);
    const bool within = square_root(out2) + in + b.lit_room <= inner;
    const bool holds =
        (px > b.lower_x) & (px < b.upper_x) & (py > b.lower_y) & (py < b.upper_y) & !(in > 0);
    const int of_disc = is_short ? (beyond ? kSeesNothing : kNeedsOutline) : kNeedsLook;
    verdict[i] = holds | within ? kSeesSomething : of_disc;
  }
}

}  // namespace plenoflame::PLENOFLAME_ISA
