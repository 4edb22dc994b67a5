// Runs the roots of math/kernel_math.h over arrays, once per instruction set.
#include "math/kernel_math.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

template <class Real>
PLENOFLAME_INLINE void probe(const Real* __restrict in, int size, Real* __restrict inverse,
                             Real* __restrict near, Real* __restrict rough) {
#pragma omp simd
  for (int i = 0; i < size; ++i) {
    inverse[i] = inverse_square_root(in[i]);
    near[i] = near_square_root(in[i]);
    rough[i] = rough_square_root(in[i]);
  }
}

}  // namespace

void probe_roots(const float* in, int size, float* inverse, float* near, float* rough) {
  probe(in, size, inverse, near, rough);
}
void probe_roots(const double* in, int size, double* inverse, double* near, double* rough) {
  probe(in, size, inverse, near, rough);
}

}  // namespace plenoflame::PLENOFLAME_ISA
