#include "inverse/operators/own_rows.h"

#include <algorithm>
#include <utility>

#include "inverse/operators/csr_parts.h"
#include "inverse/operators/worthwhile_threads.h"

namespace plenoflame {

OwnRows::OwnRows(CsrMatrix<float> matrix, const Execution& execution)
    : matrix_(std::move(matrix)),
      execution_(worthwhile_threads(matrix_, execution.threads_only())),
      operator_(make_csr_operator(matrix_, execution_)) {}

void OwnRows::set_parts(const std::vector<std::size_t>& first) {
  bounds_ = {0};
  for (const std::size_t row : first)
    if (row > bounds_.back()) bounds_.push_back(row);
  goes_on_ = first.empty() || first.front() > 0;
  stays_open_ = first.empty() || first.back() < matrix_.rows();
  if (stays_open_ && matrix_.rows() > 0) bounds_.push_back(matrix_.rows());
  sums_.resize(bounds_.size() - 1);
}

std::vector<double> OwnRows::times(std::span<const double> x) const {
  return *operator_ * x;
}

std::vector<double> OwnRows::squares() const {
  std::vector<double> squares(matrix_.rows());
  for (std::size_t row = 0; row < squares.size(); ++row) squares[row] = square_of_row(matrix_, row);
  return squares;
}

void OwnRows::sum_up(std::span<const double> y) {
  y_.assign(y.begin(), y.end());
  parallel_for(execution_, sums_.size(), [&](std::size_t k, int) {
    if (k == 0 && goes_on_) return;
    sums_[k].assign(matrix_.columns(), 0.0);
    add_transposed(matrix_, bounds_[k], bounds_[k + 1], y_, std::span<double>(sums_[k]));
  });
}

void OwnRows::add_to(TransposedSum& sum) {
  if (sums_.empty()) return;
  if (goes_on_) {
    add_transposed(matrix_, 0, bounds_[1], y_, std::span<double>(sum.open));
    sums_[0] = std::exchange(sum.open, {});
  }
  constexpr std::size_t kColumnsOfTask = 1 << 14;
  const std::size_t ended = sums_.size() - (stays_open_ ? 1 : 0);
  const auto task = [&](std::size_t block, int) {
    const std::size_t end = std::min(matrix_.columns(), (block + 1) * kColumnsOfTask);
    for (std::size_t k = 0; k < ended; ++k)
      for (std::size_t c = block * kColumnsOfTask; c < end; ++c) sum.whole[c] += sums_[k][c];
  };
  parallel_for(execution_, (matrix_.columns() + kColumnsOfTask - 1) / kColumnsOfTask, task);
  if (stays_open_) sum.open = std::move(sums_.back());
  sums_.assign(sums_.size(), {});
}

}  // namespace plenoflame
