// Source functions and the radiance of one interval, for the voxel kernels
// (docs/theory/emission.md). Included once per instruction set.
#pragma once

#include "math/kernel_exp.h"
#include "media/voxels/voxel_kernel.h"
#include "media/voxels/voxel_kernel_weights.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

// Temperatures whose source function is evaluated together: two nodes in every lane.
constexpr int kSources = 2 * voxel::kLanes;

// The variable of the fits of all channels: 1/T - 1/hottest [1/K], endless at 0 K. The differences
// first: near the hottest the inverses are nearly equal.
template <class Real>
PLENOFLAME_INLINE void inverse_above(Real hottest, const Real* __restrict temperature,
                                     Real* __restrict out) {
#pragma omp simd
  for (int l = 0; l < kSources; ++l) {
    const Real t = clamp(temperature[l], Real(0), hottest);
    out[l] = (hottest - t) / (t * hottest);
  }
}

// Planck's e / (1 - x), x = occupation * e. It is replaced by its series if x^3 is below single
// precision. The product x may be denormal, so the series uses 1 + x (a fused multiply-add where
// the processor has one).
constexpr float kDilute = 0x1p-9f;
template <bool dilute, class Real>
PLENOFLAME_INLINE Real with_stimulated(Real e, Real occupation) {
  if (!dilute) return e / (Real(1) - occupation * e);
  const Real y = Real(1) + occupation * e;
  return e * (Real(1) + y * (y - Real(1)));
}

// The fit of a source function (source_fit.h) with a fixed number of terms; those beyond
// source.fit_terms are 0. @param above of inverse_above()
template <int kTerms, bool dilute, class Real>
PLENOFLAME_INLINE void fitted_source(const voxel::SourceView<Real>& source,
                                     const Real* __restrict above, Real* __restrict out) {
  const Real last = source.last, scale = source.scale, occupation = source.occupation;
  Real term[kTerms];
  for (int k = 0; k < kTerms; ++k) term[k] = source.fit[voxel::kMaxFitTerms - kTerms + k];
#pragma omp simd
  for (int l = 0; l < kSources; ++l) {
    const Real v = least(above[l], last);
    Real p = term[0];
#pragma GCC unroll 16
    for (int k = 1; k < kTerms; ++k) p = p * v + term[k];
    out[l] = scale * with_stimulated<dilute>(exponential(p * v), occupation);
  }
}

// The same with two polynomials, of which each temperature takes one.
template <bool dilute, class Real>
PLENOFLAME_INLINE void fitted_in_two(const voxel::SourceView<Real>& source,
                                     const Real* __restrict above, Real* __restrict out) {
  constexpr int kTerms = voxel::kTermsOfTwo;
  const Real last = source.last, scale = source.scale, occupation = source.occupation,
             split = source.split, at_split = source.at_split;
  Real near[kTerms], far[kTerms];
  for (int k = 0; k < kTerms; ++k) {
    near[k] = source.fit[voxel::kMaxFitTerms - kTerms + k];
    far[k] = source.far_fit[voxel::kMaxFitTerms - kTerms + k];
  }
#pragma omp simd
  for (int l = 0; l < kSources; ++l) {
    const Real v = least(above[l], last);
    const bool beyond = v > split;
    const Real u = v - (beyond ? split : Real(0));
    Real p = beyond ? far[0] : near[0];
#pragma GCC unroll 16
    for (int k = 1; k < kTerms; ++k) p = p * u + (beyond ? far[k] : near[k]);
    const Real e = exponential((beyond ? at_split : Real(0)) + p * u);
    out[l] = scale * with_stimulated<dilute>(e, occupation);
  }
}

template <bool dilute, class Real>
PLENOFLAME_INLINE void fitted(const voxel::SourceView<Real>& source, const Real* __restrict above,
                              Real* __restrict out) {
  if (source.split_terms > 0)
    fitted_in_two<dilute>(source, above, out);
  else if (source.fit_terms <= 3)
    fitted_source<3, dilute>(source, above, out);
  else if (source.fit_terms <= 6)
    fitted_source<6, dilute>(source, above, out);
  else
    fitted_source<voxel::kMaxFitTerms, dilute>(source, above, out);
}

// @param above of the temperatures, by inverse_above(); read where there is a fit
template <class Real>
PLENOFLAME_INLINE void source_of(const voxel::SourceView<Real>& source,
                                 const Real* __restrict temperature, const Real* __restrict above,
                                 Real* __restrict out) {
  if (source.count == 0) {
#pragma omp simd
    for (int l = 0; l < kSources; ++l) out[l] = total_radiance(temperature[l]);
  } else if (source.fit_terms == 0) {
    const SourceTable<Real> table{source.exponents, source.weights, source.count};
    evaluate_source(table, temperature, out, kSources);
  } else if (source.occupation <= Real(kDilute)) {
    fitted<true>(source, above, out);
  } else {
    fitted<false>(source, above, out);
  }
}

// interval_weights() for tau0 + tau1 <= kThin, without exponentials or divisions. psi = (1 -
// e^-tau)/tau and (near - far weight)/tau^2 of the linear transfer are series. Their first
// neglected terms are below 1e-8 (float).
constexpr float kThin = 0.125f;
PLENOFLAME_INLINE IntervalWeights<float> thin_interval_weights(float tau0, float tau1) {
  const float tau = tau0 + tau1;
  const float psi =
      1.0f + tau * (-0.5f + tau * (1.0f / 6 + tau * (-1.0f / 24 + tau * (1.0f / 120 - tau / 720))));
  const float emissivity = tau * psi;
  const float difference =
      tau * tau * (1.0f / 6 + tau * (-1.0f / 12 + tau * (1.0f / 40 - tau * (1.0f / 180))));
  const float far = greatest(tau1 * psi - kGradient<float> * difference, 0.0f);
  return {1.0f - emissivity, greatest(emissivity - far, 0.0f), far};
}

// One interval of every lane for a channel whose absorption is `factor` times that of `tau`. The
// product with `passed` comes first: the product of a thin gas and a cold source may be denormal.
template <class Real>
PLENOFLAME_INLINE void pass_interval(Real factor, bool thin, const Real (&tau)[2][voxel::kLanes],
                                     const Real* __restrict source, Real* __restrict radiance,
                                     Real* __restrict passed) {
  if (thin) {
#pragma omp simd
    for (int l = 0; l < voxel::kLanes; ++l) {
      const auto w = thin_interval_weights(static_cast<float>(factor * tau[0][l]),
                                           static_cast<float>(factor * tau[1][l]));
      radiance[l] +=
          (passed[l] * w.near) * source[l] + (passed[l] * w.far) * source[voxel::kLanes + l];
      passed[l] *= w.transmittance;
    }
  } else {
#pragma omp simd
    for (int l = 0; l < voxel::kLanes; ++l) {
      const auto w = interval_weights(factor * tau[0][l], factor * tau[1][l]);
      radiance[l] +=
          (passed[l] * w.near) * source[l] + (passed[l] * w.far) * source[voxel::kLanes + l];
      passed[l] *= w.transmittance;
    }
  }
}

}  // namespace
}  // namespace plenoflame::PLENOFLAME_ISA
