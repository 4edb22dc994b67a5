#pragma once
#include "plenoflame/base/report.h"
#include "plenoflame/camera/design.h"

namespace plenoflame::cli {

/// Reports the filters over parts of the stop: how much light each gets, and which views see it.
/// Nothing where there are none.
void add_pupil_filters(const Camera& camera, const CameraDesign& design, Report& report);

}  // namespace plenoflame::cli
