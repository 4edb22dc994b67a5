#include <algorithm>

#include "inverse/solvers/iteration.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// Power iterations come from below: norms are taken that much larger.
constexpr double kNormRoom = 1.02;

/// sum over places of the length of the gradient there.
double total_variation(const LinearOperator& gradient, std::span<const double> x) {
  const std::vector<double> g = gradient * x;
  double sum = 0;
  for (std::size_t i = 0; i + 2 < g.size(); i += 3)
    sum += std::sqrt(g[i] * g[i] + g[i + 1] * g[i + 1] + g[i + 2] * g[i + 2]);
  return sum;
}

}  // namespace

Solution solve_total_variation(const LinearProblem& problem, const LinearOperator& gradient,
                               double strength, const SolverOptions& options,
                               const Execution& execution) {
  check_problem(problem);
  const std::size_t columns = problem.a->columns();
  check_options(options, columns);
  check_regularisation({&gradient, strength}, columns);
  if (gradient.rows() % 3 != 0)
    throw UsageError("total variation wants the rows of its gradient in groups of three");
  const double norm_a = kNormRoom * largest_singular_value(*problem.a, problem.weights,
                                                           kPowerIterations, execution.stop);
  const double norm_g = kNormRoom * largest_singular_value(gradient, {});
  std::vector<double> x = options.start.empty() ? std::vector<double>(columns, 0.0) : options.start;
  for (double& value : x) value = std::max(value, 0.0);
  Iteration iteration(options, execution);
  if (!(norm_a > 0)) {
    iteration.end(StopReason::converged);
    return iteration.take(std::move(x));
  }
  // K = [W A / norm_a; G / norm_g] has a norm of at most sqrt(2), so that tau sigma |K|^2 <= 1. The
  // misfit's curvature in K x is norm_a^2: sigma is that.
  const double sigma = norm_a * norm_a, tau = 1 / (2 * sigma);
  const double limit = strength * norm_g;
  std::vector<double> ahead = x, before(columns), y(problem.b.size(), 0.0), z(gradient.rows(), 0.0);
  for (int n = 0; n < options.iterations; ++n) {
    std::vector<double> product = *problem.a * ahead;
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double w = problem.weights.empty() ? 1 : problem.weights[i];
      if (!(w > 0)) continue;
      const double v = y[i] + sigma * w * product[i] / norm_a;
      y[i] = (norm_a * norm_a * v - sigma * norm_a * w * problem.b[i]) / (norm_a * norm_a + sigma);
    }
    if (norm_g > 0) {
      product = gradient * ahead;
      for (std::size_t i = 0; i < z.size(); i += 3) {
        double length = 0;
        for (std::size_t a = i; a < i + 3; ++a) {
          z[a] += sigma * product[a] / norm_g;
          length += z[a] * z[a];
        }
        length = std::sqrt(length);
        if (length > limit)
          for (std::size_t a = i; a < i + 3; ++a) z[a] *= limit / length;
      }
    }
    std::vector<double> weighted = y;
    scale_by(problem.weights, weighted);
    std::vector<double> back = transposed_times(*problem.a, weighted);
    for (double& value : back) value /= norm_a;
    if (norm_g > 0) add_scaled(1 / norm_g, transposed_times(gradient, z), back);
    before = x;
    for (std::size_t j = 0; j < columns; ++j) {
      x[j] = std::max(0.0, x[j] - tau * back[j]);
      ahead[j] = 2 * x[j] - before[j];
    }
    const std::vector<double> r = weighted_residual(problem, x);
    if (!iteration.add(dot(r, r), total_variation(gradient, x), x, before)) break;
  }
  return iteration.take(std::move(x));
}

}  // namespace plenoflame
