#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "plenoflame/inverse/csr_matrix.h"

/// Products of the transposed matrix. They add up parts of rows, whose sums are made separately.
namespace plenoflame {

/// Largest number of separate partial sums of A^T y. They suffice for many threads, and adding them
/// up takes little time compared with the entries.
inline constexpr std::size_t kMostRowRanges = 64;
inline constexpr std::size_t kEntriesOfPart = 1 << 16;
/// A part's sums are cleared, and read at the end. These three passes are cheap for this number of
/// entries per column.
inline constexpr std::size_t kEntriesOfSum = 16;

/// First row of each part, then the number of rows. Parts have about equal numbers of entries, by
/// the matrix alone.
inline std::vector<std::size_t> csr_parts(std::span<const std::int64_t> starts,
                                          std::size_t columns) {
  const auto entries = static_cast<std::size_t>(starts.back());
  const std::size_t least =
      std::max(kEntriesOfPart, kEntriesOfSum * std::max<std::size_t>(1, columns));
  const std::size_t parts = std::clamp<std::size_t>(entries / least, 1, kMostRowRanges);
  std::vector<std::size_t> first{0};
  for (std::size_t p = 1; p < parts; ++p) {
    const auto entry = static_cast<std::int64_t>(entries * p / parts);
    const auto at = std::lower_bound(starts.begin(), starts.end() - 1, entry);
    first.push_back(static_cast<std::size_t>(at - starts.begin()));
  }
  first.push_back(starts.size() - 1);
  return first;
}

/// Adds the rows from `first` to `end`, times their y, to x; of `count` vectors side by side.
template <std::size_t count = 1, class Value>
void add_transposed(const CsrMatrix<Value>& matrix, std::size_t first, std::size_t end,
                    std::span<const double> y, std::span<double> x) {
  const auto starts = matrix.row_starts();
  const Value* const values = matrix.values().data();
  const std::int32_t* const columns = matrix.column_indices().data();
  for (std::size_t row = first; row < end; ++row) {
    std::array<double, count> factor;
    std::copy_n(&y[row * count], count, factor.begin());
    if (std::ranges::all_of(factor, [](double each) { return each == 0; })) continue;
    for (auto k = static_cast<std::size_t>(starts[row]);
         k < static_cast<std::size_t>(starts[row + 1]); ++k) {
      double* const sum = &x[static_cast<std::size_t>(columns[k]) * count];
      for (std::size_t c = 0; c < count; ++c) sum[c] += factor[c] * static_cast<double>(values[k]);
    }
  }
}

/// Sum of the squares of a row's entries.
template <class Value>
double square_of_row(const CsrMatrix<Value>& matrix, std::size_t row) {
  double sum = 0;
  for (auto k = matrix.row_starts()[row]; k < matrix.row_starts()[row + 1]; ++k) {
    const auto value = static_cast<double>(matrix.values()[static_cast<std::size_t>(k)]);
    sum += value * value;
  }
  return sum;
}

}  // namespace plenoflame
