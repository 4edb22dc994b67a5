#pragma once
#include <string>

/// Channels as plain values (scene.h).
namespace plenoflame {

enum class ChannelKind {
  total,  ///< all wavelengths: source function sigma T^4 / pi
  band,   ///< `width` around `wavelength`: the Planck function integrated over the band
  line,   ///< a line filter: Gaussian around `wavelength`, `width` at half its maximum
  curve,  ///< points of a response
  named,  ///< a response that is known by a name
};

struct ChannelSpec {
  std::string name = "total";
  ChannelKind kind = ChannelKind::total;
  double wavelength = 0;      ///< [m] centre, vacuum
  double width = 0;           ///< [m] full width
  std::string response = {};  ///< named
  std::string file = {};      ///< curve: CSV file, relative to the scene file
  std::string curve = {};     ///< curve: "450 nm 0.2, 460 nm 0.35, ..."; from the file when empty
  /// The response is a quantum efficiency: it counts photons, and light counts in proportion to its
  /// wavelength.
  bool photons = false;
  int wavelengths = 1;  ///< at least, that represent it if glasses are dispersive
  friend bool operator==(const ChannelSpec&, const ChannelSpec&) = default;
};

}  // namespace plenoflame
