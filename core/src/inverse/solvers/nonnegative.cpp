#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "inverse/operators/stacked_operator.h"
#include "inverse/solvers/iteration.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// Power iterations come from below: the step is that much shorter.
constexpr double kRoom = 1.02;

/// [W (b - A x); L (prior - x)], which are affine in x: what momentum does to x it does to them.
struct Residuals {
  std::vector<double> data, penalty;

  Residuals(const LinearProblem& problem, const Regularisation& regularisation,
            std::span<const double> x)
      : data(weighted_residual(problem, x)) {
    if (!regularisation.penalty) return;
    std::vector<double> difference(x.begin(), x.end());
    for (std::size_t j = 0; j < regularisation.prior.size(); ++j)
      difference[j] -= regularisation.prior[j];
    penalty = *regularisation.penalty * difference;
    for (double& value : penalty) value = -value;
  }
  /// The residuals of x + factor * (x - before).
  Residuals ahead(double factor, const Residuals& before) const {
    Residuals result = *this;
    for (std::size_t i = 0; i < data.size(); ++i)
      result.data[i] += factor * (data[i] - before.data[i]);
    for (std::size_t i = 0; i < penalty.size(); ++i)
      result.penalty[i] += factor * (penalty[i] - before.penalty[i]);
    return result;
  }
  /// Half of the objective's gradient.
  std::vector<double> gradient(const LinearProblem& problem,
                               const Regularisation& regularisation) const {
    std::vector<double> weighted = data;
    scale_by(problem.weights, weighted);
    std::vector<double> g = transposed_times(*problem.a, weighted);
    for (double& value : g) value = -value;
    if (regularisation.penalty)
      add_scaled(-regularisation.strength, transposed_times(*regularisation.penalty, penalty), g);
    return g;
  }
};

Eigen::VectorXd at_columns(const Eigen::MatrixXd& k, const Eigen::VectorXd& d,
                           const std::vector<Eigen::Index>& passive) {
  Eigen::MatrixXd part(k.rows(), static_cast<Eigen::Index>(passive.size()));
  for (std::size_t j = 0; j < passive.size(); ++j)
    part.col(static_cast<Eigen::Index>(j)) = k.col(passive[j]);
  return part.colPivHouseholderQr().solve(d);
}

}  // namespace

Solution solve_nnls(const LinearProblem& problem, const Regularisation& regularisation,
                    const SolverOptions& options, const Execution& execution) {
  check_problem(problem);
  const std::size_t columns = problem.a->columns();
  check_options(options, columns);
  check_regularisation(regularisation, columns);
  const double largest = largest_singular_value(StackedOperator(problem, regularisation), {},
                                                kPowerIterations, execution.stop);
  std::vector<double> x = options.start.empty() ? std::vector<double>(columns, 0.0) : options.start;
  for (double& value : x) value = std::max(value, 0.0);
  Iteration iteration(options, execution);
  if (!(largest > 0)) {
    iteration.end(StopReason::converged);
    return iteration.take(std::move(x));
  }
  const double step = 1 / (kRoom * largest * largest);
  std::vector<double> momentum = x, before(columns);
  Residuals here(problem, regularisation, x), ahead = here;
  double t = 1;
  for (int i = 0; i < options.iterations; ++i) {
    const std::vector<double> gradient = ahead.gradient(problem, regularisation);
    before = x;
    double turned = 0, moved = 0;
    for (std::size_t j = 0; j < columns; ++j) {
      x[j] = std::max(0.0, momentum[j] - step * gradient[j]);
      turned += (momentum[j] - x[j]) * (x[j] - before[j]);
      moved += (momentum[j] - x[j]) * (momentum[j] - x[j]);
    }
    // Gradient scheme: momentum that points uphill is given up.
    const double next = turned > 0 ? 1 : (1 + std::sqrt(1 + 4 * t * t)) / 2;
    const double factor = turned > 0 ? 0 : (t - 1) / next;
    t = next;
    for (std::size_t j = 0; j < columns; ++j) momentum[j] = x[j] + factor * (x[j] - before[j]);
    const Residuals now(problem, regularisation, x);
    ahead = now.ahead(factor, here);
    here = now;
    if (!iteration.add(dot(here.data, here.data), dot(here.penalty, here.penalty), x, before))
      break;
    // The gradient of what x >= 0 does not hold is the step over its length.
    if (iteration.ends_with_gradient(std::sqrt(moved) / step)) break;
  }
  return iteration.take(std::move(x));
}

