// Runs the functions of math/kernel_exp.h over arrays, once per instruction set.
#include "math/kernel_exp.h"

namespace plenoflame::PLENOFLAME_ISA {

template <class Real>
PLENOFLAME_INLINE void probe(const Real* in, int size, Real* exp_out, Real* expm1_out,
                             Real* transmittance, Real* emissivity, Real* far_weight,
                             Real* near_weight) {
  for (int i = 0; i < size; ++i) exp_out[i] = exponential(in[i]);
  for (int i = 0; i < size; ++i) expm1_out[i] = exponential_minus_one(in[i]);
  for (int i = 0; i < size; ++i) {
    const Attenuation<Real> a = attenuation(in[i]);
    transmittance[i] = a.transmittance;
    emissivity[i] = a.emissivity;
  }
  for (int i = 0; i < size; ++i) {
    const LinearTransfer<Real> w = linear_transfer(in[i]);
    far_weight[i] = w.far_weight;
    near_weight[i] = w.near_weight;
  }
}

void probe_exp_float(const float* in, int size, float* a, float* b, float* c, float* d, float* e,
                     float* f) {
  probe(in, size, a, b, c, d, e, f);
}
void probe_exp_double(const double* in, int size, double* a, double* b, double* c, double* d,
                      double* e, double* f) {
  probe(in, size, a, b, c, d, e, f);
}
template <class Real>
PLENOFLAME_INLINE void probe_halvings(const Real* in, int size, Real* transmittance,
                                      Real* emissivity) {
  for (int i = 0; i < size; ++i) {
    const Attenuation<Real> a = attenuation_of_halvings(in[i]);
    transmittance[i] = a.transmittance;
    emissivity[i] = a.emissivity;
  }
}
void probe_halvings_float(const float* in, int size, float* a, float* b) {
  probe_halvings(in, size, a, b);
}
void probe_halvings_double(const double* in, int size, double* a, double* b) {
  probe_halvings(in, size, a, b);
}
// Parts of it alone, for the benchmarks.
void bench_exp(const float* __restrict in, int size, float* __restrict out) {
  for (int i = 0; i < size; ++i) out[i] = exponential(in[i]);
}
void bench_attenuation(const float* __restrict in, int size, float* __restrict transmittance,
                       float* __restrict emissivity) {
  for (int i = 0; i < size; ++i) {
    const Attenuation<float> a = attenuation(in[i]);
    transmittance[i] = a.transmittance;
    emissivity[i] = a.emissivity;
  }
}
void bench_linear_transfer(const float* __restrict in, int size, float* __restrict transmittance,
                           float* __restrict far_weight, float* __restrict near_weight) {
  for (int i = 0; i < size; ++i) {
    const LinearTransfer<float> w = linear_transfer(in[i]);
    transmittance[i] = w.transmittance;
    far_weight[i] = w.far_weight;
    near_weight[i] = w.near_weight;
  }
}

void probe_source_float(const float* exponents, const float* weights, int count, const float* t,
                        float* out, int size) {
  evaluate_source(SourceTable<float>{exponents, weights, count}, t, out, size);
}
void probe_source_double(const double* exponents, const double* weights, int count, const double* t,
                         double* out, int size) {
  evaluate_source(SourceTable<double>{exponents, weights, count}, t, out, size);
}

}  // namespace plenoflame::PLENOFLAME_ISA
