#pragma once
#include <span>

#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Arrays for the coefficients at places of a ray.
struct CoefficientBatch {
  double* emission;     ///< [W/(m^3 sr)] channel c of place i at [i * channels + c]
  double* absorption;   ///< [1/m] likewise
  double* temperature;  ///< [K] of each place
};

/// An ability of media whose fields are stored by cells: coefficients at several places
/// of one cell, which is looked up once.
class CellSampling {
 public:
  static constexpr int kMostAtOnce = 8;
  /// Coefficients and temperature at places of a ray between the same two neighbouring breakpoints
  /// of Medium::append_breakpoints(). They equal those of Medium::coefficients(), absorptions() and
  /// sample() up to rounding.
  /// @param t places, ascending, at most kMostAtOnce
  /// @param channels how many, from the first on
  virtual void coefficients_between(const Ray& ray, std::span<const double> t, int channels,
                                    const CoefficientBatch& out) const = 0;

 protected:
  ~CellSampling() = default;
};

}  // namespace plenoflame
