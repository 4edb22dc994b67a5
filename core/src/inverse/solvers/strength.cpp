#include "plenoflame/inverse/strength.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "inverse/solvers/iteration.h"
#include "plenoflame/base/error.h"
#include "plenoflame/inverse/penalty.h"

namespace plenoflame {
namespace {

/// Halvings of the steps of the range about the best strength of a rule without a target.
constexpr int kHalvings = 2;
constexpr double kExcess = 0.1;  ///< over the least misfit, where the noise explains none

double counted_rows(const LinearProblem& problem) {
  if (problem.weights.empty()) return static_cast<double>(problem.b.size());
  return static_cast<double>(std::count_if(problem.weights.begin(), problem.weights.end(),
                                           [](double w) { return w > 0; }));
}

/// Trace of the influence matrix W A (A^T W^2 A + s L^T L)^-1 A^T W, by probing: the same random
/// signs for every strength, so that the curve is smooth (Girard 1989).
double influence(const LinearProblem& problem, const LinearOperator& penalty, double strength,
                 const StrengthRange& range, const Execution& execution) {
  const int probes = range.probes;
  SignSequence signs(11);
  SolverOptions options;
  options.iterations = range.probe_iterations;
  options.relative_change = 1e-5;
  double sum = 0;
  std::vector<double> b(problem.b.size()), weighted(problem.b.size());
  for (int probe = 0; probe < probes; ++probe) {
    for (std::size_t i = 0; i < b.size(); ++i) {
      const double w = problem.weights.empty() ? 1 : problem.weights[i];
      const double sign = signs.next();
      weighted[i] = w > 0 ? sign : 0;
      b[i] = w > 0 ? sign / w : 0;
    }
    const Solution s =
        solve_cgls({problem.a, b, problem.weights}, {&penalty, strength}, options, execution);
    std::vector<double> back = *problem.a * s.x;
    scale_by(problem.weights, back);
    sum += dot(weighted, back);
  }
  return sum / probes;
}

/// Index of the largest curvature of log misfit against log penalty.
std::size_t corner(const std::vector<StrengthPoint>& curve) {
  std::size_t best = 0;
  double sharpest = -1;
  for (std::size_t k = 1; k + 1 < curve.size(); ++k) {
    const auto at = [&](std::size_t n) {
      return std::array<double, 2>{std::log(curve[n].misfit),
                                   std::log(std::max(curve[n].penalty, 1e-300))};
    };
    const auto a = at(k - 1), b = at(k), c = at(k + 1);
    const double ux = b[0] - a[0], uy = b[1] - a[1], vx = c[0] - b[0], vy = c[1] - b[1];
    const double lengths =
        std::hypot(ux, uy) * std::hypot(vx, vy) * std::hypot(c[0] - a[0], c[1] - a[1]);
    // Menger's curvature; from weak to strong the L is turned to the left at its corner.
    const double curvature = lengths > 0 ? 2 * (ux * vy - uy * vx) / lengths : 0;
    if (curvature > sharpest) {
      sharpest = curvature;
      best = k;
    }
  }
  return best;
}

std::vector<StrengthPoint> sorted(const std::vector<StrengthPoint>& curve,
                                  const std::vector<std::size_t>& order) {
  std::vector<StrengthPoint> result;
  for (const std::size_t k : order) result.push_back(curve[k]);
  return result;
}

/// Index of the best point of a curve in the order of its strengths.
std::size_t best_of(const std::vector<StrengthPoint>& curve, StrengthRule rule, double target) {
  if (rule == StrengthRule::l_curve) return corner(curve);
  const auto badness = [&](const StrengthPoint& point) {
    return rule == StrengthRule::gcv ? point.gcv : std::abs(std::log(point.misfit / target));
  };
  return static_cast<std::size_t>(
      std::min_element(
          curve.begin(), curve.end(),
          [&](const StrengthPoint& a, const StrengthPoint& b) { return badness(a) < badness(b); }) -
      curve.begin());
}

}  // namespace

StrengthChoice choose_strength(const LinearProblem& problem, const LinearOperator& penalty,
                               double unit, StrengthRule rule, const StrengthRange& range,
                               const StrengthSolver& solve, const Execution& execution) {
  check_problem(problem);
  if (!(range.lowest > 0) || !(range.highest > range.lowest) || range.points < 3)
    throw UsageError("strengths range from a number above 0 to a larger one, in 3 steps at least");
  const double expected = range.expected_misfit > 0 ? range.expected_misfit : counted_rows(problem);
  StrengthChoice choice;
  std::vector<Solution> solutions;
  std::vector<double> start;
  const auto attempt = [&](double strength) -> std::optional<StrengthPoint> {
    try {
      Solution s = solve(strength * unit, start);
      start = s.x;
      StrengthPoint point{strength, s.history.empty() ? 0 : s.history.back().misfit,
                          s.history.empty() ? 0 : s.history.back().penalty};
      if (rule == StrengthRule::gcv) {
        const double left =
            counted_rows(problem) - influence(problem, penalty, strength * unit, range, execution);
        point.gcv = point.misfit / (left * left);
      }
      choice.curve.push_back(point);
      solutions.push_back(std::move(s));
      return point;
    } catch (const Cancelled&) {
      // In the middle of a product. The strengths that were tried before are kept.
      if (choice.curve.empty()) throw;
      return std::nullopt;
    }
  };

  for (int k = range.points - 1; k >= 0; --k) {
    const double share = static_cast<double>(k) / (range.points - 1);
    const double strength = range.lowest * std::pow(range.highest / range.lowest, share);
    const std::optional<StrengthPoint> point = attempt(strength);
    if (!point || execution.stop.stop_requested()) break;
    if (rule == StrengthRule::discrepancy && point->misfit <= expected) break;
  }
  double target = expected;
  if (rule == StrengthRule::discrepancy) {
    double least = choice.curve.front().misfit;
    for (const StrengthPoint& point : choice.curve) least = std::min(least, point.misfit);
    choice.reached = least <= expected;
    if (!choice.reached) target = (1 + kExcess) * least;
    double above = 0, below = 0;  // strengths whose misfits are too large and small enough
    for (const StrengthPoint& point : choice.curve) {
      if (point.misfit <= target)
        below = std::max(below, point.strength);
      else
        above = above == 0 ? point.strength : std::min(above, point.strength);
    }
    for (int k = 0; k < range.bisections && above > below && below > 0; ++k) {
      if (execution.stop.stop_requested()) break;
      const double strength = std::sqrt(above * below);
      const std::optional<StrengthPoint> point = attempt(strength);
      if (!point) break;
      (point->misfit <= target ? below : above) = strength;
      if (std::abs(point->misfit - target) <= range.tolerance * target) break;
    }
  }
  const auto by_strength = [&] {
    std::vector<std::size_t> order(choice.curve.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return choice.curve[a].strength < choice.curve[b].strength;
    });
    return order;
  };
  if (rule != StrengthRule::discrepancy) {
    // Halfway to either neighbour of the best, again and again.
    for (int k = 0; k < kHalvings; ++k) {
      const std::vector<std::size_t> order = by_strength();
      const std::size_t best = best_of(sorted(choice.curve, order), rule, target);
      const double middle = choice.curve[order[best]].strength;
      for (const int side : {1, -1}) {
        const bool inside = side > 0 ? best + 1 < order.size() : best > 0;
        if (!inside || execution.stop.stop_requested()) continue;
        const std::size_t other = order[side > 0 ? best + 1 : best - 1];
        start = solutions[order[best]].x;
        attempt(std::sqrt(middle * choice.curve[other].strength));
      }
    }
  }
  const std::vector<std::size_t> order = by_strength();
  std::vector<StrengthPoint> curve = sorted(choice.curve, order);
  const std::size_t best = best_of(curve, rule, target);
  choice.strength = curve[best].strength;
  constexpr double kRounding = 1e-9;
  choice.at_end = choice.strength >= (1 - kRounding) * range.highest ||
                  choice.strength <= (1 + kRounding) * range.lowest;
  choice.solution = std::move(solutions[order[best]]);
  choice.curve = std::move(curve);
  return choice;
}

}  // namespace plenoflame
