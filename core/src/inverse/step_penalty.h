#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "inverse/operators/scaled_problem.h"
#include "plenoflame/inverse/linear_operator.h"

namespace plenoflame {

/// The penalty for steps of the free unknowns. Held ones do not move, but their distance from the
/// prior counts in differences to free ones: only the transpose leaves them out.
class StepPenalty final : public LinearOperator {
 public:
  StepPenalty(const LinearOperator& penalty, const std::vector<char>& free)
      : penalty_(penalty), free_(free) {}
  std::size_t rows() const override { return penalty_.rows(); }
  std::size_t columns() const override { return penalty_.columns(); }
  void apply(std::span<const double> x, std::span<double> y) const override {
    penalty_.apply(x, y);
  }
  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    penalty_.apply_transpose(y, x);
    for (std::size_t n = 0; n < x.size(); ++n)
      if (!free_[n]) x[n] = 0;
  }
  double squared_norm(std::span<const double> weights) const override {
    return penalty_.squared_norm(weights);
  }

 private:
  const LinearOperator& penalty_;
  const std::vector<char>& free_;
};

/// Penalties on the parts of the variables, one below the other.
class BlockPenalty final : public LinearOperator {
 public:
  void add(std::unique_ptr<LinearOperator> penalty, double factor) {
    rows_ += penalty->rows();
    columns_ += penalty->columns();
    blocks_.push_back({std::move(penalty), factor});
  }
  std::size_t rows() const override { return rows_; }
  std::size_t columns() const override { return columns_; }
  void apply(std::span<const double> x, std::span<double> y) const override {
    for (const Block& block : blocks_) {
      const auto part = y.first(block.penalty->rows());
      block.penalty->apply(x.first(block.penalty->columns()), part);
      for (double& value : part) value *= block.factor;
      x = x.subspan(block.penalty->columns());
      y = y.subspan(part.size());
    }
  }
  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    for (const Block& block : blocks_) {
      const auto part = x.first(block.penalty->columns());
      block.penalty->apply_transpose(y.first(block.penalty->rows()), part);
      for (double& value : part) value *= block.factor;
      y = y.subspan(block.penalty->rows());
      x = x.subspan(part.size());
    }
  }
  double squared_norm(std::span<const double> weights) const override {
    double sum = 0;
    for (const Block& block : blocks_) {
      const auto own = weights.empty() ? weights : weights.first(block.penalty->rows());
      sum += block.factor * block.factor * block.penalty->squared_norm(own);
      if (!weights.empty()) weights = weights.subspan(block.penalty->rows());
    }
    return sum;
  }

 private:
  struct Block {
    std::unique_ptr<LinearOperator> penalty;
    double factor;
  };
  std::vector<Block> blocks_;
  std::size_t rows_ = 0, columns_ = 0;
};

/// A linearised problem in steps of the variables that are free to move.
struct FreeSteps {
  FreeSteps(const LinearOperator& derivative, const LinearOperator& all, std::vector<char> may_move)
      : free(std::move(may_move)),
        moving(derivative, std::vector<double>(free.begin(), free.end())),
        penalty(all, free) {}
  FreeSteps(const FreeSteps&) = delete;
  FreeSteps& operator=(const FreeSteps&) = delete;

  std::vector<char> free;
  ScaledColumns moving;  ///< J
  StepPenalty penalty;
};

}  // namespace plenoflame
