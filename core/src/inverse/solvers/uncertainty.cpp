#include "plenoflame/inverse/uncertainty.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <random>

#include "inverse/operators/stacked_operator.h"
#include "inverse/solvers/iteration.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

SolverOptions options_of(const ProbeAccuracy& accuracy) {
  SolverOptions options;
  options.iterations = accuracy.iterations;
  options.relative_change = accuracy.relative_change;
  return options;
}

void check(const LinearProblem& problem, const Regularisation& regularisation) {
  check_problem(problem);
  check_regularisation(regularisation, problem.a->columns());
}

/// N^-1 A^T W c for data c that are weighted already: c / W as data of the problem.
std::vector<double> pull_back(const LinearProblem& problem, const Regularisation& regularisation,
                              std::span<const double> c, const ProbeAccuracy& accuracy,
                              const Execution& execution) {
  std::vector<double> b(c.begin(), c.end());
  for (std::size_t i = 0; i < problem.weights.size(); ++i)
    b[i] = problem.weights[i] > 0 ? b[i] / problem.weights[i] : 0;
  const Regularisation without_prior{regularisation.penalty, regularisation.strength};
  return solve_cgls({problem.a, b, problem.weights}, without_prior, options_of(accuracy), execution)
      .x;
}

std::vector<double> weighted_model(const LinearProblem& problem, std::span<const double> x) {
  std::vector<double> y = *problem.a * x;
  scale_by(problem.weights, y);
  return y;
}

/// Standard normal numbers by Box and Muller: std::normal_distribution is not the same everywhere.
class NormalSequence {
 public:
  explicit NormalSequence(std::uint64_t seed) : random_(seed) {}
  std::vector<double> next(std::size_t count) {
    std::vector<double> numbers(count);
    for (double& number : numbers)
      number = std::sqrt(-2 * std::log(uniform())) * std::cos(2 * std::numbers::pi * uniform());
    return numbers;
  }

 private:
  double uniform() { return (static_cast<double>(random_() >> 11) + 0.5) * 0x1p-53; }
  std::mt19937_64 random_;
};

void report(const Execution& execution, int done, int all) {
  if (!execution.progress) return;
  Progress progress;
  progress.fraction = static_cast<double>(done) / all;
  execution.progress(progress);
}

/// |v|^2 of vectors side by side.
using Squares = std::array<double, kTogether>;
Squares squares_of(std::span<const double> vectors) {
  Squares sum{};
  for (std::size_t n = 0; n < vectors.size(); n += kTogether)
    for (std::size_t c = 0; c < kTogether; ++c) sum[c] += vectors[n + c] * vectors[n + c];
  return sum;
}

/// to += factor * of, for each of the vectors side by side.
void add_each(const Squares& factor, std::span<const double> of, std::span<double> to) {
  for (std::size_t n = 0; n < to.size(); n += kTogether)
    for (std::size_t c = 0; c < kTogether; ++c) to[n + c] += factor[c] * of[n + c];
}

/// Conjugate gradients as in solve_cgls(), from 0, for vectors r side by side. One that has ended
/// stays. @return x
std::vector<double> solve_together(const LinearOperator& k, std::vector<double> r,
                                   const ProbeAccuracy& accuracy, const Execution& execution) {
  std::vector<double> x(k.columns() * kTogether), s(x.size()), q(r.size());
  k.apply_transpose_together(r, s);
  std::vector<double> p = s;
  const Squares first = squares_of(s);
  Squares gamma = first;
  std::array<bool, kTogether> ended{};
  for (int i = 0; i < accuracy.iterations; ++i) {
    if (execution.stop.stop_requested()) throw Cancelled();
    k.apply_together(p, q);
    const Squares curvature = squares_of(q), length = squares_of(p);
    Squares step{}, back{}, ratio{};
    for (std::size_t c = 0; c < kTogether; ++c) {
      ended[c] = ended[c] || !(curvature[c] > 0);
      if (!ended[c]) step[c] = gamma[c] / curvature[c];
      back[c] = -step[c];
    }
    add_each(step, p, x);
    add_each(back, q, r);
    k.apply_transpose_together(r, s);
    const Squares next = squares_of(s), reached = squares_of(x);
    for (std::size_t c = 0; c < kTogether; ++c) {
      const double change = step[c] * std::sqrt(length[c] / reached[c]);
      ended[c] = ended[c] || !(change > accuracy.relative_change) ||
                 !(next[c] > kRounding * kRounding * first[c]);
      ratio[c] = ended[c] ? 0 : next[c] / gamma[c];
    }
    if (std::ranges::all_of(ended, [](bool each) { return each; })) break;
    for (std::size_t n = 0; n < p.size(); n += kTogether)
      for (std::size_t c = 0; c < kTogether; ++c)
        p[n + c] = ended[c] ? 0 : s[n + c] + ratio[c] * p[n + c];
    gamma = next;
  }
  return x;
}

