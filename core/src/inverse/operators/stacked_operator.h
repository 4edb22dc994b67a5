#pragma once
#include <cmath>

#include "inverse/operators/vector_sums.h"
#include "plenoflame/inverse/solvers.h"

namespace plenoflame {

/// [W A; sqrt(strength) L]: a regularised problem as one of least squares.
class StackedOperator final : public LinearOperator {
 public:
  StackedOperator(const LinearProblem& problem, const Regularisation& regularisation)
      : problem_(problem),
        penalty_(regularisation.penalty),
        scale_(std::sqrt(regularisation.strength)) {}

  std::size_t rows() const override {
    return problem_.a->rows() + (penalty_ ? penalty_->rows() : 0);
  }
  std::size_t columns() const override { return problem_.a->columns(); }
  void apply(std::span<const double> x, std::span<double> y) const override {
    const auto upper = y.first(problem_.a->rows());
    problem_.a->apply(x, upper);
    scale_by(problem_.weights, upper);
    if (!penalty_) return;
    const auto lower = y.subspan(problem_.a->rows());
    penalty_->apply(x, lower);
    for (double& value : lower) value *= scale_;
  }
  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    const std::size_t rows = problem_.a->rows();
    std::vector<double> upper(y.begin(), y.begin() + static_cast<std::ptrdiff_t>(rows));
    scale_by(problem_.weights, upper);
    problem_.a->apply_transpose(upper, x);
    if (!penalty_) return;
    const std::vector<double> lower = transposed_times(*penalty_, y.subspan(rows));
    add_scaled(scale_, lower, x);
  }

 private:
  LinearProblem problem_;
  const LinearOperator* penalty_;
  double scale_;
};

}  // namespace plenoflame