Solution solve_nnls_active_set(const LinearProblem& problem, const Regularisation& regularisation,
                               const Execution& execution) {
  check_problem(problem);
  const std::size_t columns = problem.a->columns();
  check_regularisation(regularisation, columns);
  if (columns > kMostActiveSet)
    throw UsageError("active sets are for at most " + std::to_string(kMostActiveSet) +
                     " unknowns; there are " + std::to_string(columns) + ": take nnls");
  const StackedOperator stacked(problem, regularisation);
  const auto n = static_cast<Eigen::Index>(columns), m = static_cast<Eigen::Index>(stacked.rows());
  Eigen::MatrixXd k(m, n);
  std::vector<double> unit(columns, 0.0), column(stacked.rows());
  for (std::size_t j = 0; j < columns; ++j) {
    unit[j] = 1;
    stacked.apply(unit, column);
    unit[j] = 0;
    k.col(static_cast<Eigen::Index>(j)) = Eigen::Map<const Eigen::VectorXd>(column.data(), m);
  }
  Eigen::VectorXd d = Eigen::VectorXd::Zero(m);
  for (std::size_t i = 0; i < problem.b.size(); ++i) {
    const double w = problem.weights.empty() ? 1 : problem.weights[i];
    if (w > 0) d[static_cast<Eigen::Index>(i)] = w * problem.b[i];
  }
  if (regularisation.penalty && !regularisation.prior.empty()) {
    const std::vector<double> rows = *regularisation.penalty * regularisation.prior;
    for (std::size_t i = 0; i < rows.size(); ++i)
      d[static_cast<Eigen::Index>(problem.b.size() + i)] =
          std::sqrt(regularisation.strength) * rows[i];
  }

  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<char> is_passive(columns, 0);
  const auto passive_set = [&] {
    std::vector<Eigen::Index> set;
    for (Eigen::Index j = 0; j < n; ++j)
      if (is_passive[static_cast<std::size_t>(j)]) set.push_back(j);
    return set;
  };
  SolverOptions options;
  options.iterations = 3 * static_cast<int>(columns) + 1;
  options.relative_change = 0;
  Iteration iteration(options, execution);
  const double rounding =
      64 * std::numeric_limits<double>::epsilon() * (k.transpose() * d).cwiseAbs().maxCoeff();
  iteration.end(StopReason::converged);
  std::vector<char> refused(columns, 0);  // candidates that came out negative at once
  while (true) {
    const Eigen::VectorXd gradient = k.transpose() * (d - k * x);
    Eigen::Index best = -1;
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto at = static_cast<std::size_t>(j);
      if (!is_passive[at] && !refused[at] && gradient[j] > rounding &&
          (best < 0 || gradient[j] > gradient[best]))
        best = j;
    }
    if (best < 0) break;
    is_passive[static_cast<std::size_t>(best)] = 1;
    const Eigen::VectorXd before = x;
    for (auto set = passive_set(); !set.empty(); set = passive_set()) {
      const Eigen::VectorXd s = at_columns(k, d, set);
      double share = 1;
      for (std::size_t i = 0; i < set.size(); ++i) {
        const double value = s[static_cast<Eigen::Index>(i)];
        if (value <= 0) share = std::min(share, x[set[i]] / (x[set[i]] - value));
      }
      const bool whole = (s.array() > 0).all();
      for (std::size_t i = 0; i < set.size(); ++i) {
        const double value = s[static_cast<Eigen::Index>(i)];
        x[set[i]] = whole ? value : x[set[i]] + share * (value - x[set[i]]);
        if (!whole && value <= 0 &&
            x[set[i]] <= 16 * std::numeric_limits<double>::epsilon() * std::abs(value)) {
          x[set[i]] = 0;
          is_passive[static_cast<std::size_t>(set[i])] = 0;
        }
      }
      if (whole) break;
    }
    if (is_passive[static_cast<std::size_t>(best)])
      std::fill(refused.begin(), refused.end(), char{0});
    else
      refused[static_cast<std::size_t>(best)] = 1;
    const auto as_span = [](const Eigen::VectorXd& v) {
      return std::span<const double>(v.data(), static_cast<std::size_t>(v.size()));
    };
    const std::vector<double> r = weighted_residual(problem, as_span(x));
    if (!iteration.add(dot(r, r), penalty_of(regularisation, as_span(x)), as_span(x),
                       as_span(before)))
      break;
    iteration.end(StopReason::converged);
  }
  return iteration.take(std::vector<double>(x.data(), x.data() + x.size()));
}

}  // namespace plenoflame
