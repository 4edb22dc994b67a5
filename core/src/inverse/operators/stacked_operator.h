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
    multiply<1>(x, y, &LinearOperator::apply);
  }
  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    multiply_transposed<1>(y, x, &LinearOperator::apply_transpose);
  }
  void apply_together(std::span<const double> x, std::span<double> y) const override {
    multiply<kTogether>(x, y, &LinearOperator::apply_together);
  }
  void apply_transpose_together(std::span<const double> y, std::span<double> x) const override {
    multiply_transposed<kTogether>(y, x, &LinearOperator::apply_transpose_together);
  }

 private:
  using Product = void (LinearOperator::*)(std::span<const double>, std::span<double>) const;

  template <std::size_t count>
  void multiply(std::span<const double> x, std::span<double> y, Product product) const {
    const auto upper = y.first(problem_.a->rows() * count);
    (problem_.a->*product)(x, upper);
    scale_by<count>(problem_.weights, upper);
    if (!penalty_) return;
    const auto lower = y.subspan(upper.size());
    (penalty_->*product)(x, lower);
    for (double& value : lower) value *= scale_;
  }
  template <std::size_t count>
  void multiply_transposed(std::span<const double> y, std::span<double> x, Product product) const {
    const std::size_t rows = problem_.a->rows() * count;
    std::vector<double> upper(y.begin(), y.begin() + static_cast<std::ptrdiff_t>(rows));
    scale_by<count>(problem_.weights, upper);
    (problem_.a->*product)(upper, x);
    if (!penalty_) return;
    std::vector<double> lower(x.size());
    (penalty_->*product)(y.subspan(rows), lower);
    add_scaled(scale_, lower, x);
  }

  LinearProblem problem_;
  const LinearOperator* penalty_;
  double scale_;
};

}  // namespace plenoflame
