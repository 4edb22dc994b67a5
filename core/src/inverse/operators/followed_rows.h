#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/csr_matrix.h"
#include "plenoflame/inverse/linear_operator.h"

/// Operators whose rows are made by following rays: without a matrix, or stored.
///
/// `Rows` is copied freely and has rows(), columns(), pieces() and walk(). The latter returns an
/// object for one thread; its follow(row, use) calls use(column, value) for every contribution to
/// the row. The order of contributions depends on nothing but the row. Rows of a piece are followed
/// one after the other: their rays may be drawn together (RowRays).
namespace plenoflame {

/// Rows of a stored matrix that one task works on.
inline constexpr std::size_t kFollowedRows = 256;
/// Number of separate partial sums of A^T, each of some pieces. They depend neither on threads nor
/// on whether rays are kept or drawn again.
inline constexpr std::size_t kFollowedParts = 16;

/// A row's entries by column, gathered densely.
class RowSum {
 public:
  explicit RowSum(std::size_t columns)
      : value_((columns + kBlock - 1) / kBlock * kBlock, 0.0), used_(value_.size() / kBlock, 0) {}
  void add(std::size_t column, double value) {
    used_[column / kBlock] = 1;
    value_[column] += value;
  }
  /// Hands out the entries that are not 0 in the order of the columns, and clears the row.
  template <class Use>
  void take(const Use& use) {
    for (auto at = std::find(used_.begin(), used_.end(), 1); at != used_.end();
         at = std::find(at, used_.end(), 1)) {
      *at = 0;
      const std::size_t first = static_cast<std::size_t>(at - used_.begin()) * kBlock;
      for (std::size_t column = first; column < first + kBlock; ++column)
        if (value_[column] != 0) use(column, std::exchange(value_[column], 0.0));
    }
  }

 private:
  static constexpr std::size_t kBlock = 32;  ///< columns that are looked through together
  std::vector<double> value_;
  std::vector<char> used_;  ///< by block
};

/// Rows after which a product looks whether it is to end: a piece may take seconds.
inline constexpr std::size_t kRowsBetweenLooks = 64;

/// Calls use(row) for each row of a piece, until the stop.
template <class Use>
void follow_piece(const RowPieces& pieces, std::size_t piece, const Execution& execution,
                  const Use& use) {
  std::size_t count = 0;
  for (const std::size_t row : pieces.of(piece)) {
    if (count++ % kRowsBetweenLooks == 0 && execution.stop.stop_requested()) return;
    use(row);
  }
}

/// parallel_for() of such pieces. @throws Cancelled
template <class Task>
void for_pieces(const Execution& execution, std::size_t count, const Task& task) {
  if (!parallel_for(execution, count, task) || execution.stop.stop_requested()) throw Cancelled();
}

/// Its products throw Cancelled soon after a stop of the Execution.
template <class Rows>
class FollowedOperator final : public LinearOperator {
 public:
  FollowedOperator(Rows rows, Execution execution)
      : rows_(std::move(rows)), pieces_(rows_.pieces()), execution_(std::move(execution)) {
    execution_.progress = nullptr;
  }
  std::size_t rows() const override { return rows_.rows(); }
  std::size_t columns() const override { return rows_.columns(); }

  void apply(std::span<const double> x, std::span<double> y) const override {
    const auto task = [&](std::size_t piece, int) {
      auto walk = rows_.walk();
      follow_piece(pieces_, piece, execution_, [&](std::size_t row) {
        double sum = 0;
        walk.follow(row, [&](std::size_t column, double value) { sum += value * x[column]; });
        y[row] = sum;
      });
    };
    for_pieces(execution_, pieces_.count(), task);
  }

  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    std::vector<std::vector<double>> parts(kFollowedParts);
    const auto task = [&](std::size_t part, int) {
      std::vector<double>& sum = parts[part];
      sum.assign(columns(), 0.0);
      auto walk = rows_.walk();
      const auto add = [&](std::size_t row) {
        const double factor = y[row];
        if (factor == 0) return;
        walk.follow(row, [&](std::size_t column, double value) { sum[column] += factor * value; });
      };
      const std::size_t end = (part + 1) * pieces_.count() / kFollowedParts;
      for (std::size_t piece = part * pieces_.count() / kFollowedParts; piece < end; ++piece)
        follow_piece(pieces_, piece, execution_, add);
    };
    for_pieces(execution_, kFollowedParts, task);
    std::fill(x.begin(), x.end(), 0.0);
    for (const std::vector<double>& sum : parts)
      for (std::size_t c = 0; c < columns(); ++c) x[c] += sum[c];
  }

 private:
  Rows rows_;
  RowPieces pieces_;
  Execution execution_;
};

