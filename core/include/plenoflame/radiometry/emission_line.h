#pragma once
#include <optional>
#include <string_view>
#include <vector>

#include "plenoflame/radiometry/spectral_response.h"

namespace plenoflame {

/// Light that a gas radiates at certain wavelengths only, out of thermal equilibrium:
/// chemiluminescence of radicals, atomic lines. All of its light is within its components.
class EmissionLine {
 public:
  /// One of named_lines(); the words of the scene file. @param width as below
  /// @throws InputError listing them
  static EmissionLine named(std::string_view name, double width = 0);
  /// @param wavelength [m] vacuum
  /// @param width [m] full, at half the maximum, of a Gaussian profile; 0: narrow against whatever
  ///        a channel's response does
  /// @throws InputError unless 0 <= width < wavelength / 4
  static EmissionLine at(double wavelength, double width = 0);

  /// Mean over its light [m].
  double wavelength() const;
  double width() const { return width_; }
  /// Share of its light that a channel counts: the response at the line, or averaged over its
  /// profile. @param response nothing: all wavelengths, 1
  double seen_by(const std::optional<SpectralResponse>& response) const;

  friend bool operator==(const EmissionLine&, const EmissionLine&) = default;

 private:
  struct Component {
    double wavelength;  ///< [m]
    double share;       ///< of its light; all together 1
    friend bool operator==(const Component&, const Component&) = default;
  };
  std::vector<Component> components_;
  double width_ = 0;
};

/// A line that has a name, and where its wavelength comes from.
struct NamedLine {
  std::string_view name, what, source;
};
std::vector<NamedLine> named_lines();

/// The emission that a unit stands for [W/m^3, into all directions]: "W/m^3", "kW/m^3", "W/cm^3",
/// "W/mm^3" into all directions, "W/(m^3 sr)", "W/(cm^3 sr)" into each, and "1/(m^3 s)",
/// "1/(cm^3 s)", "mol/(m^3 s)" photons; regardless of case. Nothing for any other text.
/// @param wavelength [m] of the photons
std::optional<double> emission_unit(std::string_view unit, double wavelength);
/// The units that emission_unit() knows, for messages.
std::string_view emission_unit_list();

}  // namespace plenoflame
