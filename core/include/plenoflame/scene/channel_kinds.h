#pragma once
#include <optional>
#include <string>

#include "plenoflame/radiometry/spectral_response.h"
#include "plenoflame/scene/channel_spec.h"

namespace plenoflame {

/// The weight that a channel gives to wavelengths, without regard to whether it counts photons;
/// nullopt for one that weighs all alike. @throws InputError for a response that does not exist
std::optional<SpectralResponse> response_of_kind(const ChannelSpec& channel);

/// The wavelength that stands for a channel where only one can [m, vacuum]: the centre of a band or
/// of a line filter. 0: none does. Indices of glasses, exported rays and the design are told for
/// it.
double own_wavelength(const ChannelSpec& channel);

/// The band of a channel, for people: "10 nm around 650 nm".
std::string describe_channel(const ChannelSpec& channel);

}  // namespace plenoflame
