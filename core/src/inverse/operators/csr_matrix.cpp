#include "plenoflame/inverse/csr_matrix.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "inverse/operators/csr_parts.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// Rows that one task of A x works on.
constexpr std::size_t kRowsOfTask = 1024;

template <class Value>
class CsrOperator final : public LinearOperator {
 public:
  CsrOperator(const CsrMatrix<Value>& matrix, Execution execution)
      : matrix_(matrix),
        execution_(std::move(execution)),
        part_starts_(csr_parts(matrix.row_starts(), matrix.columns())) {
    execution_.progress = nullptr;
  }

  std::size_t rows() const override { return matrix_.rows(); }
  std::size_t columns() const override { return matrix_.columns(); }

  void apply(std::span<const double> x, std::span<double> y) const override { multiply<1>(x, y); }
  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    multiply_transposed<1>(y, x);
  }
  void apply_together(std::span<const double> x, std::span<double> y) const override {
    multiply<kTogether>(x, y);
  }
  void apply_transpose_together(std::span<const double> y, std::span<double> x) const override {
    multiply_transposed<kTogether>(y, x);
  }

  double squared_norm(std::span<const double> weights) const override {
    double sum = 0;
    for (std::size_t row = 0; row < rows(); ++row)
      sum += square_of_row(matrix_, row) * (weights.empty() ? 1 : weights[row] * weights[row]);
    return sum;
  }

 private:
  void run(std::size_t count, const std::function<void(std::size_t, int)>& task) const {
    if (!parallel_for(execution_, count, task)) throw Cancelled();
  }

  template <std::size_t count>
  void multiply(std::span<const double> x, std::span<double> y) const {
    const auto task = [&](std::size_t block, int) {
      const std::size_t end = std::min(rows(), (block + 1) * kRowsOfTask);
      for (std::size_t row = block * kRowsOfTask; row < end; ++row)
        row_times<count>(row, x.data(), &y[row * count]);
    };
    run((rows() + kRowsOfTask - 1) / kRowsOfTask, task);
  }

  template <std::size_t count>
  void multiply_transposed(std::span<const double> y, std::span<double> x) const {
    std::fill(x.begin(), x.end(), 0.0);
    const std::size_t parts = part_starts_.size() - 1;
    if (parts == 1) {
      add_transposed<count>(matrix_, 0, rows(), y, x);
      return;
    }
    // There are as many sums at a time as threads, added up in their order. Memory that was written
    // to before is cleared several times as fast as new memory.
    const auto together = static_cast<std::size_t>(execution_.thread_count());
    std::vector<std::vector<double>> sums(std::min(parts, together));
    for (std::size_t first = 0; first < parts; first += sums.size()) {
      sums.resize(std::min(sums.size(), parts - first));
      run(sums.size(), [&](std::size_t k, int) {
        sums[k].assign(x.size(), 0.0);
        add_transposed<count>(matrix_, part_starts_[first + k], part_starts_[first + k + 1], y,
                              std::span<double>(sums[k]));
      });
      constexpr std::size_t kNumbersOfTask = 1 << 14;
      run((x.size() + kNumbersOfTask - 1) / kNumbersOfTask, [&](std::size_t block, int) {
        const std::size_t end = std::min(x.size(), (block + 1) * kNumbersOfTask);
        for (const std::vector<double>& sum : sums)
          for (std::size_t n = block * kNumbersOfTask; n < end; ++n) x[n] += sum[n];
      });
    }
  }

  template <std::size_t count>
  void row_times(std::size_t row, const double* x, double* y) const {
    const auto begin = static_cast<std::size_t>(matrix_.row_starts()[row]);
    const auto end = static_cast<std::size_t>(matrix_.row_starts()[row + 1]);
    const Value* const values = matrix_.values().data();
    const std::int32_t* const columns = matrix_.column_indices().data();
    // Four sums side by side: one alone waits for each addition before the next.
    std::array<std::array<double, count>, 4> sum{};
    const auto add = [&](std::array<double, count>& to, std::size_t k) {
      const double* const of = x + static_cast<std::size_t>(columns[k]) * count;
      for (std::size_t c = 0; c < count; ++c) to[c] += static_cast<double>(values[k]) * of[c];
    };
    std::size_t k = begin;
    for (; k + 4 <= end; k += 4)
      for (std::size_t n = 0; n < 4; ++n) add(sum[n], k + n);
    for (; k < end; ++k) add(sum[0], k);
    for (std::size_t c = 0; c < count; ++c)
      y[c] = (sum[0][c] + sum[1][c]) + (sum[2][c] + sum[3][c]);
  }

  const CsrMatrix<Value>& matrix_;
  Execution execution_;
  std::vector<std::size_t> part_starts_;  ///< csr_parts()
};

}  // namespace

