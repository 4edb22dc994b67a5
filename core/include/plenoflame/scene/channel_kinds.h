#pragma once
#include <optional>
#include <string>

#include "plenoflame/radiometry/spectral_response.h"
#include "plenoflame/scene/channel_spec.h"

namespace plenoflame {

/// The weight that a channel gives to wavelengths, whether or not it counts photons; nullopt for
/// one with equal weights.
/// @throws InputError for a response that does not exist
std::optional<SpectralResponse> response_of_kind(const ChannelSpec& channel);

/// The wavelength that represents a channel where only one can be used [m, vacuum]: the centre of a
/// band or of a line filter. Glass indices, exported rays and the design use it. 0: there is none.
double own_wavelength(const ChannelSpec& channel);

/// The band of a channel, for people: "10 nm around 650 nm".
std::string describe_channel(const ChannelSpec& channel);

}  // namespace plenoflame
