#pragma once
#include <functional>
#include <span>
#include <vector>

#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/solvers.h"

/// The error that a wrong absorption makes in what is found with it.
namespace plenoflame {

/// Fluxes of all rows [W] with the known absorption times a factor.
using FluxesByAbsorption = std::function<std::vector<double>(double factor)>;

/// Fluxes of an emission problem, which must outlive the result, as x and the execution must.
inline FluxesByAbsorption fluxes_by_absorption(const EmissionProblem& problem,
                                               std::span<const double> x,
                                               const Execution& execution) {
  return [&problem, x, &execution](double factor) {
    EmissionProblem other = problem;
    for (double& absorption : other.absorption) absorption *= factor;
    return *make_emission_operator(other, execution) * x;
  };
}

/// Change of all rows [W] for an absorption that is larger everywhere by a factor of 1 + s, over s.
/// @param fluxes with the absorption as it is known
inline std::vector<double> change_by_absorption(const FluxesByAbsorption& by_absorption,
                                                std::span<const double> fluxes) {
  constexpr double kShare = 0.01;
  std::vector<double> change = by_absorption(1 + kShare);
  for (std::size_t i = 0; i < change.size(); ++i) change[i] = (change[i] - fluxes[i]) / kShare;
  return change;
}

/// The solution's part of such a change of the pictures. It is the error of what was found, over s, if
/// the absorption is larger than the problem's.
inline std::vector<double> shift_by_absorption(LinearProblem problem, Regularisation penalty,
                                               std::span<const double> change,
                                               const Execution& execution) {
  problem.b = change;
  penalty.prior = {};
  SolverOptions options;
  options.iterations = 300;
  options.relative_change = 1e-5;
  return solve_cgls(problem, penalty, options, execution).x;
}

}  // namespace plenoflame
