#include "plenoflame/inverse/gauss_newton.h"

#include <algorithm>
#include <limits>

#include "inverse/solvers/iteration.h"
#include "inverse/step_penalty.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr double kFirstDamping = 1e-3;  ///< of the mean curvature
constexpr double kLessDamping = 0.2, kMoreDamping = 5;
constexpr int kMostRefusals = 20;
constexpr int kInnerIterations = 200;
constexpr double kInnerChange = 1e-6;
constexpr double kStepRounding = 1e3 * std::numeric_limits<double>::epsilon();

/// [J on the free unknowns; sqrt(damping) I], whose rows below keep steps short.
class DampedDerivative final : public LinearOperator {
 public:
  DampedDerivative(const LinearOperator& j, const std::vector<char>& free, double damping)
      : j_(j), free_(free), root_(std::sqrt(damping)) {}
  std::size_t rows() const override { return j_.rows() + j_.columns(); }
  std::size_t columns() const override { return j_.columns(); }
  void apply(std::span<const double> x, std::span<double> y) const override {
    std::vector<double> part(x.begin(), x.end());
    for (std::size_t n = 0; n < part.size(); ++n)
      if (!free_[n]) part[n] = 0;
    j_.apply(part, y.first(j_.rows()));
    for (std::size_t n = 0; n < part.size(); ++n) y[j_.rows() + n] = root_ * part[n];
  }
  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    j_.apply_transpose(y.first(j_.rows()), x);
    for (std::size_t n = 0; n < x.size(); ++n)
      x[n] = free_[n] ? x[n] + root_ * y[j_.rows() + n] : 0;
  }

 private:
  const LinearOperator& j_;
  const std::vector<char>& free_;
  double root_;
};

class GaussNewton {
 public:
  GaussNewton(const NonlinearProblem& problem, const Regularisation& regularisation)
      : problem_(problem), regularisation_(regularisation) {}

  void bring_inside(std::vector<double>& x) const {
    for (std::size_t n = 0; n < problem_.lower.size(); ++n)
      x[n] = std::max(x[n], problem_.lower[n]);
    for (std::size_t n = 0; n < problem_.upper.size(); ++n)
      x[n] = std::min(x[n], problem_.upper[n]);
  }

  /// W (b - f(x)).
  std::vector<double> residual(std::span<const double> x) const {
    std::vector<double> r = problem_.model(x);
    if (r.size() != problem_.b.size())
      throw UsageError("the model gives " + std::to_string(r.size()) + " values for " +
                       std::to_string(problem_.b.size()) + " data");
    for (std::size_t i = 0; i < r.size(); ++i) {
      const double w = weight(i);
      r[i] = w > 0 ? w * (problem_.b[i] - r[i]) : 0;
    }
    return r;
  }

  double objective(double misfit, std::span<const double> x) const {
    return misfit + regularisation_.strength * penalty_of(regularisation_, x);
  }

  /// -1/2 of the objective's gradient.
  std::vector<double> downhill(const LinearOperator& j, std::vector<double> r,
                               std::span<const double> x) const {
    scale_by(problem_.weights, r);
    std::vector<double> g = transposed_times(j, r);
    if (regularisation_.penalty)
      add_scaled(
          -regularisation_.strength,
          transposed_times(*regularisation_.penalty, *regularisation_.penalty * from_prior(x)), g);
    return g;
  }

  /// Unknowns that are not held at a bound by the gradient.
  std::vector<char> free_ones(std::span<const double> x, std::span<const double> downhill) const {
    std::vector<char> free(x.size(), 1);
    for (std::size_t n = 0; n < x.size(); ++n) {
      const bool low = !problem_.lower.empty() && x[n] <= problem_.lower[n] && downhill[n] < 0;
      const bool high = !problem_.upper.empty() && x[n] >= problem_.upper[n] && downhill[n] > 0;
      if (low || high) free[n] = 0;
    }
    return free;
  }

