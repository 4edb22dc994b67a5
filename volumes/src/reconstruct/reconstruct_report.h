#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/report.h"
#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/volumes/reconstruct_result.h"

/// Parts of the report of a reconstruction.
namespace plenoflame {

/// Half angle under which a camera's rays cross a place [rad]: what separates depths.
double half_angle(const CompiledScene& scene, const Unknowns& unknowns,
                  const CameraRaySettings& settings);

void report_errors(const FlameEstimate& estimate, const FlameTruth& truth, const Unknowns& unknowns,
                   Report& report);

/// The tests of the cameras, named or not, and what was corrected. @param cameras their names
void report_suspects(const ReconstructResult& result, const std::vector<std::string>& cameras,
                     Report& report);

/// Reports the effect of the pictures' common error of light on emission, and on the temperature
/// that follows from it.
/// @param source of the channel; nullptr: no temperature follows from the emission
void report_scale(const ReconstructResult& result, const SourceFunction* source,
                  const Unknowns& unknowns, Report& report);

/// The figures of a reconstruction.
void report_reconstruction(const ReconstructResult& result, const Unknowns& unknowns,
                           Report& report);

}  // namespace plenoflame
