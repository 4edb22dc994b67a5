#pragma once
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// Tables of a camera whose main lens is not round: nothing is known of the shape of its pupil as a
/// microlens sees it, so that rays are drawn over the whole aperture of the microlens. Only how far
/// micro-images reach is looked for, by rays in all directions around the axis.
std::vector<PupilTable> explored_tables(const Camera& camera, const Execution& execution);

}  // namespace plenoflame
