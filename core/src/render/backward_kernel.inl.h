// Vector kernels of the backward estimator; compiled once per instruction set.
#include "render/backward_kernel.h"

#include "math/kernel_math.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

PLENOFLAME_INLINE float to_unit(std::uint32_t fraction, float) {
  // 23 bits and half a step: inside (0, 1), never its ends.
  return static_cast<float>(static_cast<std::int32_t>(fraction >> 9)) * 0x1p-23f + 0x1p-24f;
}
PLENOFLAME_INLINE double to_unit(std::uint32_t fraction, double) {
  return static_cast<double>(fraction) * 0x1p-32 + 0x1p-33;
}

/// sin(2 pi b) for |b| <= 1/4, by its Taylor series to b^13: 6e-10 at the end.
template <class Real>
PLENOFLAME_INLINE Real sin_turn(Real b) {
  const Real x = Real(6.283185307179586477) * b, x2 = x * x;
  return x * (Real(1) +
              x2 * (Real(-1.0 / 6) +
                    x2 * (Real(1.0 / 120) +
                          x2 * (Real(-1.0 / 5040) + x2 * (Real(1.0 / 362880) +
                                                          x2 * (Real(-1.0 / 39916800) +
                                                                x2 * Real(1.0 / 6227020800.0)))))));
}

/// Sensor points of one pixel, the cut of the aperture there, and the numbers that aim the rays.
///
/// The sensor point is drawn from the pixel inside the micro-image: first its column, then its row
/// in the chord. What a pixel needs is spread over the arrays of the block here, so that
/// aim_rays(), which is the larger part, has no half empty vectors:
///   x, y   sensor point          z        area that it stands for
///   dx     share of the disc     dy       turn in it
///   dz, weight, scratch[0], [1]  the cut
template <class Real>
PLENOFLAME_INLINE void place_rays(const KernelPatch<Real>& c, const KernelPixel<Real>& pixel,
                                  const KernelBlock<Real>& block) {
  const std::uint32_t* f0 = pixel.fractions[0];
  const std::uint32_t* f1 = pixel.fractions[1];
  const std::uint32_t* f2 = pixel.fractions[2];
  const std::uint32_t* f3 = pixel.fractions[3];
  const std::uint32_t h0 = pixel.shift[0], h1 = pixel.shift[1], h2 = pixel.shift[2],
                      h3 = pixel.shift[3];
  const Real x_low = pixel.x_low, x_width = pixel.x_width, y0 = pixel.y0, y1 = pixel.y1;
  const Real outer_x = c.outer_x, outer_y = c.outer_y, outer2 = c.outer_radius2;
  const Real centre_x = c.centre_x, centre_y = c.centre_y, middle = pixel.cut_middle;
  const Real in0 = pixel.cut[0][0], in1 = pixel.cut[0][1], in2 = pixel.cut[0][2],
             in3 = pixel.cut[0][3];
  const Real out0 = pixel.cut[1][0], out1 = pixel.cut[1][1], out2 = pixel.cut[1][2],
             out3 = pixel.cut[1][3];
  const Real in_slope0 = pixel.slope[0][0], in_slope1 = pixel.slope[0][1],
             in_slope2 = pixel.slope[0][2], in_slope3 = pixel.slope[0][3];
  const Real out_slope0 = pixel.slope[1][0], out_slope1 = pixel.slope[1][1],
             out_slope2 = pixel.slope[1][2], out_slope3 = pixel.slope[1][3];
  const int first = pixel.first;
  Real* __restrict x = block.x + first;
  Real* __restrict y = block.y + first;
  Real* __restrict area = block.z + first;
  Real* __restrict disc = block.dx + first;
  Real* __restrict turn = block.dy + first;
  Real* __restrict low = block.dz + first;
  Real* __restrict high = block.weight + first;
  Real* __restrict low_far = block.scratch[0] + first;
  Real* __restrict high_far = block.scratch[1] + first;
  const int padded = (pixel.count + 15) & ~15;
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real sx = x_low + x_width * to_unit(f0[i] ^ h0, Real());
    const Real chord = square_root(greatest(outer2 - (sx - outer_x) * (sx - outer_x), Real(0)));
    const Real top = greatest(y0, outer_y - chord);
    const Real height = greatest(least(y1, outer_y + chord) - top, Real(0));
    const Real sy = top + height * to_unit(f1[i] ^ h1, Real());
    const Real wx = sx - centre_x, wy = sy - centre_y;
    const Real d = square_root(wx * wx + wy * wy) - middle;
    const bool inner = d < Real(0);
    x[i] = sx;
    y[i] = sy;
    area[i] = x_width * height;
    disc[i] = to_unit(f2[i] ^ h2, Real());
    turn[i] = to_unit(f3[i] ^ h3, Real()) - Real(0.5);
    low[i] = (inner ? in0 : out0) + (inner ? in_slope0 : out_slope0) * d;
    high[i] = (inner ? in1 : out1) + (inner ? in_slope1 : out_slope1) * d;
    low_far[i] = (inner ? in2 : out2) + (inner ? in_slope2 : out_slope2) * d;
    high_far[i] = (inner ? in3 : out3) + (inner ? in_slope3 : out_slope3) * d;
  }
}

