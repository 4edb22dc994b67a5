#pragma once
#include <span>
#include <string>
#include <string_view>

namespace plenoflame {

/// Wavelength at which a lens is designed where nothing else is said: the helium d line [m].
inline constexpr double kLineD = 587.5618e-9;
inline constexpr double kLineF = 486.1327e-9;  ///< hydrogen
inline constexpr double kLineC = 656.2725e-9;  ///< hydrogen

/// A dispersive optical material. Indices are relative to air, as catalogues give them, but for
/// fluorite and fused silica, whose published formulas are the ones that catalogues use too.
class Glass {
 public:
  /// @param text "NAME" of the catalogue, e.g. "N-BK7"; "sellmeier B1 B2 B3 C1 C2 C3", the C in
  ///        um^2; or "constant n". Also "abbe nd vd": the index at the d line and the Abbe number,
  ///        by n = A + B / wavelength^2
  /// @throws InputError naming the nearest glass of the catalogue
  explicit Glass(std::string_view text);

  /// Refractive index at a vacuum wavelength [m]. Source: Sellmeier, Ann. Phys. 219 (1871), 272.
  /// @throws InputError where the formula has no value (at a resonance, or below)
  double index(double wavelength) const;

 private:
  enum class Kind { constant, cauchy, sellmeier };
  Kind kind_ = Kind::constant;
  double values_[6] = {1, 0, 0, 0, 0, 0};
};

/// A row of the catalogue: coefficients as its maker publishes them, and the figures that
/// the same sheet prints, which check them.
struct CatalogueGlass {
  std::string_view name;
  double b[3], c[3];  ///< c [um^2]
  double range[2];    ///< [um] for which they are published
  double nd, vd;      ///< as printed, to 5 and 2 decimals
  std::string_view source;
};
std::span<const CatalogueGlass> glass_catalogue();
/// The row that a scene's text names, by its name or another one that it has; nullptr: none.
const CatalogueGlass* find_catalogue_glass(std::string_view text);

}  // namespace plenoflame
