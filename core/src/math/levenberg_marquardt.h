#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <optional>

namespace plenoflame {

/// A sum of squares at a state. To first order, change = square^-1 right leads to its minimum.
template <int kCount>
struct NormalEquations {
  Eigen::Matrix<double, kCount, kCount> square;
  Eigen::Matrix<double, kCount, 1> right;
  double sum = 0;
};

struct LeastSquaresLimits {
  int steps = 100;
  double damping = 1e-6;      ///< where it begins, in units of the diagonal
  double most_damping = 1e6;  ///< the search ends beyond
  double converged = 1e-10;   ///< relative decrease of the sum that ends the search
};

/// Least squares by Levenberg's and Marquardt's method, from a state on.
/// @param evaluate state -> std::optional<NormalEquations<kCount>>; none: the state is not allowed
/// @param moved (state, change) -> state
/// @param[out] here the equations at the state that was found
/// @return count of steps that lowered the sum
template <int kCount, class State, class Evaluate, class Moved>
int minimise(State& state, NormalEquations<kCount>& here, const Evaluate& evaluate,
             const Moved& moved, const LeastSquaresLimits& limits = {}) {
  const std::optional<NormalEquations<kCount>> start = evaluate(state);
  if (!start) return 0;
  here = *start;
  double damping = limits.damping;
  int steps = 0;
  while (steps < limits.steps && damping <= limits.most_damping) {
    Eigen::Matrix<double, kCount, kCount> damped = here.square;
    damped.diagonal() *= 1 + damping;
    const Eigen::Matrix<double, kCount, 1> change = damped.ldlt().solve(here.right);
    std::optional<NormalEquations<kCount>> next;
    State there = state;
    if (change.allFinite()) {
      there = moved(state, change);
      next = evaluate(there);
    }
    if (!next || !(next->sum <= here.sum)) {
      damping = 10 * std::max(damping, 1e-12);
      continue;
    }
    const double decrease = here.sum - next->sum;
    state = there;
    here = *next;
    damping *= 0.1;
    ++steps;
    if (decrease <= limits.converged * here.sum) break;
  }
  return steps;
}

}  // namespace plenoflame
