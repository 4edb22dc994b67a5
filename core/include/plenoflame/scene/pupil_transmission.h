#pragma once
#include <cstddef>
#include <vector>

#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// Share of a channel's light that each part of the stop (PupilFilters::parts()) transmits. Without
/// filters the only part transmits all light. A filter removes wavelengths, so its share depends on
/// the light. The light is that of a thin flame of 1700 K. If the scene's flames have emission
/// lines that the channel sees, it is that of these lines, all equally bright.
/// @throws InputError as camera_response
std::vector<double> pupil_transmission(const Scene& scene, std::size_t channel);

}  // namespace plenoflame
