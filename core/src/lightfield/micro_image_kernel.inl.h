// Vector kernels of micro-images; compiled once per instruction set.
#include "lightfield/micro_image_kernel.h"

#include "math/kernel_math.h"

namespace plenoflame::PLENOFLAME_ISA {

void white_light(const KernelWhitePart* parts, int part_count, int side, int count,
                 const float* __restrict px, const float* __restrict py, float* __restrict out) {
  for (int k = 0; k < count; ++k) out[k] = 0;
  const float most = static_cast<float>(side - 1), last = most - 1e-3f;
  for (int n = 0; n < part_count; ++n) {
    const KernelWhitePart part = parts[n];
    const float* __restrict table = part.table;
#pragma omp simd
    for (int k = 0; k < count; ++k) {
      const float x = part.x0 + part.xx * px[k] + part.xy * py[k];
      const float y = part.y0 + part.yx * px[k] + part.yy * py[k];
      const bool inside = (x >= 0.f) & (x < most) & (y >= 0.f) & (y < most);
      const float cx = clamp(x, 0.f, last), cy = clamp(y, 0.f, last);
      const int i = static_cast<int>(cx), j = static_cast<int>(cy);
      const float s = cx - static_cast<float>(i), r = cy - static_cast<float>(j);
      const int at = j * side + i;
      const float a = table[at], b = table[at + 1], c = table[at + side], d = table[at + side + 1];
      const float low = a + s * (b - a), high = c + s * (d - c);
      const float weight =
          inside ? part.weight : 0.f;  // a choice around the loads keeps them scalar
      out[k] += weight * (low + r * (high - low));
    }
  }
#pragma omp simd
  for (int k = 0; k < count; ++k) out[k] = greatest(out[k], 0.f);
}

namespace {

/// Coefficients as single values: of arrays the vectoriser makes loads in every step.
struct Polynomial {
  float t0, t1, t2, t3, t4, t5, t6, t7, t8, t9, t10, t11, t12, t13, t14, t15, t16, t17, t18, t19,
      t20;
};

PLENOFLAME_INLINE Polynomial polynomial_of(const float* t) {
  return {t[0],  t[1],  t[2],  t[3],  t[4],  t[5],  t[6],  t[7],  t[8],  t[9], t[10],
          t[11], t[12], t[13], t[14], t[15], t[16], t[17], t[18], t[19], t[20]};
}

/// Horner's rule in y over the polynomials in x.
PLENOFLAME_INLINE float polynomial(const Polynomial& t, float x, float y) {
  const float a = t.t0 + x * (t.t1 + x * (t.t2 + x * (t.t3 + x * (t.t4 + x * t.t5))));
  const float b = t.t6 + x * (t.t7 + x * (t.t8 + x * (t.t9 + x * t.t10)));
  const float c = t.t11 + x * (t.t12 + x * (t.t13 + x * t.t14));
  const float d = t.t15 + x * (t.t16 + x * t.t17);
  const float e = t.t18 + x * t.t19;
  return a + y * (b + y * (c + y * (d + y * (e + y * t.t20))));
}

}  // namespace

bool project(const KernelProjection& projection, const KernelSamples& samples) {
  int* __restrict column = samples.column;
  int* __restrict row = samples.row;
  float* __restrict right = samples.right;
  float* __restrict down = samples.down;
  float* __restrict light = samples.light;
  float* __restrict white = samples.white;
  const KernelProjection c = projection;
  const float* __restrict px = c.x;
  const float* __restrict py = c.y;
  const float* __restrict flux = c.flux;
  const float* __restrict own = c.own;
  const float* __restrict total = c.total;
  const Polynomial u = polynomial_of(c.along), v = polynomial_of(c.across);
  float bad = 0;  // infinite and undefined values times 0 are undefined
#pragma omp simd reduction(+ : bad)
  for (int k = 0; k < c.count; ++k) {
    const float x = c.scale_x * px[k], y = c.scale_y * py[k];
    // Far outside of any picture whole numbers would not do.
    const float along = clamp(polynomial(u, x, y), -1e6f, 1e6f);
    const float across = clamp(polynomial(v, x, y), -1e6f, 1e6f);
    const int i = static_cast<int>(along), j = static_cast<int>(across);
    const int left = i - (static_cast<float>(i) > along ? 1 : 0);
    const int above = j - (static_cast<float>(j) > across ? 1 : 0);
    column[k] = left;
    row[k] = above;
    right[k] = along - static_cast<float>(left);
    down[k] = across - static_cast<float>(above);
    const bool lit = own[k] > 0.f;
    const float value = lit ? flux[k] : 0.f, all = lit ? total[k] : 1.f;
    bad += 0.f * value;
    light[k] = c.weight * value * (own[k] / all);
    white[k] = c.weight * own[k];
  }
  return bad == bad;
}

}  // namespace plenoflame::PLENOFLAME_ISA
