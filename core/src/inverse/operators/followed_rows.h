#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/inverse/csr_matrix.h"
#include "plenoflame/inverse/linear_operator.h"

/// Operators whose rows are made by following rays: without a matrix, or stored.
///
/// `Rows` is copied freely and has rows(), columns() and walk(), an object for one thread whose
/// follow(row, use) calls use(column, value) for every contribution to the row, in an order that
/// depends on nothing but the row.
namespace plenoflame {

/// Rows that one task works on. Parts do not depend on threads.
inline constexpr std::size_t kFollowedRows = 256;
/// Sums of A^T that are made apart from each other.
inline constexpr std::size_t kFollowedParts = 16;

/// A row's entries by column, gathered densely.
class RowSum {
 public:
  explicit RowSum(std::size_t columns) : value_(columns, 0.0), used_(columns, 0) {}
  void add(std::size_t column, double value) {
    if (!used_[column]) {
      used_[column] = 1;
      columns_.push_back(column);
    }
    value_[column] += value;
  }
  /// Hands out what is not 0 in the order of the columns, and begins anew.
  template <class Use>
  void take(const Use& use) {
    std::sort(columns_.begin(), columns_.end());
    for (const std::size_t column : columns_) {
      if (value_[column] != 0) use(column, value_[column]);
      value_[column] = 0;
      used_[column] = 0;
    }
    columns_.clear();
  }

 private:
  std::vector<double> value_;
  std::vector<char> used_;
  std::vector<std::size_t> columns_;
};

template <class Rows>
class FollowedOperator final : public LinearOperator {
 public:
  FollowedOperator(Rows rows, Execution execution)
      : rows_(std::move(rows)), execution_(std::move(execution)) {
    execution_.progress = nullptr;
  }
  std::size_t rows() const override { return rows_.rows(); }
  std::size_t columns() const override { return rows_.columns(); }

  void apply(std::span<const double> x, std::span<double> y) const override {
    const auto task = [&](std::size_t part, int) {
      auto walk = rows_.walk();
      const std::size_t end = std::min(rows(), (part + 1) * kFollowedRows);
      for (std::size_t row = part * kFollowedRows; row < end; ++row) {
        double sum = 0;
        walk.follow(row, [&](std::size_t column, double value) { sum += value * x[column]; });
        y[row] = sum;
      }
    };
    if (!parallel_for(execution_, (rows() + kFollowedRows - 1) / kFollowedRows, task))
      throw Cancelled();
  }

  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    std::vector<std::vector<double>> parts(kFollowedParts);
    const std::size_t share = (rows() + kFollowedParts - 1) / kFollowedParts;
    const auto task = [&](std::size_t part, int) {
      std::vector<double>& sum = parts[part];
      sum.assign(columns(), 0.0);
      auto walk = rows_.walk();
      for (std::size_t row = part * share; row < std::min(rows(), (part + 1) * share); ++row) {
        const double factor = y[row];
        if (factor == 0) continue;
        walk.follow(row, [&](std::size_t column, double value) { sum[column] += factor * value; });
      }
    };
    if (!parallel_for(execution_, kFollowedParts, task)) throw Cancelled();
    std::fill(x.begin(), x.end(), 0.0);
    for (const std::vector<double>& sum : parts)
      for (std::size_t c = 0; c < columns(); ++c) x[c] += sum[c];
  }

 private:
  Rows rows_;
  Execution execution_;
};

/// Entries that the matrix will have, from a sample of its rows.
template <class Rows>
std::size_t estimate_entries(const Rows& all) {
  const std::size_t rows = all.rows();
  if (rows == 0) return 0;
  const std::size_t step = std::max<std::size_t>(1, rows / 200);
  auto walk = all.walk();
  RowSum sum(all.columns());
  std::size_t entries = 0, looked_at = 0;
  for (std::size_t row = step / 2; row < rows; row += step) {
    walk.follow(row, [&](std::size_t column, double value) { sum.add(column, value); });
    sum.take([&](std::size_t, double) { ++entries; });
    ++looked_at;
  }
  return looked_at > 0 ? entries * rows / looked_at : 0;
}

/// Rows that are made before they are appended to the matrix: they are there twice for that long.
inline constexpr std::size_t kRowsOfBatch = 64 * kFollowedRows;
/// Room over the estimate, whose error is some per cent. Memory that is not written to is not
/// taken.
inline constexpr double kRoomForEntries = 1.2;

/// Appends the rows to a matrix that comes about. @param starts begins with 0 @throws Cancelled
template <class Rows>
void gather_rows(const Rows& all, const Execution& execution, std::vector<std::int64_t>& starts,
                 std::vector<std::int32_t>& indices, std::vector<float>& values) {
  const std::size_t rows = all.rows(), columns = all.columns();
  std::vector<CsrRows<float>> parts(kRowsOfBatch / kFollowedRows);
  std::vector<std::unique_ptr<RowSum>> sums(static_cast<std::size_t>(execution.thread_count()));
  for (std::size_t first = 0; first < rows; first += kRowsOfBatch) {
    const std::size_t last = std::min(rows, first + kRowsOfBatch);
    const auto task = [&](std::size_t p, int worker) {
      auto& sum = sums[static_cast<std::size_t>(worker)];
      if (!sum) sum = std::make_unique<RowSum>(columns);
      auto walk = all.walk();
      CsrRows<float>& part = parts[p];
      const std::size_t end = std::min(last, first + (p + 1) * kFollowedRows);
      for (std::size_t row = first + p * kFollowedRows; row < end; ++row) {
        walk.follow(row, [&](std::size_t column, double value) { sum->add(column, value); });
        const std::size_t before = part.values.size();
        sum->take([&](std::size_t column, double value) {
          part.columns.push_back(static_cast<std::int32_t>(column));
          part.values.push_back(static_cast<float>(value));
        });
        part.counts.push_back(part.values.size() - before);
      }
    };
    if (!parallel_for(execution, (last - first + kFollowedRows - 1) / kFollowedRows, task))
      throw Cancelled();
    for (CsrRows<float>& part : parts) {
      append_rows(part, starts, indices, values);
      part.counts.clear(), part.columns.clear(), part.values.clear();
    }
  }
}

/// The rows as a matrix, the same for any number of threads. @throws Cancelled
template <class Rows>
CsrMatrix<float> store_rows(const Rows& all, const Execution& execution) {
  std::vector<std::int64_t> starts{0};
  std::vector<std::int32_t> indices;
  std::vector<float> values;
  const auto room =
      static_cast<std::size_t>(kRoomForEntries * static_cast<double>(estimate_entries(all)));
  starts.reserve(all.rows() + 1);
  indices.reserve(room);
  values.reserve(room);
  gather_rows(all, execution, starts, indices, values);
  return CsrMatrix<float>(all.columns(), std::move(starts), std::move(indices), std::move(values));
}

}  // namespace plenoflame
