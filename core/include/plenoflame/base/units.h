#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace plenoflame {

/// The dimension of a quantity in a file; decides which units it may carry.
enum class Dimension {
  none,               ///< a pure number, written without a unit; "%" is accepted and divides by 100
  length,             ///< m
  temperature,        ///< K ("degC" is accepted and shifted)
  absorption,         ///< 1/m
  angle,              ///< rad (files: "deg", "rad", "mrad")
  flux,               ///< W
  time,               ///< s
  radiance,           ///< W/(m^2 sr)
  spectral_radiance,  ///< W/(m^3 sr)
  irradiance,         ///< W/m^2
  frequency,          ///< Hz
};

/// SI unit in which values of this dimension are kept, as text, e.g. "1/m"; empty for none.
std::string_view si_unit(Dimension dimension);

/// All unit names that parse_quantity accepts for this dimension, SI unit first.
std::vector<std::string> accepted_units(Dimension dimension);

/// Reads "0.1 mm", "1650 K", "30 1/m", "inf" to SI. The number may stand without a blank before
/// the unit. A missing unit (except for Dimension::none) or a wrong one throws InputError whose
/// message names the accepted units. NaN is refused; "inf" is accepted for lengths only.
double parse_quantity(std::string_view text, Dimension dimension);

/// Writes a value with the unit that makes it readable ("100 um", "1.2 m"); parse_quantity gives
/// back the same double, bit for bit.
std::string format_quantity(double value, Dimension dimension);

/// The same rounded to a few significant digits, for messages; "nan" and "inf" are possible.
std::string readable_quantity(double value, Dimension dimension, int digits = 4);

}  // namespace plenoflame