template <class Value>
CsrMatrix<Value>::CsrMatrix(std::size_t columns, std::vector<std::int64_t> row_starts,
                            std::vector<std::int32_t> column_indices, std::vector<Value> values)
    : columns_(columns),
      row_starts_(std::move(row_starts)),
      column_indices_(std::move(column_indices)),
      values_(std::move(values)) {
  if (columns_ > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw InputError("a sparse matrix has at most 2147483647 columns");
  if (row_starts_.empty() || row_starts_.front() != 0 ||
      row_starts_.back() != static_cast<std::int64_t>(values_.size()) ||
      column_indices_.size() != values_.size())
    throw InputError("the rows of the sparse matrix do not fit its entries");
  for (std::size_t row = 0; row + 1 < row_starts_.size(); ++row) {
    const std::string where = "row " + std::to_string(row) + " of the sparse matrix ";
    if (row_starts_[row + 1] < row_starts_[row] || row_starts_[row + 1] > row_starts_.back())
      throw InputError(where + "ends before it begins");
    std::int64_t before = -1;
    for (auto k = static_cast<std::size_t>(row_starts_[row]);
         k < static_cast<std::size_t>(row_starts_[row + 1]); ++k) {
      if (column_indices_[k] <= before)
        throw InputError(where + "has columns that are not in ascending order");
      before = column_indices_[k];
      if (before >= static_cast<std::int64_t>(columns_))
        throw InputError(where + "has column " + std::to_string(before) + " of " +
                         std::to_string(columns_));
      if (!std::isfinite(values_[k]))
        throw InputError(where + "has a value that is no number in column " +
                         std::to_string(before));
    }
  }
}

template <class Value>
CsrMatrix<Value> join_rows(std::vector<CsrRows<Value>> parts, std::size_t columns) {
  std::size_t rows = 0, entries = 0;
  for (const auto& part : parts) {
    rows += part.counts.size();
    entries += part.values.size();
  }
  std::vector<std::int64_t> starts{0};
  std::vector<std::int32_t> indices;
  std::vector<Value> values;
  starts.reserve(rows + 1);
  indices.reserve(entries);
  values.reserve(entries);
  // Each part gives back its memory as soon as it is copied: nothing is there twice.
  for (auto& part : parts) {
    append_rows(part, starts, indices, values);
    part = {};
  }
  return CsrMatrix<Value>(columns, std::move(starts), std::move(indices), std::move(values));
}

template <class Value>
std::unique_ptr<LinearOperator> make_csr_operator(const CsrMatrix<Value>& matrix,
                                                  const Execution& execution) {
  return std::make_unique<CsrOperator<Value>>(matrix, execution);
}

template <class Value>
CsrMatrix<Value> interleaved_rows(const CsrMatrix<Value>& matrix, std::size_t first,
                                  std::size_t step) {
  CsrRows<Value> rows;
  for (std::size_t row = first; row < matrix.rows(); row += step) {
    const auto begin = static_cast<std::ptrdiff_t>(matrix.row_starts()[row]);
    const auto end = static_cast<std::ptrdiff_t>(matrix.row_starts()[row + 1]);
    rows.counts.push_back(static_cast<std::size_t>(end - begin));
    rows.columns.insert(rows.columns.end(), matrix.column_indices().begin() + begin,
                        matrix.column_indices().begin() + end);
    rows.values.insert(rows.values.end(), matrix.values().begin() + begin,
                       matrix.values().begin() + end);
  }
  return join_rows<Value>({rows}, matrix.columns());
}

#define PLENOFLAME_CSR(Value)                                                         \
  template class CsrMatrix<Value>;                                                    \
  template CsrMatrix<Value> join_rows(std::vector<CsrRows<Value>>, std::size_t);      \
  template std::unique_ptr<LinearOperator> make_csr_operator(const CsrMatrix<Value>&, \
                                                             const Execution&);       \
  template CsrMatrix<Value> interleaved_rows(const CsrMatrix<Value>&, std::size_t, std::size_t);
PLENOFLAME_CSR(float)
PLENOFLAME_CSR(double)
#undef PLENOFLAME_CSR

}  // namespace plenoflame
