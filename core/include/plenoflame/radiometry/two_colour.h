#pragma once
#include "plenoflame/radiometry/absorption_spectrum.h"
#include "plenoflame/radiometry/source_function.h"

namespace plenoflame {

/// Temperature from the ratio of two channels' light, L1 / L2, of a thin isothermal body whose
/// absorption follows a law: F_i(T) = integral of R_i(lambda) kappa(lambda) B(lambda, T). With a
/// grey law, of a body of any thickness (ratio pyrometry; docs/radiometry.md).
class TwoColour {
 public:
  /// @throws InputError for a channel of all wavelengths, or channels of the same colour
  TwoColour(const SpectralResponse& first, const SpectralResponse& second,
            const AbsorptionSpectrum& law);

  /// ln(F_1 / F_2).
  double log_ratio(double temperature) const;
  /// d ln(F_1 / F_2) / dT [1/K].
  double slope(double temperature) const;
  /// [K] between kColdest and kHottest; NaN for a ratio that none of them has.
  double temperature(double ratio) const;

  static constexpr double kColdest = 300, kHottest = 1e4;

 private:
  SourceFunction first_, second_;
  double sign_ = 1;  ///< of the slope
};

}  // namespace plenoflame
