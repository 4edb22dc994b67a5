#include "plenoflame/inverse/strength.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "inverse/expected_misfit.h"
#include "inverse/operators/scaled_problem.h"
#include "inverse/solvers/iteration.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// Halvings of the steps of the range about the best strength.
constexpr int kHalvings = 2;
/// Strengths in a row that are worse than the best, after which weaker ones are not tried.
constexpr int kWorse = 2;
/// Negative values count from this share of a solution's 2-norm.
constexpr double kNegative = 0.02;

double counted_rows(const LinearProblem& problem) {
  if (problem.weights.empty()) return static_cast<double>(problem.b.size());
  return static_cast<double>(std::count_if(problem.weights.begin(), problem.weights.end(),
                                           [](double w) { return w > 0; }));
}

double negative_part(std::span<const double> x) {
  double below = 0, all = 0;
  for (const double value : x) {
    all += value * value;
    if (value < 0) below += value * value;
  }
  return all > 0 ? std::sqrt(below / all) : 0;
}

/// Trace of the influence matrix W A (A^T W^2 A + s L^T L)^-1 A^T W, by probing (Girard 1989). The
/// random signs are equal for every strength, so that the curve is smooth.
/// @param free 0 for unknowns at their bound, which follow no data; otherwise 1
double influence(const LinearProblem& problem, const Regularisation& penalty,
                 std::vector<double> free, const StrengthRange& range, const Execution& execution) {
  const ScaledColumns a(*problem.a, free), l(*penalty.penalty, std::move(free));
  SignSequence signs(11);
  SolverOptions options;
  options.iterations = range.iterations;
  options.relative_change = 1e-5;
  double sum = 0;
  std::vector<double> b(problem.b.size()), weighted(problem.b.size());
  for (int probe = 0; probe < range.probes; ++probe) {
    for (std::size_t i = 0; i < b.size(); ++i) {
      const double w = problem.weights.empty() ? 1 : problem.weights[i];
      const double sign = signs.next();
      weighted[i] = w > 0 ? sign : 0;
      b[i] = w > 0 ? sign / w : 0;
    }
    const Solution s =
        solve_cgls({&a, b, problem.weights}, {&l, penalty.strength}, options, execution);
    std::vector<double> back = a * s.x;
    scale_by(problem.weights, back);
    sum += dot(weighted, back);
  }
  return sum / range.probes;
}

/// Tries strengths, and keeps what came out of each.
class Trials {
 public:
  Trials(const LinearProblem& problem, const Regularisation& penalty, double unit,
         const StrengthRange& range, SolverOptions options, const Execution& execution)
      : problem_(problem),
        penalty_(penalty),
        unit_(unit),
        range_(range),
        options_(std::move(options)),
        execution_(execution) {
    options_.iterations = range.iterations;
  }

  /// @param from number of the trial whose solution it begins with; the last one's without it
  /// @return false after a stop; earlier trials are kept
  bool attempt(double strength, std::size_t from) {
    try {
      penalty_.strength = strength * unit_;
      if (from < solutions_.size()) options_.start = solutions_[from].x;
      Solution solution = solve_cgls(problem_, penalty_, options_, execution_);
      std::vector<double> free(solution.x.size(), 1.0);
      if (range_.bounded && negative_part(solution.x) > kNegative) {
        SolverOptions bounded = options_;
        bounded.start = solution.x;
        for (double& value : bounded.start) value = std::max(value, 0.0);
        solution = solve_nnls(problem_, penalty_, bounded, execution_);
        for (std::size_t j = 0; j < free.size(); ++j) free[j] = solution.x[j] > 0 ? 1 : 0;
      }
      const auto columns = static_cast<double>(problem_.a->columns());
      const double left = independent_errors(counted_rows(problem_), columns) -
                          influence(problem_, penalty_, std::move(free), range_, execution_);
      // A probe that a stop interrupts gives no trace.
      if (execution_.stop.stop_requested() && !curve_.empty()) return false;
      const double misfit = solution.misfit();
      curve_.push_back(
          {strength, misfit, penalty_of(penalty_, solution.x), misfit / (left * left)});
      solutions_.push_back(std::move(solution));
    } catch (const Cancelled&) {
      if (curve_.empty()) throw;
      return false;
    }
    return !execution_.stop.stop_requested();
  }

  std::size_t count() const { return curve_.size(); }
  std::size_t best() const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < curve_.size(); ++k)
      if (curve_[k].gcv < curve_[best].gcv) best = k;
    return best;
  }
  double strength(std::size_t trial) const { return curve_[trial].strength; }
  /// The next stronger or weaker one of all trials; 0: there is none.
  double neighbour(std::size_t trial, bool stronger) const {
    double found = 0;
    for (const StrengthPoint& point : curve_)
      if (stronger ? point.strength > strength(trial) && (found == 0 || point.strength < found)
                   : point.strength < strength(trial) && point.strength > found)
        found = point.strength;
    return found;
  }

  StrengthChoice take() {
    StrengthChoice choice;
    const std::size_t chosen = best();
    choice.strength = strength(chosen);
    choice.at_end = neighbour(chosen, true) == 0 || neighbour(chosen, false) == 0;
    choice.solution = std::move(solutions_[chosen]);
    choice.curve = std::move(curve_);
    std::ranges::sort(choice.curve, {}, &StrengthPoint::strength);
    return choice;
  }

 private:
  const LinearProblem& problem_;
  Regularisation penalty_;
  double unit_;
  const StrengthRange& range_;
  SolverOptions options_;
  const Execution& execution_;
  std::vector<StrengthPoint> curve_;
  std::vector<Solution> solutions_;
};

}  // namespace

StrengthChoice choose_strength(const LinearProblem& problem, const Regularisation& penalty,
                               double unit, const StrengthRange& range,
                               const SolverOptions& options, const Execution& execution) {
  check_problem(problem);
  if (!(range.lowest > 0) || !(range.highest > range.lowest) || range.points < 3)
    throw UsageError("strengths range from a number above 0 to a larger one, in 3 steps at least");
  Trials trials(problem, penalty, unit, range, options, execution);
  bool goes_on = true;
  for (int k = range.points - 1; k >= 0 && goes_on; --k) {
    const double share = static_cast<double>(k) / (range.points - 1);
    goes_on = trials.attempt(range.lowest * std::pow(range.highest / range.lowest, share),
                             trials.count() - 1);
    if (!goes_on || trials.count() > trials.best() + kWorse) break;
  }
  for (int halving = 0; halving < kHalvings && goes_on; ++halving) {
    const std::size_t best = trials.best();
    for (const bool stronger : {true, false}) {
      const double other = trials.neighbour(best, stronger);
      if (other > 0 && goes_on)
        goes_on = trials.attempt(std::sqrt(trials.strength(best) * other), best);
    }
  }
  return trials.take();
}

}  // namespace plenoflame
