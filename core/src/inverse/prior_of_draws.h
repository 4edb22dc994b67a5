#pragma once
#include <memory>
#include <span>
#include <vector>

#include "inverse/operators/scaled_problem.h"
#include "plenoflame/inverse/reconstruction.h"

namespace plenoflame {

/// A Gaussian prior of flames, in the unknowns of a problem.
struct PriorOfFlame {
  /// Its unknowns are ratios to a flame; nullptr: they are those of the solution.
  std::unique_ptr<ScaledProblem> ratios;
  Regularisation penalty;
};

/// The strength at which flames that are drawn from the prior are as bright as this one, where it
/// shines.
/// @param penalty of strength 1 @param prior in the flame's units; empty: 0
double strength_of_brightness(const ScaledProblem& problem, const Regularisation& penalty,
                              std::span<const double> prior, std::vector<double> flame,
                              const Execution& execution);

/// Tells whether the solution itself has a prior of ratios: that of voxels by the default solver.
bool solves_ratios(const ReconstructionInput& input, const ReconstructionSettings& settings);

/// A prior of ratios to a first solution. Evidence tells their size.
/// @param b [W] of the rows @param found values and solved are read
PriorOfFlame prior_by_evidence(const ScaledProblem& problem, const ReconstructionInput& input,
                               const ReconstructionSettings& settings, std::span<const double> b,
                               const Reconstruction& found, const Execution& execution);

/// The strength for draws about a solution with such a prior. Flames are smoother beyond what the
/// pictures resolve than within it: deviations would be 1.5 times too large
/// (docs/theory/reconstruction.md).
double strength_of_draws(const PriorOfFlame& prior, const ReconstructionInput& input,
                         const Reconstruction& found, const Execution& execution);

/// The prior of draws about any other solution. The unknowns are ratios to the found flame, and
/// evidence tells their size. Rings whose resolved number is not known, and solutions with a prior,
/// have that of the solution.
/// @param b [W] of the rows @param found strength, values, at_places, solved, noise_factor and
///        resolved_unknowns are read
PriorOfFlame prior_of_draws(const ScaledProblem& problem, const ReconstructionInput& input,
                            const ReconstructionSettings& settings, std::span<const double> b,
                            const Reconstruction& found, const Execution& execution);

}  // namespace plenoflame
