#pragma once
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "plenoflame/inverse/solvers.h"

namespace plenoflame {

/// Data and a model that is not linear: b = f(x) + noise.
struct NonlinearProblem {
  std::function<std::vector<double>(std::span<const double> x)> model;  ///< f(x)
  /// J at x, as an operator.
  std::function<std::unique_ptr<LinearOperator>(std::span<const double> x)> derivative;
  std::span<const double> b;
  std::span<const double> weights = {};        ///< as LinearProblem's
  std::vector<double> lower = {}, upper = {};  ///< bounds of x; empty: none
};

/// Gauss-Newton steps with Levenberg's damping (Levenberg 1944, Marquardt 1963). Each step is
/// solved by conjugate gradients on J; J^T J is never formed. Steps end at the bounds; variables
/// that the gradient holds at a bound are left out. Model and derivative may throw Cancelled after
/// a stop: the solution is then the previous step.
/// @throws UsageError where sizes do not fit or there is no start
Solution solve_gauss_newton(const NonlinearProblem& problem, const Regularisation& regularisation,
                            const SolverOptions& options, const Execution& execution = {});

}  // namespace plenoflame
