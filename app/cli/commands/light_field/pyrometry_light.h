#pragma once
#include <cstddef>

#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame::cli {

/// A channel in proportion to power, without the dark signal: electrons per exposure time and
/// wavelength, flux as it is. The factor is the same for all channels of a light field.
/// @throws InputError for electrons without an exposure time
LightFieldChannel light_in_proportion(const LightField& field, const Scene& scene,
                                      std::size_t channel);

/// Makes pixels NaN whose well was full in either channel: they say nothing of a ratio.
/// @param light of the channels a and b of the field @return how many
std::size_t leave_out_saturated(const LightField& field, MosaicPattern mosaic, std::size_t a,
                                std::size_t b, LightFieldChannel light[2]);

}  // namespace plenoflame::cli
