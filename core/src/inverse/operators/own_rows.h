#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/csr_matrix.h"

namespace plenoflame {

/// A^T y of the first rows of a matrix.
struct TransposedSum {
  std::vector<double> whole;  ///< of the parts (csr_parts()) that end among these rows
  std::vector<double> open;   ///< of the part that goes on behind them; empty: there is none
};

/// Consecutive rows of a larger matrix. With those before and behind them, products have the bits
/// of make_csr_operator() of the larger one. For one thread at a time.
class OwnRows {
 public:
  OwnRows(CsrMatrix<float> matrix, const Execution& execution);

  const CsrMatrix<float>& matrix() const { return matrix_; }
  /// @param first those rows with which a part begins, with the number of rows if one begins there
  void set_parts(const std::vector<std::size_t>& first);
  std::vector<double> times(std::span<const double> x) const;
  std::vector<double> squares() const;  ///< square_of_row() of each
  /// Makes the sums of A^T y as far as that needs no other rows.
  void sum_up(std::span<const double> y);
  /// Adds these sums. @param sum of all rows before
  void add_to(TransposedSum& sum);

 private:
  CsrMatrix<float> matrix_;
  Execution execution_;
  std::unique_ptr<LinearOperator> operator_;
  std::vector<std::size_t> bounds_;  ///< rows where sums begin, and the number of rows
  bool goes_on_ = false;             ///< with a part of the rows before
  bool stays_open_ = false;          ///< the last part goes on behind
  std::vector<double> y_;
  std::vector<std::vector<double>> sums_;
};

}  // namespace plenoflame
