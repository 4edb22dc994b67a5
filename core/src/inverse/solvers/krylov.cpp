#include <algorithm>

#include "inverse/operators/stacked_operator.h"
#include "inverse/solvers/iteration.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

std::vector<double> start_of(const SolverOptions& options, std::size_t columns) {
  return options.start.empty() ? std::vector<double>(columns, 0.0) : options.start;
}

/// [W (b - A x); -sqrt(strength) L (x - prior)].
std::vector<double> stacked_residual(const LinearProblem& problem,
                                     const Regularisation& regularisation,
                                     std::span<const double> x) {
  std::vector<double> r = weighted_residual(problem, x);
  if (!regularisation.penalty) return r;
  std::vector<double> difference(x.begin(), x.end());
  for (std::size_t j = 0; j < regularisation.prior.size(); ++j)
    difference[j] -= regularisation.prior[j];
  const double scale = -std::sqrt(regularisation.strength);
  for (const double row : *regularisation.penalty* difference) r.push_back(scale * row);
  return r;
}

/// Misfit and penalty of a stacked residual.
SolverStep parts_of(std::span<const double> r, std::size_t rows, double strength) {
  SolverStep step;
  step.misfit = dot(r.first(rows), r.first(rows));
  const auto rest = r.subspan(rows);
  if (strength > 0) step.penalty = dot(rest, rest) / strength;
  return step;
}

void check(const LinearProblem& problem, const Regularisation& regularisation,
           const SolverOptions& options) {
  check_problem(problem);
  check_options(options, problem.a->columns());
  check_regularisation(regularisation, problem.a->columns());
}

}  // namespace

Solution solve_cgls(const LinearProblem& problem, const Regularisation& regularisation,
                    const SolverOptions& options, const Execution& execution) {
  check(problem, regularisation, options);
  const StackedOperator k(problem, regularisation);
  std::vector<double> x = start_of(options, k.columns()), before(x.size()), q(k.rows());
  std::vector<double> r = stacked_residual(problem, regularisation, x);
  std::vector<double> s = transposed_times(k, r), p = s;
  double gamma = dot(s, s);
  // The gradient at 0 tells what is small, wherever the iteration starts.
  const double first = norm(transposed_times(
      k, stacked_residual(problem, regularisation, std::vector<double>(x.size()))));
  Iteration iteration(options, execution);
  if (!(std::sqrt(gamma) > kRounding * first)) iteration.end(StopReason::converged);
  for (int i = 0; i < options.iterations && std::sqrt(gamma) > kRounding * first; ++i) {
    k.apply(p, q);
    const double curvature = dot(q, q);
    if (!(curvature > 0)) {
      iteration.end(StopReason::converged);
      break;
    }
    const double step = gamma / curvature;
    before = x;
    add_scaled(step, p, x);
    add_scaled(-step, q, r);
    k.apply_transpose(r, s);
    const double next = dot(s, s);
    const SolverStep parts = parts_of(r, problem.b.size(), regularisation.strength);
    if (!iteration.add(parts.misfit, parts.penalty, x, before)) break;
    if (iteration.ends_with_gradient(std::sqrt(next))) break;
    if (!(std::sqrt(next) > kRounding * first)) iteration.end(StopReason::converged);
    for (std::size_t j = 0; j < p.size(); ++j) p[j] = s[j] + next / gamma * p[j];
    gamma = next;
  }
  return iteration.take(std::move(x));
}

Solution solve_lsqr(const LinearProblem& problem, const Regularisation& regularisation,
                    const SolverOptions& options, const Execution& execution) {
  check(problem, regularisation, options);
  const StackedOperator k(problem, regularisation);
  // For x = start + d: the right-hand side of the penalty is -sqrt(strength) L (start - prior), so
  // that the solution is penalised and not the step.
  std::vector<double> x = start_of(options, k.columns()), before(x.size());
  std::vector<double> u = stacked_residual(problem, regularisation, x);
  Iteration iteration(options, execution);
  const auto normalise = [](std::vector<double>& vector) {
    const double length = norm(vector);
    if (length > 0)
      for (double& value : vector) value /= length;
    return length;
  };
  double beta = normalise(u);
  std::vector<double> v = transposed_times(k, u), w, product_u(k.rows()), product_v(x.size());
  double alpha = normalise(v);
  w = v;
  double phi = beta, rho = alpha;
  const double first = alpha * beta;
  if (!(first > 0)) {
    iteration.end(StopReason::converged);
    return iteration.take(std::move(x));
  }
  for (int i = 0; i < options.iterations; ++i) {
    k.apply(v, product_u);
    for (std::size_t n = 0; n < u.size(); ++n) u[n] = product_u[n] - alpha * u[n];
    beta = normalise(u);
    k.apply_transpose(u, product_v);
    for (std::size_t n = 0; n < v.size(); ++n) v[n] = product_v[n] - beta * v[n];
    alpha = normalise(v);
    const double length = std::hypot(rho, beta);
    const double cosine = rho / length, sine = beta / length;
    const double theta = sine * alpha;
    rho = -cosine * alpha;
    const double step = cosine * phi / length;
    phi = sine * phi;
    before = x;
    add_scaled(step, w, x);
    for (std::size_t n = 0; n < w.size(); ++n) w[n] = v[n] - theta / length * w[n];
    // |K^T r| = phi * alpha * |cosine| (Paige and Saunders 1982, 5.1).
    const double gradient = phi * alpha * std::abs(cosine);
    const bool converged = !(gradient > kRounding * first);
    const SolverStep parts = parts_of(stacked_residual(problem, regularisation, x),
                                      problem.b.size(), regularisation.strength);
    if (!iteration.add(parts.misfit, parts.penalty, x, before)) break;
    if (iteration.ends_with_gradient(gradient)) break;
    if (converged) {
      iteration.end(StopReason::converged);
      break;
    }
  }
  return iteration.take(std::move(x));
}

}  // namespace plenoflame
