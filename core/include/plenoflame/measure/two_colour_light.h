#pragma once
#include <cstddef>

#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// A channel in proportion to power, without the dark signal: electrons and counts per exposure
/// time and wavelength, flux as it is. The factor is the same for all channels of a light field.
/// @throws InputError for electrons or counts without an exposure time
LightFieldChannel light_in_proportion(const LightField& field, const Scene& scene,
                                      std::size_t channel);

/// Pixels that have no part in a temperature.
struct LeftOutPixels {
  std::size_t saturated = 0;  ///< their well was full
  std::size_t defective = 0;  ///< of an imported picture
};

/// Makes pixels NaN that are defective or whose well was full in either channel: their ratio is
/// meaningless.
/// @param light of the channels a and b of the field
LeftOutPixels leave_out_bad_pixels(const LightField& field, MosaicPattern mosaic, std::size_t a,
                                   std::size_t b, LightFieldChannel light[2]);

}  // namespace plenoflame
