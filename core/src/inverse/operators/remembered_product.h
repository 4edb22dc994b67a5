#pragma once
#include <algorithm>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "plenoflame/inverse/linear_operator.h"

namespace plenoflame {

/// An operator that remembers its last product A x. A product takes long where rays are followed
/// again. After a stop, nearly every solver has just multiplied the vector that it returns.
class RememberedProduct final : public LinearOperator {
 public:
  /// @param a must outlive it
  explicit RememberedProduct(const LinearOperator& a) : a_(a) {}
  std::size_t rows() const override { return a_.rows(); }
  std::size_t columns() const override { return a_.columns(); }
  void apply(std::span<const double> x, std::span<double> y) const override {
    a_.apply(x, y);
    const std::scoped_lock lock(mutex_);
    x_.assign(x.begin(), x.end());
    y_.assign(y.begin(), y.end());
  }
  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    a_.apply_transpose(y, x);
  }
  double squared_norm(std::span<const double> weights) const override {
    return a_.squared_norm(weights);
  }
  /// A x, where that was the last product.
  std::optional<std::vector<double>> of(std::span<const double> x) const {
    const std::scoped_lock lock(mutex_);
    if (!std::equal(x.begin(), x.end(), x_.begin(), x_.end())) return std::nullopt;
    return y_;
  }

 private:
  const LinearOperator& a_;
  mutable std::mutex mutex_;
  mutable std::vector<double> x_, y_;
};

}  // namespace plenoflame
