#pragma once
#include "plenoflame/base/execution.h"
#include "plenoflame/base/report.h"
#include "plenoflame/base/setting_names.h"
#include "plenoflame/inverse/reconstruction.h"

/// Warnings of what the figures of a reconstruction say against it.
namespace plenoflame {

/// Depth resolved by one camera alone is bounded by its pupil, and no algorithm mends that.
/// @param angle [rad] half of the cone in which the camera sees the grid; 0: not known
void warn_single_camera(const Reconstruction& result, const Unknowns& unknowns, double angle,
                        const SettingNames& names, const Execution& execution, Report& report);

void warn_of(const Reconstruction& figures, const ReconstructionSettings& settings,
             const SettingNames& names, const Execution& execution);

}  // namespace plenoflame