/// Evenly spread rows, of which the number of all entries is estimated.
inline std::vector<std::size_t> sampled_rows(const RowPieces& pieces) {
  const std::size_t step = std::max<std::size_t>(1, pieces.rows.size() / 200);
  std::vector<std::size_t> rows;
  for (std::size_t k = step / 2; k < pieces.rows.size(); k += step) rows.push_back(pieces.rows[k]);
  return rows;
}

/// Number of the entries of some rows.
template <class Rows>
std::size_t entries_of(const Rows& all, std::span<const std::size_t> rows) {
  auto walk = all.walk();
  RowSum sum(all.columns());
  std::size_t entries = 0;
  for (const std::size_t row : rows) {
    walk.follow(row, [&](std::size_t column, double value) { sum.add(column, value); });
    sum.take([&](std::size_t, double) { ++entries; });
  }
  return entries;
}

/// Entries that the matrix will have, from a sample of its rows.
template <class Rows>
std::size_t estimate_entries(const Rows& all) {
  const std::vector<std::size_t> sample = sampled_rows(all.pieces());
  return sample.empty() ? 0 : entries_of(all, sample) * all.rows() / sample.size();
}

/// Follows a row and adds its entries.
template <class Walk>
void append_row(Walk& walk, std::size_t row, RowSum& sum, CsrRows<float>& part) {
  walk.follow(row, [&](std::size_t column, double value) { sum.add(column, value); });
  const std::size_t before = part.values.size();
  sum.take([&](std::size_t column, double value) {
    part.columns.push_back(static_cast<std::int32_t>(column));
    part.values.push_back(static_cast<float>(value));
  });
  part.counts.push_back(part.values.size() - before);
}

/// Rows that are made before they are appended to the matrix: they are there twice for that long.
inline constexpr std::size_t kRowsOfBatch = 64 * kFollowedRows;
/// Room over the estimate, whose error is some per cent. Memory that is not written to is not
/// taken.
inline constexpr double kRoomForEntries = 1.2;

/// Appends the rows to a growing matrix. @param starts begins with 0 @throws Cancelled
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
        if (row % kRowsBetweenLooks == 0 && execution.stop.stop_requested()) return;
        append_row(walk, row, *sum, part);
      }
    };
    for_pieces(execution, (last - first + kFollowedRows - 1) / kFollowedRows, task);
    for (CsrRows<float>& part : parts) {
      append_rows(part, starts, indices, values);
      part.counts.clear(), part.columns.clear(), part.values.clear();
    }
  }
}

/// The rows as a matrix, the same for any number of threads, made a piece at a time. Rays of a
/// piece are drawn once. Pieces give back their memory as soon as they are copied. @throws
/// Cancelled
template <class Rows>
CsrMatrix<float> store_pieces(const Rows& all, const Execution& execution) {
  const RowPieces pieces = all.pieces();
  std::vector<CsrRows<float>> parts(pieces.count());
  std::vector<std::unique_ptr<RowSum>> sums(static_cast<std::size_t>(execution.thread_count()));
  const auto task = [&](std::size_t p, int worker) {
    auto& sum = sums[static_cast<std::size_t>(worker)];
    if (!sum) sum = std::make_unique<RowSum>(all.columns());
    auto walk = all.walk();
    follow_piece(pieces, p, execution,
                 [&](std::size_t row) { append_row(walk, row, *sum, parts[p]); });
  };
  for_pieces(execution, pieces.count(), task);
  std::vector<std::uint32_t> piece_of(all.rows());
  std::size_t entries = 0;
  for (std::size_t p = 0; p < pieces.count(); ++p) {
    entries += parts[p].values.size();
    for (const std::size_t row : pieces.of(p)) piece_of[row] = static_cast<std::uint32_t>(p);
  }
  std::vector<std::int64_t> starts{0};
  std::vector<std::int32_t> indices;
  std::vector<float> values;
  starts.reserve(all.rows() + 1);
  indices.reserve(entries);
  values.reserve(entries);
  struct Taken {
    std::size_t rows = 0;
    std::ptrdiff_t entries = 0;
  };
  std::vector<Taken> taken(pieces.count());
  for (const std::uint32_t p : piece_of) {
    CsrRows<float>& part = parts[p];
    const std::ptrdiff_t from = taken[p].entries;
    const auto count = static_cast<std::ptrdiff_t>(part.counts[taken[p].rows]);
    indices.insert(indices.end(), part.columns.begin() + from, part.columns.begin() + from + count);
    values.insert(values.end(), part.values.begin() + from, part.values.begin() + from + count);
    starts.push_back(starts.back() + count);
    taken[p] = {taken[p].rows + 1, from + count};
    if (taken[p].rows == part.counts.size()) part = {};
  }
  return CsrMatrix<float>(all.columns(), std::move(starts), std::move(indices), std::move(values));
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
