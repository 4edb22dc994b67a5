#pragma once
#include <functional>
#include <span>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/light_behind.h"
#include "plenoflame/inverse/solvers.h"
#include "plenoflame/inverse/uncertainty.h"

/// The error that a wrong absorption or camera makes in what is found with it.
namespace plenoflame {

/// Change of all rows [W] for an absorption that is larger everywhere by a factor of 1 + s, over s.
/// @param fluxes of the rows with the known absorption times a factor, with the light behind it
inline std::vector<double> change_by_absorption(
    const std::function<std::vector<double>(double factor)>& fluxes) {
  constexpr double kShare = 0.01;
  std::vector<double> change = fluxes(1 + kShare);
  const std::vector<double> without = fluxes(1);
  for (std::size_t i = 0; i < change.size(); ++i) change[i] = (change[i] - without[i]) / kShare;
  return change;
}

/// The same for an emission problem. @param x samples @param rays by which its rows were drawn
inline std::vector<double> change_by_absorption(const EmissionProblem& problem,
                                                std::span<const double> x,
                                                const std::vector<CameraView>& views,
                                                const CameraRaySettings& rays,
                                                const Execution& execution) {
  return change_by_absorption([&](double factor) {
    EmissionProblem other = problem;
    for (double& absorption : other.absorption) absorption *= factor;
    std::vector<double> fluxes = *make_emission_operator(other, execution) * x;
    const std::vector<double> light =
        light_behind(views, *other.rays, *other.unknowns, other.absorption, rays, execution);
    for (std::size_t i = 0; i < light.size(); ++i) fluxes[i] += light[i];
    return fluxes;
  });
}

/// The solution's part of a change of the pictures [W], whatever the prior. @throws Cancelled
inline std::vector<double> follow_change(LinearProblem problem, Regularisation penalty,
                                         std::span<const double> change,
                                         const ProbeAccuracy& accuracy,
                                         const Execution& execution) {
  problem.b = change;
  penalty.prior = {};
  SolverOptions options;
  options.iterations = accuracy.iterations;
  options.relative_change = accuracy.relative_change;
  Solution followed = solve_cgls(problem, penalty, options, execution);
  if (execution.stop.stop_requested()) throw Cancelled();
  return std::move(followed.x);
}

}  // namespace plenoflame
