#include "plenoflame/sampling/noise.h"

#include <array>
#include <cmath>
#include <vector>

#include "support/approx.h"

namespace plenoflame::noise_test {
namespace {

/// Upper limit of chi-square with so many degrees of freedom that it exceeds with a probability of
/// about 1e-6 (Wilson and Hilferty).
double chi_square_limit(double degrees) {
  const double z = 4.75, s = 2 / (9 * degrees);
  return degrees * std::pow(1 - s + z * std::sqrt(s), 3);
}

// Counts against Poisson's law, cells of an expected count of at least 20.
TEST(NoiseStream, PoissonIsPoisson) {
  constexpr int kDraws = 200000;
  for (const double mean : {0.3, 4.0, 29.9, 30.1, 55.0, 400.0}) {
    const auto most = static_cast<std::size_t>(mean + 12 * std::sqrt(mean) + 20);
    std::vector<double> counts(most + 1);
    for (int i = 0; i < kDraws; ++i) {
      const double k = NoiseStream(7, static_cast<std::uint64_t>(i)).poisson(mean);
      ASSERT_TRUE(k >= 0 && k == std::floor(k));
      counts[std::min(most, static_cast<std::size_t>(k))] += 1;
    }
    double chi = 0, cells = 0, expected = 0, seen = 0, log_p = -mean, left = 1;
    for (std::size_t k = 0; k <= most; ++k) {
      if (k > 0) log_p += std::log(mean / static_cast<double>(k));
      const double p = std::exp(log_p);
      expected += kDraws * p;
      seen += counts[k];
      left -= p;
      // The last cell takes all that is left.
      if (expected < 20 || kDraws * left < 20) continue;
      chi += (seen - expected) * (seen - expected) / expected;
      cells += 1;
      expected = seen = 0;
    }
    expected += kDraws * std::max(left, 0.0);
    if (expected > 5) {
      chi += (seen - expected) * (seen - expected) / expected;
      cells += 1;
    }
    EXPECT_LT(chi, chi_square_limit(cells - 1)) << mean;
    EXPECT_GT(chi, 0.2 * (cells - 4)) << mean;  // not better than chance either
  }
}

TEST(NoiseStream, LargeMeansHaveTheRightMoments) {
  constexpr int kDraws = 100000;
  const double mean = 1e7;
  double sum = 0, squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double d = NoiseStream(9, static_cast<std::uint64_t>(i)).poisson(mean) - mean;
    sum += d;
    squares += d * d;
  }
  const double error = std::sqrt(mean / kDraws);
  EXPECT_TRUE(test::within_standard_errors(sum / kDraws, 0, error, 4.5));
  EXPECT_TRUE(
      test::within_standard_errors(squares / kDraws, mean, mean * std::sqrt(2.0 / kDraws), 4.5));
}

// Ten cells of equal probability of the normal distribution.
TEST(NoiseStream, GaussianIsGaussian) {
  constexpr int kDraws = 100000;
  std::array<double, 10> counts{};
  for (int i = 0; i < kDraws; ++i) {
    const double x = NoiseStream(3, static_cast<std::uint64_t>(i)).gaussian();
    counts[std::min<std::size_t>(
        9, static_cast<std::size_t>(5 * std::erfc(-x / std::sqrt(2.0))))] += 1;
  }
  double chi = 0;
  for (const double c : counts) chi += (c - kDraws / 10.0) * (c - kDraws / 10.0) / (kDraws / 10.0);
  EXPECT_LT(chi, chi_square_limit(9));
}

TEST(NoiseStream, IsTheSameForTheSameKeyAndNumber) {
  NoiseStream a(1, 2), b(1, 2), c(1, 3), d(2, 2);
  for (int i = 0; i < 9; ++i) {
    const double u = a.uniform();
    EXPECT_EQ(u, b.uniform());
    EXPECT_NE(u, c.uniform());
    EXPECT_NE(u, d.uniform());
  }
  EXPECT_EQ(NoiseStream(1, 1).poisson(0), 0);
}

}  // namespace
}  // namespace plenoflame::noise_test