/// Aims the rays that place_rays() has placed: uniform points of that part of the aperture that
/// sees the scene from there.
///
/// The part is bounded by four circles: those of the two apertures of the microlens, and two
/// through the ends `low` and `high` of the part's extent along the line through the patch's
/// centre, centred on that line. A uniform point of the unit disc is stretched to it: linearly
/// along the line, across from one end of the chord to the other. All weights are exact Jacobians:
/// a bound that is too wide costs rays, never light.
template <class Real>
PLENOFLAME_INLINE void aim_rays(const KernelPatch<Real>& c, int first, int count, Real distance,
                                const KernelBlock<Real>& block) {
  Real* __restrict x = block.x + first;
  Real* __restrict y = block.y + first;
  Real* __restrict z = block.z + first;
  Real* __restrict dx = block.dx + first;
  Real* __restrict dy = block.dy + first;
  Real* __restrict dz = block.dz + first;
  Real* __restrict weight = block.weight + first;
  const Real* __restrict low_far = block.scratch[0] + first;
  const Real* __restrict high_far = block.scratch[1] + first;
  int* __restrict code = block.code + first;
  const Real centre_x = c.centre_x, centre_y = c.centre_y;
  const Real origin_x = c.origin_x, origin_y = c.origin_y, origin_shift = c.origin_shift;
  const Real near_radius = c.near_radius, near_shift = c.near_shift;
  const Real far_radius = c.far_radius, far_growth = c.far_growth;
  const Real far_shift = c.far_shift, far_bend = c.far_bend;
  const Real g2 = distance * distance;
  const int padded = (count + 15) & ~15;
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real sx = x[i], sy = y[i];
    const Real wx = sx - centre_x, wy = sy - centre_y;
    const Real w2 = wx * wx + wy * wy;
    const Real inverse_w = Real(1) / square_root(greatest(w2, Real(1e-30)));
    const Real ex = w2 > Real(1e-30) ? wx * inverse_w : Real(1);
    const Real ey = w2 > Real(1e-30) ? wy * inverse_w : Real(0);

    // The discs of the two apertures. The centre of the near one lies hardly beside the line: it is
    // taken to lie on it, and the disc to be larger.
    const Real s_along = sx * ex + sy * ey, s_beside = sy * ex - sx * ey;
    const Real near = near_radius + magnitude(near_shift * s_beside);
    const Real s2 = sx * sx + sy * sy;
    const Real far = far_radius + far_growth * s2, shift = far_shift + far_bend * s2;
    const Real near_along = near_shift * s_along, far_along = shift * s_along;
    const Real far_beside = shift * s_beside;
    const Real cut_low = dz[i], cut_high = weight[i];
    const Real low = greatest(cut_low, greatest(near_along - near, far_along - far));
    const Real high = least(cut_high, least(near_along + near, far_along + far));

    const Real t = dy[i], v2 = dx[i];
    const Real folded = t > Real(0.25) ? Real(0.5) - t : (t < Real(-0.25) ? Real(-0.5) - t : t);
    const Real across = square_root(v2) * sin_turn(folded);
    const Real cosine = square_root(v2) * sin_turn(Real(0.25) - magnitude(t));
    const Real half = greatest(Real(0.5) * (high - low), Real(0));
    const Real p = Real(0.5) * (low + high) + half * cosine;
    const Real unit_chord2 = (Real(1) - v2) + across * across;  // 1 - cosine^2
    const Real above = p - cut_low, below = cut_high - p;
    const Real near_p = p - near_along, far_p = p - far_along;
    const Real cut2 = least(near * near - near_p * near_p,
                            least(above * (low_far[i] - p), below * (p - high_far[i])));
    const Real cut_half = square_root(greatest(cut2, Real(0)));
    const Real far_half = square_root(greatest(far * far - far_p * far_p, Real(0)));
    const Real top = least(cut_half, far_beside + far_half);
    const Real bottom = greatest(-cut_half, far_beside - far_half);
    const Real stretch = greatest(Real(0.5) * (top - bottom), Real(0)) / square_root(unit_chord2);
    const Real q = Real(0.5) * (top + bottom) + across * stretch;
    const Real ux = origin_x + origin_shift * sx + ex * p - ey * q;
    const Real uy = origin_y + origin_shift * sy + ey * p + ex * q;

    const Real vx = ux - sx, vy = uy - sy;
    const Real inverse = Real(1) / square_root(vx * vx + vy * vy + g2);
    const Real inverse2 = inverse * inverse;
    // cos(theta) dOmega = cos^2 / r^2 dA' on parallel planes.
    weight[i] = Real(3.141592653589793238) * half * stretch * z[i] * (g2 * inverse2 * inverse2);
    x[i] = ux;
    y[i] = uy;
    z[i] = Real(0);
    dx[i] = vx * inverse;
    dy[i] = vy * inverse;
    dz[i] = distance * inverse;
    code[i] = 0;
  }
}

