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

}  // namespace plenoflame::PLENOFLAME_ISA
