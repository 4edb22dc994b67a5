#pragma once
#include <complex>
#include <vector>

#include "plenoflame/radiometry/spectral_response.h"

namespace plenoflame {

/// From where the complex refractive index of soot comes.
enum class SootIndex {
  constant,  ///< E(m) is the same at all wavelengths
  chang,     ///< Chang and Charalampopoulos, Proc. R. Soc. A 430 (1990) 577: 0.4 to 30 um
  dalzell,   ///< Dalzell and Sarofim, J. Heat Transfer 91 (1969) 100, acetylene: 436 to 806 nm
};

/// m = n - ik of soot at a wavelength [m]; chang or dalzell. Dalzell's four values are joined by
/// straight lines. @throws InputError outside of the range of the measurements
std::complex<double> soot_refractive_index(SootIndex source, double wavelength);

/// Absorption function E(m) = -Im((m^2 - 1)/(m^2 + 2)).
double soot_absorption_function(std::complex<double> index);

/// The dependence of an absorption coefficient on wavelength: kappa(lambda) = kappa(reference) *
/// factor(lambda).
class AbsorptionSpectrum {
 public:
  /// The same at all wavelengths.
  AbsorptionSpectrum() = default;
  /// (reference / lambda)^exponent.
  static AbsorptionSpectrum power(double reference, double exponent);
  /// Rayleigh limit, kappa = 6 pi E(m) f_v / lambda. Source: Bohren and Huffman, Absorption and
  /// Scattering of Light by Small Particles, ch. 5.
  /// @param absorption_function E(m) of SootIndex::constant
  static AbsorptionSpectrum soot(double reference, SootIndex index, double absorption_function);
  /// Straight lines between the points; the ends hold beyond them. Values are relative: only their
  /// ratio to the one at the reference matters. @throws InputError when that is 0
  static AbsorptionSpectrum table(double reference, std::vector<SpectralPoint> points);

  bool is_grey() const { return kind_ == Kind::grey; }
  /// kappa(wavelength) / kappa(reference). @throws InputError as soot_refractive_index
  double factor(double wavelength) const;
  /// Wavelengths at which factor() is not smooth [m]: the points of a table, or of measurements.
  std::vector<double> breakpoints() const;
  /// kappa(reference) [1/m] of a soot volume fraction of 1; 0 unless this is soot.
  double per_volume_fraction() const;

 private:
  enum class Kind { grey, power, soot, table };
  double absolute(double wavelength) const;
  Kind kind_ = Kind::grey;
  double reference_ = 0, exponent_ = 1, absorption_function_ = 0;
  SootIndex index_ = SootIndex::constant;
  std::vector<SpectralPoint> points_;
};

}  // namespace plenoflame
