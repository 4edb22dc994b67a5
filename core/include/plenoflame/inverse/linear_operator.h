#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

namespace plenoflame {

/// Vectors that are multiplied at once: most of a product's time goes into reading the matrix.
/// Their numbers lie side by side, the first of each, then the second of each.
inline constexpr std::size_t kTogether = 4;

/// A matrix by what it does to vectors. Immutable; may be used from many threads at once.
class LinearOperator {
 public:
  virtual ~LinearOperator() = default;
  virtual std::size_t rows() const = 0;
  virtual std::size_t columns() const = 0;
  /// y = A x. @param x columns() numbers @param y rows() numbers, overwritten
  virtual void apply(std::span<const double> x, std::span<double> y) const = 0;
  /// x = A^T y: the exact adjoint of apply(), up to rounding.
  virtual void apply_transpose(std::span<const double> y, std::span<double> x) const = 0;
  /// The same of kTogether vectors, with the bits of one by one. An operator that has no better way
  /// does that.
  virtual void apply_together(std::span<const double> x, std::span<double> y) const;
  virtual void apply_transpose_together(std::span<const double> y, std::span<double> x) const;
  /// Sum over all entries of (w_i a_ij)^2, the trace of A^T W^2 A. An operator that does not know
  /// its entries estimates it to some per cent by probing with random signs of fixed seed
  /// (Hutchinson).
  /// @param weights w, one for each row; empty: all 1
  virtual double squared_norm(std::span<const double> weights) const;
};

/// A x for a vector of its own.
std::vector<double> operator*(const LinearOperator& a, std::span<const double> x);
/// A^T y.
std::vector<double> transposed_times(const LinearOperator& a, std::span<const double> y);

/// Within which the largest singular value is found to some per cent.
inline constexpr int kPowerIterations = 30;
/// The largest singular value of W A, from below, by power iterations from a fixed start.
/// @param weights of the rows; empty: all 1
/// @param stop ends them early, with what some of them have found
double largest_singular_value(const LinearOperator& a, std::span<const double> weights,
                              int iterations = kPowerIterations, const std::stop_token& stop = {});

}  // namespace plenoflame
