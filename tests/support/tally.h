#pragma once
#include <cmath>

namespace plenoflame::test {

/// Mean and standard error of independent numbers.
struct Tally {
  double sum = 0, squares = 0, n = 0;
  void add(double x) {
    sum += x;
    squares += x * x;
    n += 1;
  }
  double value() const { return sum / n; }
  double error() const { return std::sqrt((squares / n - value() * value()) / (n - 1)); }
};

}  // namespace plenoflame::test
