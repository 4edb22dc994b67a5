#pragma once
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "inverse/operators/vector_sums.h"
#include "plenoflame/inverse/solvers.h"

namespace plenoflame {

/// A gradient below this part of the first one is rounding.
inline constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();

/// Checks sizes and numbers. @throws UsageError, InputError
void check_problem(const LinearProblem& problem);
void check_options(const SolverOptions& options, std::size_t columns);
void check_regularisation(const Regularisation& regularisation, std::size_t columns);

/// W (b - A x).
std::vector<double> weighted_residual(const LinearProblem& problem, std::span<const double> x);

/// |L (x - prior)|^2; 0 without a penalty.
double penalty_of(const Regularisation& regularisation, std::span<const double> x);

/// The part that all solvers share: keeps the history and says when it is enough.
class Iteration {
 public:
  Iteration(const SolverOptions& options, const Execution& execution)
      : options_(options), execution_(execution) {}

  /// @param x after the iteration @param before it
  /// @return whether to continue
  bool add(double misfit, double penalty, std::span<const double> x,
           std::span<const double> before);
  /// Ends where the gradient of half of the objective is small enough. @return whether it is
  bool ends_with_gradient(double length) {
    if (!(options_.gradient > 0) || length > options_.gradient) return false;
    solution_.reason = StopReason::converged;
    return true;
  }
  /// Ends for a reason of the solver's own.
  void end(StopReason reason) { solution_.reason = reason; }
  Solution take(std::vector<double> x) {
    solution_.x = std::move(x);
    return std::move(solution_);
  }

 private:
  const SolverOptions& options_;
  const Execution& execution_;
  Solution solution_;
};

}  // namespace plenoflame