  /// The damped step from x.
  std::vector<double> step(const LinearOperator& j, std::span<const double> r,
                           std::span<const double> x, const std::vector<char>& free, double damping,
                           const Execution& execution) const {
    const DampedDerivative damped(j, free, damping);
    std::vector<double> data(damped.rows(), 0.0), weights(damped.rows(), 1.0);
    for (std::size_t i = 0; i < r.size(); ++i) {
      weights[i] = weight(i);
      data[i] = weights[i] > 0 ? r[i] / weights[i] : 0;
    }
    SolverOptions inner;
    inner.iterations = kInnerIterations;
    inner.relative_change = kInnerChange;
    if (!regularisation_.penalty)
      return solve_cgls({&damped, data, weights}, {}, inner, execution).x;
    // L (x + d - prior) is small: the step's own prior is prior - x, held unknowns included.
    std::vector<double> prior = from_prior(x);
    for (double& value : prior) value = -value;
    const StepPenalty penalty(*regularisation_.penalty, free);
    return solve_cgls({&damped, data, weights}, {&penalty, regularisation_.strength, prior}, inner,
                      execution)
        .x;
  }

 private:
  double weight(std::size_t i) const { return problem_.weights.empty() ? 1 : problem_.weights[i]; }

  std::vector<double> from_prior(std::span<const double> x) const {
    std::vector<double> difference(x.begin(), x.end());
    for (std::size_t n = 0; n < regularisation_.prior.size(); ++n)
      difference[n] -= regularisation_.prior[n];
    return difference;
  }

  const NonlinearProblem& problem_;
  const Regularisation& regularisation_;
};

}  // namespace

Solution solve_gauss_newton(const NonlinearProblem& problem, const Regularisation& regularisation,
                            const SolverOptions& options, const Execution& execution) {
  if (options.start.empty()) throw UsageError("a problem that is not linear needs a start");
  const std::size_t columns = options.start.size();
  check_regularisation(regularisation, columns);
  if ((!problem.lower.empty() && problem.lower.size() != columns) ||
      (!problem.upper.empty() && problem.upper.size() != columns))
    throw UsageError("bounds and start have different numbers of unknowns");
  const GaussNewton method(problem, regularisation);
  Execution inner;  // inner steps report nothing
  inner.threads = execution.threads;
  inner.stop = execution.stop;
  std::vector<double> x = options.start;
  method.bring_inside(x);
  Iteration iteration(options, execution);
  try {
    std::vector<double> r = method.residual(x);
    double misfit = dot(r, r), objective = method.objective(misfit, x);
    double damping = -1;
    for (int n = 0; n < options.iterations; ++n) {
      const auto j = problem.derivative(x);
      const std::vector<double> g = method.downhill(*j, r, x);
      const std::vector<char> free = method.free_ones(x, g);
      double uphill = 0;
      for (std::size_t k = 0; k < columns; ++k)
        if (free[k]) uphill += g[k] * g[k];
      if (damping < 0)
        damping = kFirstDamping * j->squared_norm(problem.weights) / static_cast<double>(columns);
      bool better = false;
      const std::vector<double> before = x;
      for (int refusal = 0; refusal < kMostRefusals && uphill > 0 && !better; ++refusal) {
        std::vector<double> tried = before;
        add_scaled(1, method.step(*j, r, before, free, damping, inner), tried);
        method.bring_inside(tried);
        const std::vector<double> next = method.residual(tried);
        const double next_misfit = dot(next, next), value = method.objective(next_misfit, tried);
        better = value < objective * (1 - kStepRounding) || (value < objective && refusal == 0);
        if (better) {
          x = tried;
          r = next;
          misfit = next_misfit;
          objective = value;
          damping *= kLessDamping;
        } else {
          damping *= kMoreDamping;
          if (execution.stop.stop_requested()) throw Cancelled();
        }
      }
      if (!better) {
        iteration.end(StopReason::converged);
        break;
      }
      if (!iteration.add(misfit, penalty_of(regularisation, x), x, before)) break;
    }
  } catch (const Cancelled&) {
    // Within a step: the one before it is what was reached.
    iteration.end(StopReason::stopped);
  }
  return iteration.take(std::move(x));
}

}  // namespace plenoflame
