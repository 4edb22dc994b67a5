#pragma once
#include <cstddef>
#include <vector>

#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// Share of a channel's light that each part of the stop lets through, of PupilFilters::parts();
/// without filters the one part lets all through. A filter cuts out wavelengths, so that its share
/// depends on the light: that of a thin flame of 1700 K, or, where the scene's flames have emission
/// lines that the channel sees, of these lines, all equally bright.
/// @throws InputError as camera_response
std::vector<double> pupil_transmission(const Scene& scene, std::size_t channel);

}  // namespace plenoflame
