#pragma once
#include <limits>

/// Physical constants, SI. Exact since the revision of the SI of 2019 (BIPM, SI Brochure, 9th ed.).
namespace plenoflame::constants {

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double planck = 6.62607015e-34;    ///< h [J s]
inline constexpr double light_speed = 299792458.0;  ///< c [m/s]
inline constexpr double boltzmann = 1.380649e-23;   ///< k [J/K]
/// First radiation constant for radiance, 2 h c^2 [W m^2 / sr].
inline constexpr double first_radiation = 2.0 * planck * light_speed * light_speed;
/// Second radiation constant, h c / k [m K].
inline constexpr double second_radiation = planck * light_speed / boltzmann;
/// Stefan-Boltzmann constant, 2 pi^5 k^4 / (15 h^3 c^2) [W m^-2 K^-4].
inline constexpr double stefan_boltzmann =
    2.0 * pi * pi * pi * pi * pi * boltzmann * boltzmann * boltzmann * boltzmann /
    (15.0 * planck * planck * planck * light_speed * light_speed);

}  // namespace plenoflame::constants

namespace plenoflame {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace plenoflame
