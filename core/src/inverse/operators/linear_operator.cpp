#include "plenoflame/inverse/linear_operator.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "inverse/operators/vector_sums.h"

namespace plenoflame {
namespace {

constexpr int kProbes =
    16;  ///< random vectors of an estimated trace: its error is some 35 % / sqrt(16)

/// Calls product(from, to) for each of the vectors that lie side by side.
template <class Product>
void one_by_one(std::span<const double> from, std::span<double> to, const Product& product) {
  std::vector<double> one(from.size() / kTogether), result(to.size() / kTogether);
  for (std::size_t c = 0; c < kTogether; ++c) {
    bool is_zero = true;
    for (std::size_t j = 0; j < one.size(); ++j) {
      one[j] = from[j * kTogether + c];
      is_zero &= one[j] == 0;
    }
    if (is_zero)
      std::ranges::fill(result, 0.0);
    else
      product(one, result);
    for (std::size_t i = 0; i < result.size(); ++i) to[i * kTogether + c] = result[i];
  }
}

}  // namespace

void LinearOperator::apply_together(std::span<const double> x, std::span<double> y) const {
  one_by_one(x, y, [&](const auto& from, auto& to) { apply(from, to); });
}

void LinearOperator::apply_transpose_together(std::span<const double> y,
                                              std::span<double> x) const {
  one_by_one(y, x, [&](const auto& from, auto& to) { apply_transpose(from, to); });
}

double LinearOperator::squared_norm(std::span<const double> weights) const {
  SignSequence signs(1);
  std::vector<double> x(columns()), y(rows());
  double sum = 0;
  for (int probe = 0; probe < kProbes; ++probe) {
    for (double& value : x) value = signs.next();
    apply(x, y);
    scale_by(weights, y);
    sum += dot(y, y);
  }
  return sum / kProbes;
}

std::vector<double> operator*(const LinearOperator& a, std::span<const double> x) {
  std::vector<double> y(a.rows());
  a.apply(x, y);
  return y;
}

std::vector<double> transposed_times(const LinearOperator& a, std::span<const double> y) {
  std::vector<double> x(a.columns());
  a.apply_transpose(y, x);
  return x;
}

namespace {
/// Power iterations whose value is near enough for a step by it to lead downhill.
constexpr int kLeastIterations = 3;
}  // namespace

double largest_singular_value(const LinearOperator& a, std::span<const double> weights,
                              int iterations, const std::stop_token& stop) {
  // Signs beside a constant: not orthogonal to the leading vector of a matrix without negative
  // entries, nor to one of differences.
  SignSequence signs(2);
  std::vector<double> x(a.columns()), y(a.rows());
  for (double& value : x) value = 1 + 0.5 * signs.next();
  double value = 0;
  for (int i = 0; i < iterations; ++i) {
    const double length = norm(x);
    if (!(length > 0)) return 0;
    for (double& each : x) each /= length;
    a.apply(x, y);
    scale_by(weights, y);
    value = norm(y);
    scale_by(weights, y);
    a.apply_transpose(y, x);
    if (stop.stop_requested() && i + 1 >= kLeastIterations) break;
  }
  return value;
}

}  // namespace plenoflame
