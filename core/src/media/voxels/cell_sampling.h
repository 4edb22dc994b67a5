#pragma once
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// An ability of media whose fields are stored by cells: coefficients at several places
/// of one cell, which is looked up once.
class CellSampling {
 public:
  static constexpr int kMostAtOnce = 8;
  /// Coefficients and temperature at places of a ray between the same two neighbouring breakpoints
  /// of Medium::append_breakpoints(). They equal those of Medium::coefficients(), absorptions() and
  /// sample() up to rounding.
  /// @param t `count` places, ascending, at most kMostAtOnce
  /// @param channels how many, from the first on
  /// @param emission [W/(m^3 sr)] channel c of place i at [i * channels + c]
  /// @param absorption [1/m] likewise
  /// @param temperature [K] of each place
  virtual void coefficients_between(const Ray& ray, const double* t, int count, int channels,
                                    double* emission, double* absorption,
                                    double* temperature) const = 0;

 protected:
  ~CellSampling() = default;
};

}  // namespace plenoflame
