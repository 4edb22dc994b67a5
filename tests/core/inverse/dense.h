// Small random problems, and the dense algebra that the solvers are held against (Eigen).
#pragma once
#include <Eigen/Dense>
#include <random>
#include <vector>

#include "core/inverse/random_vectors.h"
#include "plenoflame/inverse/csr_matrix.h"

namespace plenoflame::test {

/// A sparse matrix with entries of at least 0 in a share of its places, and its dense twin. Entries
/// are multiples of 1/64: exact in single precision.
struct TwinMatrix {
  CsrMatrix<float> sparse;
  Eigen::MatrixXd dense;
};

inline TwinMatrix twin_of(const Eigen::MatrixXd& dense) {
  CsrRows<float> rows;
  for (Eigen::Index i = 0; i < dense.rows(); ++i) {
    std::size_t count = 0;
    for (Eigen::Index j = 0; j < dense.cols(); ++j)
      if (dense(i, j) != 0) {
        rows.columns.push_back(static_cast<std::int32_t>(j));
        rows.values.push_back(static_cast<float>(dense(i, j)));
        ++count;
      }
    rows.counts.push_back(count);
  }
  return {join_rows<float>({rows}, static_cast<std::size_t>(dense.cols())), dense};
}

inline TwinMatrix random_matrix(int rows, int columns, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(rows, columns);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j)
      if (unit(random) < share) dense(i, j) = (1 + std::floor(64 * unit(random))) / 64;
  return twin_of(dense);
}

inline Eigen::VectorXd dense(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

inline std::vector<double> plain(const Eigen::VectorXd& values) {
  return {values.data(), values.data() + values.size()};
}

/// |a - b| / |b|.
inline double distance(const std::vector<double>& a, const Eigen::VectorXd& b) {
  return (dense(a) - b).norm() / b.norm();
}

/// Any operator as a dense matrix.
inline Eigen::MatrixXd dense(const LinearOperator& a) {
  Eigen::MatrixXd result(a.rows(), a.columns());
  std::vector<double> unit(a.columns(), 0.0), column(a.rows());
  for (std::size_t j = 0; j < a.columns(); ++j) {
    unit[j] = 1;
    a.apply(unit, column);
    unit[j] = 0;
    result.col(static_cast<Eigen::Index>(j)) = dense(column);
  }
  return result;
}

}  // namespace plenoflame::test