/// Solves for `count` right-hand sides, some at a time. make() gives one; use(x) takes its
/// solution.
void solve_each(const LinearOperator& k, int count,
                const std::function<std::vector<double>()>& make,
                const std::function<void(std::span<const double>)>& use,
                const ProbeAccuracy& accuracy, const Execution& execution) {
  constexpr auto kMost = static_cast<int>(kTogether);
  std::vector<double> one(k.columns());
  for (int begin = 0; begin < count; begin += kMost) {
    const auto now = static_cast<std::size_t>(std::min(kMost, count - begin));
    std::vector<double> r(k.rows() * kTogether);
    for (std::size_t c = 0; c < now; ++c) {
      const std::vector<double> made = make();
      for (std::size_t i = 0; i < made.size(); ++i) r[i * kTogether + c] = made[i];
    }
    const std::vector<double> x = solve_together(k, std::move(r), accuracy, execution);
    for (std::size_t c = 0; c < now; ++c) {
      for (std::size_t j = 0; j < one.size(); ++j) one[j] = x[j * kTogether + c];
      use(one);
    }
    report(execution, begin + static_cast<int>(now), count);
  }
}

}  // namespace

Uncertainty estimate_resolution(const LinearProblem& problem, const Regularisation& regularisation,
                                const Draws& probes, const Execution& execution,
                                const ProbeAccuracy& accuracy) {
  check(problem, regularisation);
  if (probes.count < 1) throw UsageError("at least one probe is needed");
  Uncertainty result;
  result.resolved.assign(problem.a->columns(), 0.0);
  const StackedOperator stacked(problem, {regularisation.penalty, regularisation.strength});
  SignSequence signs(probes.seed + 1);
  std::deque<std::vector<double>> made;
  const auto make = [&] {
    std::vector<double> z(problem.a->columns());
    for (double& value : z) value = signs.next();
    std::vector<double> r = weighted_model(problem, z);
    made.push_back(std::move(z));
    return r;
  };
  // z * (R z) has the mean diag(R) over random signs.
  const auto use = [&](std::span<const double> x) {
    for (std::size_t j = 0; j < x.size(); ++j)
      result.resolved[j] += made.front()[j] * x[j] / probes.count;
    made.pop_front();
  };
  solve_each(stacked, probes.count, make, use, accuracy, execution);
  for (const double value : result.resolved) result.resolved_unknowns += value;
  return result;
}

void draw_posterior(const LinearProblem& problem, const Regularisation& regularisation,
                    const Draws& draws, const std::function<void(std::span<const double>)>& use,
                    const Execution& execution, const ProbeAccuracy& accuracy) {
  check(problem, regularisation);
  if (draws.count < 1) throw UsageError("at least one draw is needed");
  const StackedOperator stacked(problem, regularisation);
  NormalSequence random(draws.seed);
  const auto make = [&] {
    std::vector<double> noise = random.next(stacked.rows());
    for (std::size_t i = 0; i < problem.weights.size(); ++i)
      if (!(problem.weights[i] > 0)) noise[i] = 0;
    return noise;
  };
  solve_each(stacked, draws.count, make, use, accuracy, execution);
}

