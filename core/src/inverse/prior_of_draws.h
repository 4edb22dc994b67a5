#pragma once
#include <memory>
#include <span>
#include <vector>

#include "inverse/operators/scaled_problem.h"
#include "plenoflame/inverse/reconstruction.h"

namespace plenoflame {

/// The prior of the flames from which deviations are drawn, in the unknowns of a problem.
struct PriorOfDraws {
  /// Its unknowns are ratios to the flame; nullptr: they are those of the solution.
  std::unique_ptr<ScaledProblem> ratios;
  Regularisation penalty;
};

/// The strength at which flames that are drawn from the prior are as bright as this one, where it
/// shines.
/// @param penalty of strength 1 @param prior in the flame's units; empty: 0
double strength_of_brightness(const ScaledProblem& problem, const Regularisation& penalty,
                              std::span<const double> prior, std::vector<double> flame,
                              const Execution& execution);

/// The unknowns are ratios to the found flame, and evidence tells their size. Flames are at least
/// as bright as the found one if the views do not tell the depth of the light. The prior is that of
/// the solution if the number of resolved unknowns is not known.
/// @param b [W] of the rows @param found strength, values, at_places, solved, noise_factor and
///        resolved_unknowns are read
PriorOfDraws prior_of_draws(const ScaledProblem& problem, const ReconstructionInput& input,
                            const ReconstructionSettings& settings, std::span<const double> b,
                            const Reconstruction& found, const Execution& execution);

}  // namespace plenoflame
