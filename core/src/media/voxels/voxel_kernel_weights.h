// Weights of the light of an interval's two Gauss nodes at its front (docs/theory/emission.md).
// Included once per instruction set.
#pragma once

#include "math/kernel_exp.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

// The effect of an interval with two Gauss nodes: radiance = near * S(first node) + far * S(second
// node), and the light behind it is multiplied by `transmittance`.
template <class Real>
struct IntervalWeights {
  Real transmittance, near, far;
};

// sqrt(3)/2: half the interval over the distance between its nodes.
template <class Real>
constexpr Real kGradient = Real(0.86602540378443864676);

// @param tau0, tau1 half the interval's length times the absorption at either node, >= 0
template <class Real>
PLENOFLAME_INLINE IntervalWeights<Real> interval_weights(Real tau0, Real tau1) {
  const Real tau = tau0 + tau1;
  const auto transfer = linear_transfer(tau);
  const Real emissivity = transfer.near_weight + transfer.far_weight;
  const Real gradient = kGradient<Real> * (transfer.near_weight - transfer.far_weight);
  const Real smallest = sizeof(Real) == sizeof(float) ? Real(1e-37f) : Real(1e-300);
  const Real share = tau1 / greatest(tau, smallest);
  const Real far = clamp(emissivity * share - gradient, Real(0), emissivity);
  return {transfer.transmittance, emissivity - far, far};
}

// Optical thickness below which nothing is absorbed: its inverse is still a number.
template <class Real>
constexpr Real kClear = sizeof(Real) == sizeof(float) ? Real(1e-30f) : Real(1e-200);

// (1 - e^-tau) / tau: what gets out of a homogeneous stretch that emits evenly.
template <class Real>
PLENOFLAME_INLINE Real mean_transmittance(Real tau) {
  return tau > kClear<Real> ? attenuation(tau).emissivity / greatest(tau, kClear<Real>) : Real(1);
}

// Emission that does not belong to the absorption, with values at the two nodes [W/(m^3 sr)]:
// radiance = length * (near * first + far * second). Exact where absorption is constant and
// emission linear, and where both are in a constant ratio; of fourth order otherwise
// (docs/theory/emission.md).
template <class Real>
struct LineWeights {
  Real near, far;
};
template <class Real>
PLENOFLAME_INLINE LineWeights<Real> line_weights(Real tau0, Real tau1) {
  const Real tau = tau0 + tau1;
  const Real inverse = Real(1) / greatest(tau, kClear<Real>);
  const auto transfer = linear_transfer(tau);
  const Real mean =
      tau > kClear<Real> ? (transfer.near_weight + transfer.far_weight) * inverse : Real(1);
  const Real tilt =
      Real(2) * kGradient<Real> * (transfer.near_weight - transfer.far_weight) * inverse;
  const Real share = tau1 * inverse;  // of the absorption that is behind
  const Real far = greatest(Real(0.5) * mean - tilt * (Real(1) - share), Real(0));
  const Real both = greatest(mean + tilt * (Real(2) * share - Real(1)), Real(0));
  return {greatest(both - far, Real(0)), least(far, both)};
}

}  // namespace
}  // namespace plenoflame::PLENOFLAME_ISA
