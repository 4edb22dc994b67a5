#pragma once
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// Tables of a camera whose main lens is not round. The shape of its pupil, as a microlens sees it,
/// is unknown. Rays are therefore drawn over the whole aperture of the microlens. Only the reach of
/// micro-images is determined, by rays in all directions around the axis.
std::vector<PupilTable> explored_tables(const Camera& camera, const Execution& execution);

}  // namespace plenoflame
