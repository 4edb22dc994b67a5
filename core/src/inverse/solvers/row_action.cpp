#include <algorithm>

#include "inverse/solvers/iteration.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// A subset with its sums of rows and columns, weighted.
struct Subset {
  const LinearProblem* problem = nullptr;
  std::vector<double> row_factor;     ///< w_i / sum of row i; 0 for rows that count nothing
  std::vector<double> column_factor;  ///< 1 / sum of column j; 0 for columns without entries
  double weight_of(std::size_t row) const {
    return problem->weights.empty() ? 1 : problem->weights[row];
  }
};

std::vector<double> ones(std::size_t count) {
  return std::vector<double>(count, 1.0);
}

void check(std::span<const LinearProblem> subsets, const SolverOptions& options) {
  if (subsets.empty()) throw UsageError("give the solver at least one subset of the rows");
  for (const LinearProblem& problem : subsets) {
    check_problem(problem);
    if (problem.a->columns() != subsets[0].a->columns())
      throw UsageError("subsets of rows have different numbers of columns");
  }
  check_options(options, subsets[0].a->columns());
}

Subset make_subset(const LinearProblem& problem) {
  Subset subset;
  subset.problem = &problem;
  subset.row_factor = *problem.a * ones(problem.a->columns());
  std::vector<double> weights(problem.a->rows());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double sum = subset.row_factor[i];
    if (sum < 0) throw InputError("this solver wants an operator without negative entries");
    weights[i] = sum > 0 ? subset.weight_of(i) : 0;
    subset.row_factor[i] = sum > 0 ? weights[i] / sum : 0;
  }
  subset.column_factor = transposed_times(*problem.a, weights);
  for (double& sum : subset.column_factor) sum = sum > 0 ? 1 / sum : 0;
  return subset;
}

/// Sum over all subsets of |W (A x - b)|^2.
double misfit_of(std::span<const LinearProblem> subsets, std::span<const double> x,
                 double background = 0) {
  double sum = 0;
  for (const LinearProblem& problem : subsets) {
    std::vector<double> r = *problem.a * x;
    for (std::size_t i = 0; i < r.size(); ++i) {
      const double w = problem.weights.empty() ? 1 : problem.weights[i];
      if (w > 0)
        sum += (w * (r[i] + background - problem.b[i])) * (w * (r[i] + background - problem.b[i]));
    }
  }
  return sum;
}

}  // namespace

Solution solve_sirt(std::span<const LinearProblem> subsets, double relaxation,
                    const SolverOptions& options, const Execution& execution) {
  check(subsets, options);
  if (!(relaxation > 0 && relaxation < 2)) throw UsageError("the relaxation lies between 0 and 2");
  std::vector<Subset> prepared;
  for (const LinearProblem& problem : subsets) prepared.push_back(make_subset(problem));
  const std::size_t columns = subsets[0].a->columns();
  std::vector<double> x = options.start.empty() ? std::vector<double>(columns, 0.0) : options.start;
  std::vector<double> before(columns);
  Iteration iteration(options, execution);
  for (int n = 0; n < options.iterations; ++n) {
    before = x;
    for (const Subset& subset : prepared) {
      std::vector<double> r = *subset.problem->a * x;
      for (std::size_t i = 0; i < r.size(); ++i)
        r[i] = subset.row_factor[i] > 0 ? subset.row_factor[i] * (subset.problem->b[i] - r[i]) : 0;
      const std::vector<double> back = transposed_times(*subset.problem->a, r);
      for (std::size_t j = 0; j < columns; ++j)
        x[j] = std::max(0.0, x[j] + relaxation * subset.column_factor[j] * back[j]);
    }
    if (!iteration.add(misfit_of(subsets, x), 0, x, before)) break;
  }
  return iteration.take(std::move(x));
}

