#pragma once
#include <vector>

#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// The largest displacement of camera rays by windows, at places of some boxes [m]. It is measured
/// across the camera's axis, from the straight line on which a ray leaves the camera. The result
/// comes from traced rays, with a margin for rays between them. It is infinite if it cannot be
/// determined.
double displacement_by_windows(const CompiledScene& scene, const std::vector<Box>& boxes);

}  // namespace plenoflame
