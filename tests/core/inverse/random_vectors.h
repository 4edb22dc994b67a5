#pragma once
#include <random>
#include <vector>

namespace plenoflame::test {

inline std::vector<double> random_vector(std::size_t size, double low, double high, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> range(low, high);
  std::vector<double> values(size);
  for (double& value : values) value = range(random);
  return values;
}

/// Normally distributed, of deviation 1.
inline std::vector<double> random_vector(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(size);
  for (double& value : values) value = normal(random);
  return values;
}

}  // namespace plenoflame::test
