#pragma once
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/measurement.h"
#include "plenoflame/inverse/unknowns.h"

/// Light in the pictures that does not come from the flame. Solid surfaces emit it or reflect the
/// light of lamps; the surroundings emit it as well. It follows from the scene, so it is a known
/// part of every row.
namespace plenoflame {

/// True if a scene has such light. Light of the flame itself that surfaces reflect does not count.
bool shines_without_flames(const CompiledScene& scene);

/// Light of a scene without its flames, as an absorption lets it through [W], for each row; empty
/// where nothing shines. Rays are drawn with the settings' samples and seed, also those of a row
/// that miss the unknowns. The same for any number of threads.
/// Behind windows that bend rays the light of a stretch is weakened in that stretch only.
/// @param absorption [1/m] of each unknown; empty: none
/// @throws Cancelled
std::vector<double> light_behind(const std::vector<CameraView>& views, const CameraRays& rays,
                                 const Unknowns& unknowns, const std::vector<double>& absorption,
                                 const CameraRaySettings& settings, const Execution& execution);

/// Takes such light away from the rows; its shot noise stays. Empty: none.
void take_away(const std::vector<double>& light, MeasuredRows& measured);

}  // namespace plenoflame
