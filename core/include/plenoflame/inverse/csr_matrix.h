#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/base/part.h"
#include "plenoflame/inverse/linear_operator.h"

namespace plenoflame {

/// [byte] that an entry of a stored matrix takes: a float and a column.
inline constexpr double kBytesOfEntry = sizeof(float) + sizeof(std::int32_t);

/// Some rows of a sparse matrix, one after the other.
template <class Value>
struct CsrRows {
  std::vector<std::size_t> counts;    ///< entries of each row
  std::vector<std::int32_t> columns;  ///< of each entry, ascending within a row
  std::vector<Value> values;
};

/// A sparse matrix in compressed sparse rows, like scipy.sparse.csr_matrix: the entries of row
/// i are [row_starts[i], row_starts[i + 1]).
template <class Value = float>
class CsrMatrix {
 public:
  CsrMatrix() = default;
  /// @throws InputError for starts that fall or do not fit, or columns outside. Also for columns
  ///         that do not ascend within a row, and values that are no numbers (names row and entry)
  CsrMatrix(std::size_t columns, std::vector<std::int64_t> row_starts,
            std::vector<std::int32_t> column_indices, std::vector<Value> values);

  std::size_t rows() const { return row_starts_.size() - 1; }
  std::size_t columns() const { return columns_; }
  std::size_t entries() const { return values_.size(); }
  std::span<const std::int64_t> row_starts() const { return row_starts_; }
  std::span<const std::int32_t> column_indices() const { return column_indices_; }
  std::span<const Value> values() const { return values_; }

 private:
  std::size_t columns_ = 0;
  std::vector<std::int64_t> row_starts_{0};
  std::vector<std::int32_t> column_indices_;
  std::vector<Value> values_;
};

/// Appends rows to those of a growing matrix. @param starts begins with 0
template <class Value>
void append_rows(const CsrRows<Value>& rows, std::vector<std::int64_t>& starts,
                 std::vector<std::int32_t>& columns, std::vector<Value>& values) {
  for (const std::size_t count : rows.counts)
    starts.push_back(starts.back() + static_cast<std::int64_t>(count));
  columns.insert(columns.end(), rows.columns.begin(), rows.columns.end());
  values.insert(values.end(), rows.values.begin(), rows.values.end());
}

/// Joins rows that were made in parts. @throws InputError as CsrMatrix
template <class Value>
CsrMatrix<Value> join_rows(std::vector<CsrRows<Value>> parts, std::size_t columns);

/// The matrix as an operator; sums are in double precision. Both directions run in threads and give
/// the same bits for any number of them: A^T adds up parts of rows that do not depend on threads.
/// @param matrix is kept by reference
/// The operator throws Cancelled when execution.stop is requested.
template <class Value>
std::unique_ptr<LinearOperator> make_csr_operator(const CsrMatrix<Value>& matrix,
                                                  const Execution& execution = {});

/// Rows first, first + step, ... as a matrix of their own, for solvers that go through subsets.
template <class Value>
CsrMatrix<Value> interleaved_rows(const CsrMatrix<Value>& matrix, std::size_t first,
                                  std::size_t step);

/// The rows of a larger matrix that a file holds.
struct CsrPart {
  Part part;
  std::int64_t work = 0;  ///< csr_work() of what all parts are made of
};
/// A number that tells descriptions of work apart (FNV-1a).
std::int64_t csr_work(const std::string& description);

/// Writes or reads a matrix in the format of the name's ending. `.npz`: scipy.sparse.save_npz,
/// compressed or not. `.h5`: datasets data, indices, indptr and shape. `.mtx`: MatrixMarket
/// coordinate real general.
/// @param part of .npz and .h5: an array "part" of its number, the number of parts, and the work
/// @throws FileError; UsageError for another ending; InputError for other contents
void write_csr(const std::string& path, const CsrMatrix<float>& matrix, const CsrPart& part = {});
CsrMatrix<float> read_csr(const std::string& path, CsrPart* part = nullptr);

/// Puts parts together, in any order: the same bits as the whole.
/// @throws InputError: a part is missing or there twice, or they are parts of different matrices
CsrMatrix<float> merge_csr(const std::vector<std::string>& paths);

}  // namespace plenoflame
