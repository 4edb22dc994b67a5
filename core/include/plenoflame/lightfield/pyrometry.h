#pragma once
#include <cstddef>

#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/pixel_bins.h"
#include "plenoflame/radiometry/two_colour.h"

namespace plenoflame {

struct PyrometrySettings {
  /// Bins whose mean is below this share of the largest, in either channel, have no temperature.
  double threshold = 0.01;
  /// Bins with light below this number of standard errors have no temperature. A ratio's error is
  /// proportional to the errors of its parts only while these are small. Otherwise noise would
  /// select bins.
  double least_signal_to_noise = 2;
};

/// Temperatures from two channels, of pixels or of bins of them.
struct TemperatureMap {
  Image temperature;       ///< [K] in every pixel that counted for its bin; 0: none
  Image standard_error;    ///< [K] of the bin, by the channels' own; empty without them
  std::size_t pixels = 0;  ///< with a temperature
  std::size_t bins = 0;    ///< with one; all below is over these
  double mean = 0, deviation = 0, lowest = 0, highest = 0;  ///< [K]
  double expected_deviation = 0;  ///< [K] RMS of the bins' standard errors; 0: not known
};

/// A bin's temperature follows from the ratio of its pixels' sums; the squares of its pixels'
/// standard errors add up. Pixels that are not numbers do not count.
/// @param first, second in the order of the law's channels
/// @param bins of all pixels; nullptr: each pixel alone
/// @throws InputError: images of different sizes, nothing lit
TemperatureMap two_colour_map(const LightFieldChannel& first, const LightFieldChannel& second,
                              const TwoColour& law, const PyrometrySettings& settings = {},
                              const PixelBins* bins = nullptr);

}  // namespace plenoflame
