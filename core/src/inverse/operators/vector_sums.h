#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace plenoflame {

// Sums in the order of the vectors: the same bits whoever asks.

inline double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

inline double norm(std::span<const double> a) {
  return std::sqrt(dot(a, a));
}

/// y += factor * x.
inline void add_scaled(double factor, std::span<const double> x, std::span<double> y) {
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += factor * x[i];
}

/// y_i *= weights_i of `count` vectors side by side; empty weights are all 1.
template <std::size_t count = 1>
void scale_by(std::span<const double> weights, std::span<double> y) {
  for (std::size_t i = 0; i < weights.size(); ++i)
    for (std::size_t c = 0; c < count; ++c) y[i * count + c] *= weights[i];
}

/// Random signs of a seed (splitmix64; Steele, Lea and Flood 2014).
class SignSequence {
 public:
  explicit SignSequence(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u) {}
  double next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return ((z ^ (z >> 31)) & 1) != 0 ? 1.0 : -1.0;
  }

 private:
  std::uint64_t state_;
};

}  // namespace plenoflame
