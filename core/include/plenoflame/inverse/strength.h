#pragma once
#include <functional>
#include <string>
#include <vector>

#include "plenoflame/inverse/solvers.h"

namespace plenoflame {

/// Rules by which the strength of a penalty is chosen.
enum class StrengthRule {
  discrepancy,  ///< the misfit is what the noise lets expect: the number of rows with a weight
  gcv,          ///< least generalised cross-validation (Golub, Heath and Wahba 1979)
  l_curve,      ///< the corner of log misfit against log penalty (Hansen 1992)
};

/// A strength that was tried.
struct StrengthPoint {
  double strength = 0;  ///< relative: the absolute one is the unit times it
  double misfit = 0;    ///< |W (A x - b)|^2
  double penalty = 0;   ///< |L (x - prior)|^2
  double gcv = -1;      ///< misfit / (m - trace of the influence matrix)^2; negative: not asked for
};

struct StrengthChoice {
  double strength = 0;  ///< relative
  /// All that were tried, in ascending order.
  std::vector<StrengthPoint> curve;
  /// The best one lies at the end of the range: look at the curve, or widen the range.
  bool at_end = false;
  bool reached = true;  ///< discrepancy: some strength leaves as little as is expected
  Solution solution;    ///< with this strength
};

struct StrengthRange {
  double lowest = 1e-6, highest = 1e4;  ///< relative
  int points = 11;                      ///< of the curve; all rules go on between two of them
  double expected_misfit = 0;           ///< for discrepancy; 0: the number of rows with a weight
  int bisections = 20;                  ///< of discrepancy, at most
  double tolerance = 0.002;             ///< of discrepancy's misfit, relative, at which they end
  int probes = 4;                       ///< random vectors for GCV's trace
  int probe_iterations = 500;           ///< for each of them, at most
};

/// Solves a problem with a given absolute strength from a start.
using StrengthSolver = std::function<Solution(double strength, const std::vector<double>& start)>;

/// Tries strengths from the strongest to the weakest, each from the solution before; then others
/// about the best one. Where the discrepancy reaches what is expected with none (the model is wrong
/// by more than the noise), it is the strongest one that leaves at most a tenth more than the
/// least.
/// @param unit the absolute strength for a relative one of 1, e.g. penalty_unit()
/// @param solve what is solved with, e.g. solve_cgls or solve_nnls
/// @throws UsageError for an empty range
StrengthChoice choose_strength(const LinearProblem& problem, const LinearOperator& penalty,
                               double unit, StrengthRule rule, const StrengthRange& range,
                               const StrengthSolver& solve, const Execution& execution = {});

}  // namespace plenoflame
