#pragma once
#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// The table of a camera without array: one disc of its pupil for every sensor point.
PupilTable bare_table(const Camera& given);

}  // namespace plenoflame