template <class Real>
PLENOFLAME_INLINE void generate_all(const KernelPatch<Real>& patch, const KernelPixel<Real>* pixels,
                                    int count, Real distance, const KernelBlock<Real>& block) {
  const KernelPatch<Real> c = patch;
  for (int i = 0; i < count; ++i) place_rays(c, pixels[i], block);
  const int first = pixels[0].first;
  aim_rays(c, first, pixels[count - 1].first + pixels[count - 1].count - first, distance, block);
}

template <class Real>
PLENOFLAME_INLINE double sum_products(const Real* __restrict weight,
                                      const Real* __restrict radiance, int count) {
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (int i = 0; i < count; ++i)
    sum += static_cast<double>(weight[i]) * static_cast<double>(radiance[i]);
  return sum;
}

}  // namespace

void generate(const KernelPatch<float>& patch, const KernelPixel<float>* pixels, int count,
              float distance, const KernelBlock<float>& block) {
  generate_all(patch, pixels, count, distance, block);
}

void generate(const KernelPatch<double>& patch, const KernelPixel<double>* pixels, int count,
              double distance, const KernelBlock<double>& block) {
  generate_all(patch, pixels, count, distance, block);
}

double accumulate(const float* weight, const float* radiance, int count) {
  return sum_products(weight, radiance, count);
}

double accumulate(const double* weight, const double* radiance, int count) {
  return sum_products(weight, radiance, count);
}

}  // namespace plenoflame::PLENOFLAME_ISA
