#include "inverse/solvers/iteration.h"

#include "plenoflame/base/error.h"

namespace plenoflame {

std::string name_of(StopReason reason) {
  switch (reason) {
    case StopReason::iterations:
      return "iterations";
    case StopReason::discrepancy:
      return "discrepancy";
    case StopReason::change:
      return "change";
    case StopReason::converged:
      return "converged";
    case StopReason::stopped:
      return "stopped";
  }
  return "";
}

void check_problem(const LinearProblem& problem) {
  if (!problem.a) throw UsageError("a linear problem needs its operator");
  const std::size_t rows = problem.a->rows();
  if (problem.b.size() != rows)
    throw UsageError("the data have " + std::to_string(problem.b.size()) +
                     " entries for an operator of " + std::to_string(rows) + " rows");
  if (!problem.weights.empty() && problem.weights.size() != rows)
    throw UsageError("there are " + std::to_string(problem.weights.size()) + " weights for " +
                     std::to_string(rows) + " rows");
  for (std::size_t i = 0; i < rows; ++i) {
    const double w = problem.weights.empty() ? 1 : problem.weights[i];
    if (!std::isfinite(w) || w < 0)
      throw InputError("the weight of row " + std::to_string(i) + " is not a number of at least 0");
    if (w > 0 && !std::isfinite(problem.b[i]))
      throw InputError("the data of row " + std::to_string(i) +
                       " are no number; give the row the weight 0 to leave it out");
  }
}

void check_options(const SolverOptions& options, std::size_t columns) {
  if (options.iterations < 0) throw UsageError("the number of iterations may not be negative");
  if (!options.start.empty() && options.start.size() != columns)
    throw UsageError("the start has " + std::to_string(options.start.size()) + " entries for " +
                     std::to_string(columns) + " unknowns");
}

void check_regularisation(const Regularisation& regularisation, std::size_t columns) {
  if (!std::isfinite(regularisation.strength) || regularisation.strength < 0)
    throw UsageError("the strength of a penalty is a number of at least 0");
  if (regularisation.penalty && regularisation.penalty->columns() != columns)
    throw UsageError("the penalty is for " + std::to_string(regularisation.penalty->columns()) +
                     " unknowns, the problem has " + std::to_string(columns));
  if (!regularisation.prior.empty() && regularisation.prior.size() != columns)
    throw UsageError("the prior has " + std::to_string(regularisation.prior.size()) +
                     " entries for " + std::to_string(columns) + " unknowns");
}

std::vector<double> weighted_residual(const LinearProblem& problem, std::span<const double> x) {
  std::vector<double> r = *problem.a * x;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double w = problem.weights.empty() ? 1 : problem.weights[i];
    r[i] = w > 0 ? w * (problem.b[i] - r[i]) : 0;
  }
  return r;
}

double penalty_of(const Regularisation& regularisation, std::span<const double> x) {
  if (!regularisation.penalty) return 0;
  std::vector<double> difference(x.begin(), x.end());
  for (std::size_t j = 0; j < regularisation.prior.size(); ++j)
    difference[j] -= regularisation.prior[j];
  const std::vector<double> rows = *regularisation.penalty * difference;
  return dot(rows, rows);
}

bool Iteration::add(double misfit, double penalty, std::span<const double> x,
                    std::span<const double> before) {
  double change = 0;
  for (std::size_t j = 0; j < x.size(); ++j) change += (x[j] - before[j]) * (x[j] - before[j]);
  const double length = norm(x);
  const int number = static_cast<int>(solution_.history.size()) + 1;
  const double relative = length > 0 ? std::sqrt(change) / length : 0;
  solution_.history.push_back({number, misfit, penalty, relative});
  if (options_.kept) {
    options_.kept->x.assign(x.begin(), x.end());
    options_.kept->history.push_back(solution_.history.back());
  }
  if (options_.watch) options_.watch(number, misfit, x);
  if (execution_.progress) {
    Progress progress;
    progress.fraction = static_cast<double>(number) / std::max(1, options_.iterations);
    execution_.progress(progress);
  }
  if (execution_.stop.stop_requested())
    solution_.reason = StopReason::stopped;
  else if (options_.misfit > 0 && misfit <= options_.misfit)
    solution_.reason = StopReason::discrepancy;
  else if (options_.relative_change > 0 && relative <= options_.relative_change)
    solution_.reason = StopReason::change;
  else if (number >= options_.iterations)
    solution_.reason = StopReason::iterations;
  else
    return true;
  return false;
}

}  // namespace plenoflame
