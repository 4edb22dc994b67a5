#include "inverse/prior_of_draws.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "inverse/expected_misfit.h"
#include "inverse/operators/vector_sums.h"
#include "plenoflame/inverse/solvers.h"
#include "plenoflame/inverse/uncertainty.h"

namespace plenoflame {
namespace {

/// Places shine that are brighter than this share of the brightest.
constexpr double kLit = 0.05;

std::vector<char> lit_places(std::span<const double> flame) {
  const double least = kLit * *std::ranges::max_element(flame);
  std::vector<char> lit;
  for (const double value : flame) lit.push_back(value > least);
  return lit;
}

/// Share of the unknowns that may shine which do.
double share_of_lit(const Reconstruction& found) {
  return static_cast<double>(std::ranges::count(lit_places(found.at_places), char{1})) /
         static_cast<double>(
             std::max<std::ptrdiff_t>(1, std::ranges::count(found.solved, char{1})));
}

/// The flame, so smooth that its own errors matter little, and nowhere dark. It is 0 for what is
/// not solved.
std::vector<double> shape_of(const Reconstruction& found, const Unknowns& unknowns) {
  constexpr int kPasses = 1;
  constexpr double kDarkest = 0.02;  // of the largest
  std::vector<double> shape = found.values;
  for (int pass = 0; pass < kPasses; ++pass)
    shape = averaged_with_neighbours(unknowns, std::move(shape));
  const double least = kDarkest * *std::ranges::max_element(found.values);
  for (std::size_t j = 0; j < shape.size(); ++j)
    shape[j] = found.solved[j] ? std::max(shape[j], 0.0) + least : 0;
  return shape;
}

/// The strength of the largest evidence (MacKay 1992). Each unknown that the pictures resolve adds
/// the variance of the noise to the penalty.
/// @param steps at most
double strength_of_evidence(const LinearProblem& problem, const LinearOperator& penalty,
                            double begin, int steps, const Execution& execution) {
  constexpr int kProbes = 4;
  constexpr double kReached = 0.1;
  const ProbeAccuracy accuracy{1000, 1e-4};
  SolverOptions options;
  options.iterations = accuracy.iterations;
  options.relative_change = accuracy.relative_change;
  const auto rows = static_cast<double>(
      std::ranges::count_if(problem.weights, [](double weight) { return weight > 0; }));
  double strength = begin;
  for (int step = 0; step < steps; ++step) {
    const Regularisation prior{&penalty, strength, {}};
    const double resolved =
        estimate_resolution(problem, prior, {kProbes, 2}, execution, accuracy).resolved_unknowns;
    const Solution solution = solve_cgls(problem, prior, options, execution);
    const double bend = norm(penalty * solution.x);
    const double before = std::exchange(
        strength, free_chi_squared(solution.misfit(), rows, resolved) * resolved / (bend * bend));
    if (std::abs(strength - before) < kReached * before) break;
  }
  return strength;
}

PriorOfFlame prior_of_ratios(const ScaledProblem& problem, const ReconstructionInput& input,
                             const ReconstructionSettings& settings, const Reconstruction& found) {
  PriorOfFlame prior;
  const std::span<const double> weights = problem.weights();
  prior.ratios = std::make_unique<ScaledProblem>(
      nullptr, problem.unscaled(), std::vector<double>(weights.begin(), weights.end()),
      shape_of(found, *input.unknowns), *input.unknowns, settings);
  prior.penalty = prior.ratios->penalty_of_ratios(1);
  return prior;
}

}  // namespace

double strength_of_brightness(const ScaledProblem& problem, const Regularisation& penalty,
                              std::span<const double> prior, std::vector<double> flame,
                              const Execution& execution) {
  constexpr int kDraws = 8;
  // Wide structures, which come last, hold most of the light.
  const ProbeAccuracy accuracy{2000, 1e-5};
  const std::vector<char> lit = lit_places(flame);
  const auto square_of_lit = [&](std::span<const double> values) {
    double sum = 0;
    for (std::size_t j = 0; j < lit.size(); ++j)
      if (lit[j]) sum += values[j] * values[j];
    return sum;
  };
  for (std::size_t j = 0; j < prior.size(); ++j) flame[j] -= prior[j];
  double drawn = 0;
  const auto add = [&](std::span<const double> u) {
    drawn += square_of_lit(problem.samples(u)) / kDraws;
  };
  draw_prior(penalty, {kDraws, 2}, add, execution, accuracy);
  const double own = square_of_lit(flame);
  return own > 0 ? drawn / own : std::numeric_limits<double>::max();
}

bool solves_ratios(const ReconstructionInput& input, const ReconstructionSettings& settings) {
  return settings.evidence && settings.solver == ReconstructionSolver::fista &&
         input.prior.empty() && !input.unknowns->begins_at_centre();
}

PriorOfFlame prior_by_evidence(const ScaledProblem& problem, const ReconstructionInput& input,
                               const ReconstructionSettings& settings, std::span<const double> b,
                               const Reconstruction& found, const Execution& execution) {
  constexpr int kSteps = 6;
  PriorOfFlame prior = prior_of_ratios(problem, input, settings, found);
  // Ratios bend by about 1.
  prior.penalty.strength =
      strength_of_evidence(prior.ratios->problem(b), *prior.penalty.penalty, 1, kSteps, execution);
  return prior;
}

double strength_of_draws(const PriorOfFlame& prior, const ReconstructionInput& input,
                         const Reconstruction& found, const Execution& execution) {
  constexpr double kSmoother = 2;
  if (input.views.size() > 1) return kSmoother * prior.penalty.strength;
  // One camera sees how fine the structure is, but not the depth of the light. The unknown part is
  // as large as the light along the lines of sight.
  return strength_of_brightness(*prior.ratios, {prior.penalty.penalty, 1}, {}, found.values,
                                execution);
}

PriorOfFlame prior_of_draws(const ScaledProblem& problem, const ReconstructionInput& input,
                            const ReconstructionSettings& settings, std::span<const double> b,
                            const Reconstruction& found, const Execution& execution) {
  if (!(found.strength > 0 && *std::ranges::max_element(found.values) > 0))
    return {nullptr, problem.regularisation(found.strength)};
  const bool round = input.unknowns->begins_at_centre();
  // Errors are as large as the flame is bright.
  if (input.prior.empty() && !round) {
    PriorOfFlame prior = input.views.size() > 1
                             ? prior_by_evidence(problem, input, settings, b, found, execution)
                             : prior_of_ratios(problem, input, settings, found);
    prior.penalty.strength = strength_of_draws(prior, input, found, execution);
    return prior;
  }
  if (input.prior.empty() && found.resolved_unknowns > 0) {
    PriorOfFlame prior = prior_of_ratios(problem, input, settings, found);
    const LinearOperator& l = *prior.penalty.penalty;
    const double bend = norm(l * prior.ratios->scaled(found.values)) / found.noise_factor;
    // Further steps take all detail of smooth rings for noise.
    prior.penalty.strength = strength_of_evidence(
        prior.ratios->problem(b), l, found.resolved_unknowns / (bend * bend), 1, execution);
    return prior;
  }
  // Only places with light bend: the amplitude that the strength tells in the mean of all is
  // theirs, and larger.
  double strength = share_of_lit(found) * found.strength;
  // Rings look the same to every camera.
  if (input.views.size() <= 2 || round)
    strength = std::min(strength, strength_of_brightness(problem, problem.regularisation(1),
                                                         input.prior, found.values, execution));
  return {nullptr, problem.regularisation(strength)};
}

}  // namespace plenoflame