Solution solve_mlem(std::span<const LinearProblem> subsets, double background,
                    const SolverOptions& options, const Execution& execution) {
  check(subsets, options);
  if (!(background >= 0)) throw UsageError("the background may not be negative");
  std::vector<std::vector<double>> sensitivity;
  for (const LinearProblem& problem : subsets) {
    std::vector<double> counted(problem.a->rows());
    for (std::size_t i = 0; i < counted.size(); ++i) {
      counted[i] = problem.weights.empty() || problem.weights[i] > 0 ? 1 : 0;
      if (counted[i] > 0 && problem.b[i] < 0)
        throw InputError("the data of row " + std::to_string(i) +
                         " are negative, which counts of photons are not: take nnls or sirt");
    }
    sensitivity.push_back(transposed_times(*problem.a, counted));
  }
  const std::size_t columns = subsets[0].a->columns();
  std::vector<double> x = options.start.empty() ? ones(columns) : options.start;
  std::vector<double> before(columns);
  Iteration iteration(options, execution);
  for (int n = 0; n < options.iterations; ++n) {
    before = x;
    for (std::size_t k = 0; k < subsets.size(); ++k) {
      const LinearProblem& problem = subsets[k];
      std::vector<double> ratio = *problem.a * x;
      for (std::size_t i = 0; i < ratio.size(); ++i) {
        const bool counts = problem.weights.empty() || problem.weights[i] > 0;
        const double expected = ratio[i] + background;
        ratio[i] = counts && expected > 0 ? problem.b[i] / expected : 0;
      }
      const std::vector<double> back = transposed_times(*problem.a, ratio);
      for (std::size_t j = 0; j < columns; ++j)
        if (sensitivity[k][j] > 0) x[j] *= back[j] / sensitivity[k][j];
    }
    if (!iteration.add(misfit_of(subsets, x, background), 0, x, before)) break;
  }
  return iteration.take(std::move(x));
}

Solution solve_mart(const CsrMatrix<float>& matrix, std::span<const double> b, double least,
                    double relaxation, const SolverOptions& options, const Execution& execution) {
  const auto a = make_csr_operator(matrix, execution.threads_only());
  const LinearProblem problem{a.get(), b};
  check_problem(problem);
  check_options(options, matrix.columns());
  if (!(relaxation > 0 && relaxation <= 1))
    throw UsageError("the relaxation lies above 0 and is at most 1");
  if (!(least >= 0)) throw UsageError("the least value that corrects is at least 0");
  const auto values = matrix.values();
  if (std::any_of(values.begin(), values.end(), [](float value) { return value < 0; }))
    throw InputError("this solver wants an operator without negative entries");
  std::vector<double> x = options.start.empty() ? ones(matrix.columns()) : options.start;
  std::vector<double> before(x.size());
  Iteration iteration(options, execution);
  for (int n = 0; n < options.iterations; ++n) {
    before = x;
    for (std::size_t row = 0; row < matrix.rows(); ++row) {
      if (b[row] < least) continue;
      const auto begin = static_cast<std::size_t>(matrix.row_starts()[row]);
      const auto end = static_cast<std::size_t>(matrix.row_starts()[row + 1]);
      double sum = 0, largest = 0;
      for (std::size_t k = begin; k < end; ++k) {
        const auto value = static_cast<double>(values[k]);
        sum += value * x[static_cast<std::size_t>(matrix.column_indices()[k])];
        largest = std::max(largest, value);
      }
      if (!(sum > 0) || !(largest > 0)) continue;
      for (std::size_t k = begin; k < end; ++k) {
        double& value = x[static_cast<std::size_t>(matrix.column_indices()[k])];
        const auto share = static_cast<double>(values[k]) / largest;
        if (share > 0) value *= std::pow(b[row] / sum, relaxation * share);
      }
    }
    const std::vector<double> r = weighted_residual(problem, x);
    if (!iteration.add(dot(r, r), 0, x, before)) break;
  }
  return iteration.take(std::move(x));
}

}  // namespace plenoflame
