// Reflection by surfaces, for the camera's vector kernels. Included once per instruction set.
#pragma once

#include "math/kernel_math.h"
#include "optics/kernel_types.h"

namespace plenoflame::PLENOFLAME_ISA {

/// cos(pi x) for 0 <= x < 1e4: sin^2 of half the angle, by its Taylor series to the 13th power.
template <class Real>
PLENOFLAME_INLINE Real cos_half_turns(Real x) {
  const Real whole = static_cast<Real>(static_cast<int>(Real(0.5) * x + Real(0.5)));
  const Real h = Real(1.57079632679489662) * (x - Real(2) * whole), h2 = h * h;
  const Real sine =
      h * (Real(1) +
           h2 * (Real(-1.0 / 6) +
                 h2 * (Real(1.0 / 120) +
                       h2 * (Real(-1.0 / 5040) +
                             h2 * (Real(1.0 / 362880) + h2 * (Real(-1.0 / 39916800) +
                                                              h2 * Real(1.0 / 6227020800.0)))))));
  return Real(1) - Real(2) * sine * sine;
}

/// Share of unpolarised light that a surface with a single layer transmits. Source: Born and Wolf,
/// Principles of Optics, 7th ed., 1.5.2 and 1.6.4, in real numbers. Never called for total
/// reflection. @param cos_in, cos_out of the angles before and behind
template <class Real>
PLENOFLAME_INLINE Real transmission(const KernelCoating<Real>& c, Real cos_in, Real cos_out) {
  const Real ratio = c.before / c.layer;
  const Real cos_layer =
      square_root(greatest(Real(1) - ratio * ratio * (Real(1) - cos_in * cos_in), Real(0)));
  const Real interference = Real(2) * cos_half_turns(c.phase * cos_layer);
  Real reflected = Real(0);
  for (int p = 0; p < 2; ++p) {
    // Perpendicular, then parallel to the plane of incidence.
    const Real a = p ? c.layer * cos_in : c.before * cos_in;
    const Real b = p ? c.before * cos_layer : c.layer * cos_layer;
    const Real d = p ? c.behind * cos_layer : c.layer * cos_layer;
    const Real e = p ? c.layer * cos_out : c.behind * cos_out;
    const Real first = (a - b) / (a + b), second = (d - e) / (d + e);
    const Real both = first * second;
    reflected += (first * first + second * second + both * interference) /
                 (Real(1) + both * both + both * interference);
  }
  return Real(1) - Real(0.5) * reflected;
}

}  // namespace plenoflame::PLENOFLAME_ISA
