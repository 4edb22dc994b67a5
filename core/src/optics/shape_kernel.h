// Shapes of lens surfaces other than planes and spheres, in the form of the kernels. A shape has
// its numbers, and the sag and its slopes at a place. Rays find such a surface by Newton's method
// (surface_kernel.h). Coordinates are relative to the vertex, z along the propagation.
#pragma once
#include "math/kernel_math.h"

namespace plenoflame {

enum class ShapeKind : int {
  sphere,  ///< or a plane: met in closed form, without any of this
  even_asphere,
  biconic,
};

inline constexpr int kAsphericTerms = 7;  ///< h^4 to h^16
inline constexpr int kShapeSteps = 8;     ///< of Newton's method

/// A conic with even aspheric terms. Heights count in units of the rim's height: coefficients per
/// metre to the 15th would leave the range of single precision.
template <class Real>
struct KernelEvenAsphere {
  Real curvature;        ///< as that of KernelSurface
  Real conic;            ///< 0: sphere, -1: paraboloid
  Real inverse_height2;  ///< 1 / (height of the rim)^2
  /// Sag along the direction of propagation [m]: terms[i] * (h / rim)^(4 + 2 i).
  Real terms[kAsphericTerms];
};

/// A conic with curvatures of its own along x and y.
template <class Real>
struct KernelBiconic {
  Real curvature_x, curvature_y;  ///< signs as that of KernelSurface
  Real conic_x, conic_y;
  Real inverse_height2;  ///< 1 / (height of the rim)^2
};

/// The shape of one surface. A union: kernels hold many of them, and each has one kind.
template <class Real>
struct KernelShape {
  ShapeKind kind;
  union {
    KernelEvenAsphere<Real> even_asphere;
    KernelBiconic<Real> biconic;
  };
};

namespace PLENOFLAME_ISA {

/// A place of a rotationally symmetric surface.
template <class Real>
struct RoundPlace {
  Real x, y;
  Real sag;
  Real slope;   ///< d sag / d(h^2)
  Real inside;  ///< under the conic's root: above 0 where the conic is
  /// Slope of the sag along a direction.
  Real rise(Real dx, Real dy) const { return Real(2) * slope * (x * dx + y * dy); }
  Real slope_x() const { return Real(2) * slope * x; }
  Real slope_y() const { return Real(2) * slope * y; }
};

/// sag(h^2) = c h^2 / (1 + sqrt(1 - (1 + k) c^2 h^2)) + sum of terms[i] (h / rim)^(4 + 2 i)
template <class Real>
PLENOFLAME_INLINE RoundPlace<Real> place_on(const KernelEvenAsphere<Real>& shape, Real x, Real y) {
  const Real c = shape.curvature, h2 = x * x + y * y;
  const Real inside = Real(1) - (Real(1) + shape.conic) * c * c * h2;
  const Real root = square_root(greatest(inside, Real(1e-6)));
  const Real v = h2 * shape.inverse_height2;
  Real sum = Real(0), derivative = Real(0);
#pragma GCC unroll 7
  for (int i = kAsphericTerms - 1; i >= 0; --i) {
    derivative = derivative * v + Real(i + 2) * shape.terms[i];
    sum = sum * v + shape.terms[i];
  }
  const Real slope = derivative * v * shape.inverse_height2 + Real(0.5) * c / root;
  const Real sag = sum * v * v + c / (Real(1) + root) * h2;
  return {x, y, sag, slope, inside};
}

/// A place of a surface of any shape.
template <class Real>
struct SlopedPlace {
  Real sag;
  Real along_x, along_y;  ///< slopes of the sag
  Real inside;            ///< under the root: above 0 where the surface is
  Real rise(Real dx, Real dy) const { return along_x * dx + along_y * dy; }
  Real slope_x() const { return along_x; }
  Real slope_y() const { return along_y; }
};

/// sag = N / (1 + W), N = c_x x^2 + c_y y^2, W^2 = 1 - (1 + k_x) c_x^2 x^2 - (1 + k_y) c_y^2 y^2
template <class Real>
PLENOFLAME_INLINE SlopedPlace<Real> place_on(const KernelBiconic<Real>& shape, Real x, Real y) {
  const Real ax = shape.curvature_x * x, ay = shape.curvature_y * y;
  const Real bx = (Real(1) + shape.conic_x) * shape.curvature_x * ax,
             by = (Real(1) + shape.conic_y) * shape.curvature_y * ay;
  const Real inside = Real(1) - (bx * x + by * y);
  const Real root = square_root(greatest(inside, Real(1e-6)));
  const Real inverse = Real(1) / (Real(1) + root);
  const Real sag = (ax * x + ay * y) * inverse, per_root = sag / root;
  return {sag, (Real(2) * ax + per_root * bx) * inverse, (Real(2) * ay + per_root * by) * inverse,
          inside};
}

/// Calls a function with the numbers of the shape's own kind.
template <class Real, class Function>
PLENOFLAME_INLINE void with_shape(const KernelShape<Real>& shape, Function function) {
  switch (shape.kind) {
    case ShapeKind::sphere:
      break;
    case ShapeKind::even_asphere:
      function(shape.even_asphere);
      break;
    case ShapeKind::biconic:
      function(shape.biconic);
      break;
  }
}

}  // namespace PLENOFLAME_ISA
}  // namespace plenoflame
