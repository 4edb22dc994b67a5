// Arithmetic for the vector kernels: branch-free, so that GCC vectorises the loops that call it.
// No standard headers: an inline function of the library compiled here for one processor could be
// linked into code for another. Included once per instruction set, inside its own namespace.
#pragma once

#ifndef PLENOFLAME_ISA
#define PLENOFLAME_ISA scalar
#endif

namespace plenoflame::PLENOFLAME_ISA {

#define PLENOFLAME_INLINE static inline __attribute__((always_inline))

PLENOFLAME_INLINE float square_root(float x) {
  return __builtin_sqrtf(x);
}
PLENOFLAME_INLINE double square_root(double x) {
  return __builtin_sqrt(x);
}
PLENOFLAME_INLINE float magnitude(float x) {
  return __builtin_fabsf(x);
}
PLENOFLAME_INLINE double magnitude(double x) {
  return __builtin_fabs(x);
}

// Ternaries instead of fmin/fmax: those keep a loop scalar.
template <class T>
PLENOFLAME_INLINE T least(T a, T b) {
  return a < b ? a : b;
}
template <class T>
PLENOFLAME_INLINE T greatest(T a, T b) {
  return a > b ? a : b;
}
template <class T>
PLENOFLAME_INLINE T clamp(T x, T lo, T hi) {
  return least(greatest(x, lo), hi);
}

/// 1 / sqrt(x), x >= 0, finite for 0. In single precision its error is 2e-7, without the
/// processor's divider, which loops over rays would wait for. Half of the exponent and a line give
/// the start, to 3 % except for a factor. Two steps of Newton's kind follow. The first has the
/// numbers of J. Kadlec 2010 with that factor, to 6.5e-4. The second is the series in 1 - x y^2, up
/// to its square.
PLENOFLAME_INLINE float inverse_square_root(float x) {
  float y = __builtin_bit_cast(float, 0x5f1ffff9 - (__builtin_bit_cast(int, x) >> 1));
  y *= 1.6819139F - 0.70395225F * (x * y * y);
  const float square = x * y * y;
  return y * (1.875F + square * (0.375F * square - 1.25F));
}
PLENOFLAME_INLINE double inverse_square_root(double x) {
  return 1 / __builtin_sqrt(greatest(x, 1e-300));
}

/// sqrt(x) to 6.5e-4, x >= 0 and within what `float` holds: the first of those steps. The same
/// number for both precisions, as far as single precision goes.
PLENOFLAME_INLINE float near_square_root(float x) {
  const float y = __builtin_bit_cast(float, 0x5f1ffff9 - (__builtin_bit_cast(int, x) >> 1));
  const float root = x * y;
  return root * (1.6819139F - 0.70395225F * (root * y));
}
PLENOFLAME_INLINE double near_square_root(double x) {
  return static_cast<double>(near_square_root(static_cast<float>(x)));
}

/// The same to 3.5 %, where any number near the root will do.
PLENOFLAME_INLINE float rough_square_root(float x) {
  return __builtin_bit_cast(float, (__builtin_bit_cast(int, x) >> 1) + 0x1fbb5000);
}
PLENOFLAME_INLINE double rough_square_root(double x) {
  return static_cast<double>(rough_square_root(static_cast<float>(x)));
}

}  // namespace plenoflame::PLENOFLAME_ISA
