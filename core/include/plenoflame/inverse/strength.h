#pragma once
#include <vector>

#include "plenoflame/inverse/solvers.h"

namespace plenoflame {

/// A tested strength.
struct StrengthPoint {
  double strength = 0;  ///< relative: the absolute one is the unit times it
  double misfit = 0;    ///< |W (A x - b)|^2
  double penalty = 0;   ///< |L (x - prior)|^2
  double gcv = 0;       ///< misfit / (m - trace of the influence matrix)^2, see choose_strength()
};

struct StrengthChoice {
  double strength = 0;  ///< relative
  /// All tested strengths, in ascending order.
  std::vector<StrengthPoint> curve;
  /// The best one lies at the end of the range: look at the curve, or widen the range.
  bool at_end = false;
  Solution solution;  ///< with this strength
};

struct StrengthRange {
  double lowest = 1e-6, highest = 1e4;  ///< relative
  int points = 11;                      ///< of the curve; the search continues between two of them
  int probes = 4;                       ///< random vectors for the trace
  int iterations = 500;                 ///< of each solution, at most
  /// Solutions are without negative values, for unknowns that cannot be negative. Negative light
  /// would explain errors of the lattice.
  bool bounded = false;
};

/// The strength of least generalised cross-validation (Golub, Heath and Wahba 1979). Unknowns at
/// their bound have no part in the influence matrix. The number m counts independent errors: one
/// per row, but at most five for each unknown, because pixels share the errors of the lattice.
/// Strengths are tested from the strongest to the weakest, until two in a row are worse than the
/// best. Further ones about the best one follow.
/// @param options start, end and watch of the solutions; the range has their iterations
/// @throws UsageError for an empty range
StrengthChoice choose_strength(const LinearProblem& problem, const Regularisation& penalty,
                               double unit, const StrengthRange& range,
                               const SolverOptions& options, const Execution& execution = {});

}  // namespace plenoflame
