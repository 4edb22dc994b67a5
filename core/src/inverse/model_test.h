#pragma once
#include <span>
#include <vector>

#include "inverse/operators/scaled_problem.h"
#include "plenoflame/inverse/reconstruction.h"

namespace plenoflame {

/// Tests what the pictures say of exposure, stray light and place of each camera, one quantity
/// after the other, with the flame free to follow (docs/theory/reconstruction.md). Exposures and
/// places are told by several cameras only, places by voxels only.
/// @param residual b - A x of the solution @param accuracy of one solution for each quantity
/// @throws Cancelled
std::vector<Suspect> test_model(const ReconstructionInput& input, const ScaledProblem& problem,
                                const CameraRays& rays, std::span<const double> residual,
                                const Reconstruction& found, const ProbeAccuracy& accuracy,
                                const Execution& execution);

}  // namespace plenoflame
