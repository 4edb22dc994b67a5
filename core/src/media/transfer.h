#pragma once
#include <functional>
#include <vector>

#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Absorption [1/m] at a place t [m] of a ray; writes the emission per channel [W/(m^3 sr)].
using RayCoefficients = std::function<double(double t, double* emission)>;

struct TransferResult {
  std::vector<double> radiance;  ///< per channel, at the near end [W/(m^2 sr)]
  double optical_thickness = 0;
};

/// Integrates dL/dt = -kappa L + j over [limits.front(), limits.back()], light travelling towards
/// the front. Adaptive Gauss-Kronrod (7, 15) with bisection, front to back. The optical thickness
/// in front of each node is the integral of the absorption's interpolating polynomial. Emission
/// behind an optical thickness of 100 is left out (a factor of 4e-44).
/// @param limits ascending; the coefficients are smooth between neighbours
/// @param tolerance relative, per interval; emission has no sign, so it holds for the sum as well
TransferResult integrate_transfer(const RayCoefficients& coefficients, int channels,
                                  const std::vector<double>& limits, double tolerance);

}  // namespace plenoflame
