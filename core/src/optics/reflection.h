#pragma once

namespace plenoflame {

/// A single layer on the surfaces that border on air.
struct AntiReflection {
  double index = 0;              ///< 0: none
  double quarter_wave = 550e-9;  ///< [m] wavelength of which it is a quarter thick
  double wavelength = 0;         ///< [m] of the light; 0: quarter_wave
};

/// A surface as its reflection knows it, in the order in which light passes.
struct Coating {
  double before = 1, layer = 1, behind = 1;  ///< indices; layer = before: none
  double phase = 0;                          ///< 4 thickness layer / wavelength
};

/// The layer between two media: it is there if one of them is air.
Coating coating_of(const AntiReflection& layer, double before, double behind);

/// Share of unpolarised light that passes, by Fresnel's formulas with complex amplitudes. Source:
/// Born and Wolf, Principles of Optics, 7th ed., 1.5.2 and 1.6.4. 0 for total reflection.
/// @param cos_in of the angle in the medium before
double surface_transmission(const Coating& coating, double cos_in);

/// Share that passes a plane plate in air: both faces once.
double plate_transmission(double index, double cos_in);

}  // namespace plenoflame
