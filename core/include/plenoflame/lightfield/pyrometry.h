#pragma once
#include <cstddef>

#include "plenoflame/image/light_field.h"
#include "plenoflame/radiometry/two_colour.h"

namespace plenoflame {

struct PyrometrySettings {
  /// Pixels below this share of the largest value, in either channel, have no temperature.
  double threshold = 0.01;
};

/// Temperatures per pixel from two channels.
struct TemperatureMap {
  Image temperature;     ///< [K]; 0: none
  Image standard_error;  ///< [K] by the channels' own; empty without them
  std::size_t pixels = 0;
  double mean = 0, deviation = 0, lowest = 0, highest = 0;  ///< [K] over the pixels
  double expected_deviation = 0;  ///< [K] RMS of standard_error; 0: not known
};

/// @param first, second in the order of the law's channels @throws InputError: images of different
/// sizes, nothing lit
TemperatureMap two_colour_map(const LightFieldChannel& first, const LightFieldChannel& second,
                              const TwoColour& law, const PyrometrySettings& settings = {});

}  // namespace plenoflame
