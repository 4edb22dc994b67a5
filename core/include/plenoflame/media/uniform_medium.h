#pragma once
#include <memory>

#include "plenoflame/media/medium.h"

namespace plenoflame {

/// The same radiance everywhere and in every direction, for white images: every ray that leaves the
/// camera sees it.
/// @param radiance [W/(m^2 sr)], in each of `channels` channels
std::unique_ptr<Medium> make_uniform_medium(double radiance, int channels);

}  // namespace plenoflame
