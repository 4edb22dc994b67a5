#pragma once
#include <vector>

#include "plenoflame/radiometry/spectral_response.h"

namespace plenoflame {

/// Points with weights > 0: a measure, or a quadrature rule for one.
struct MeasurePoints {
  std::vector<double> places, weights;
};

/// The response as a measure of the wavenumber s = 1 / lambda, R(s) ds: Gauss-Legendre points
/// between the response's breakpoints, `order` in every stretch of at most a twentieth of its
/// wavenumber. Places [1/m].
MeasurePoints wavenumber_points(const SpectralResponse& response, int order);

/// The Gauss rule of a measure: `count` points and weights, exact for polynomials up to degree 2
/// count - 1. Its Jacobi matrix by Lanczos' method with full reorthogonalisation (Gautschi,
/// Orthogonal Polynomials, 2004, 2.2.3), the rule by Golub and Welsch, Math. Comp. 23 (1969) 221.
/// @param count at least 1, below the number of points
MeasurePoints gauss_rule(const MeasurePoints& measure, int count);

}  // namespace plenoflame