void draw_prior(const Regularisation& regularisation, const Draws& draws,
                const std::function<void(std::span<const double>)>& use, const Execution& execution,
                const ProbeAccuracy& accuracy) {
  if (!regularisation.penalty || !(regularisation.strength > 0) || draws.count < 1)
    throw UsageError("draws of a prior need a penalty with a strength, and at least one draw");
  NormalSequence random(draws.seed);
  const auto make = [&] {
    std::vector<double> noise = random.next(regularisation.penalty->rows());
    for (double& value : noise) value /= std::sqrt(regularisation.strength);
    return noise;
  };
  solve_each(*regularisation.penalty, draws.count, make, use, accuracy, execution);
}

Uncertainty exact_uncertainty(const LinearProblem& problem, const Regularisation& regularisation) {
  check(problem, regularisation);
  const std::size_t columns = problem.a->columns();
  if (columns > kMostDense)
    throw UsageError("exact uncertainties are for at most " + std::to_string(kMostDense) +
                     " unknowns; there are " + std::to_string(columns) + ": take probes");
  const auto n = static_cast<Eigen::Index>(columns);
  Eigen::MatrixXd data = Eigen::MatrixXd::Zero(n, n), normal(n, n);
  std::vector<double> unit(columns, 0.0);
  const StackedOperator a(problem, {}), stacked(problem, regularisation);
  const auto column = [&](const LinearOperator& k) {
    const std::vector<double> y = transposed_times(k, k * unit);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(y.data(), n));
  };
  for (Eigen::Index j = 0; j < n; ++j) {
    unit[static_cast<std::size_t>(j)] = 1;
    data.col(j) = column(a);
    normal.col(j) = regularisation.penalty ? column(stacked) : data.col(j);
    unit[static_cast<std::size_t>(j)] = 0;
  }
  const Eigen::LDLT<Eigen::MatrixXd> inverse(normal);
  const Eigen::MatrixXd resolution = inverse.solve(data);
  const Eigen::MatrixXd covariance = inverse.solve(Eigen::MatrixXd::Identity(n, n));
  Uncertainty result;
  for (Eigen::Index j = 0; j < n; ++j) {
    result.resolved.push_back(resolution(j, j));
    result.deviation.push_back(std::sqrt(std::max(0.0, covariance(j, j))));
  }
  result.resolved_unknowns = resolution.trace();
  return result;
}

std::vector<double> point_spread(const LinearProblem& problem, const Regularisation& regularisation,
                                 std::size_t unknown, const Execution& execution,
                                 const ProbeAccuracy& accuracy) {
  check(problem, regularisation);
  std::vector<double> unit(problem.a->columns(), 0.0);
  if (unknown >= unit.size())
    throw UsageError("there is no unknown " + std::to_string(unknown) + " among " +
                     std::to_string(unit.size()));
  unit[unknown] = 1;
  return pull_back(problem, regularisation, weighted_model(problem, unit), accuracy, execution);
}

std::array<double, 3> half_widths(std::span<const double> values, const std::array<int, 3>& shape,
                                  const std::array<double, 3>& spacing, std::size_t unknown) {
  const auto n1 = static_cast<std::size_t>(shape[1]), n2 = static_cast<std::size_t>(shape[2]);
  const std::array<std::size_t, 3> stride{n1 * n2, n2, 1};
  const std::array<std::size_t, 3> at{unknown / (n1 * n2), unknown / n2 % n1, unknown % n2};
  const double half = 0.5 * values[unknown];
  std::array<double, 3> widths{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (shape[a] < 2) continue;
    const auto reach = [&](bool up) {
      const std::size_t steps = up ? static_cast<std::size_t>(shape[a]) - 1 - at[a] : at[a];
      for (std::size_t k = 1; k <= steps; ++k) {
        const auto value = [&](std::size_t n) {
          return values[up ? unknown + n * stride[a] : unknown - n * stride[a]];
        };
        if (!(value(k) < half)) continue;
        const double before = value(k - 1);
        return static_cast<double>(k - 1) + (before - half) / (before - value(k));
      }
      return std::numeric_limits<double>::infinity();
    };
    widths[a] = (reach(true) + reach(false)) * spacing[a];
  }
  return widths;
}

}  // namespace plenoflame
