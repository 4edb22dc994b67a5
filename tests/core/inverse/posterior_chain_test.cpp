#include "plenoflame/inverse/posterior_chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/approx.h"

namespace plenoflame::test::posterior_chain_test {
namespace {

/// Draws of a Gaussian with these standard deviations.
std::vector<std::vector<double>> draws(const std::vector<double>& deviations, int count) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> result;
  for (int k = 0; k < count; ++k) {
    result.emplace_back();
    for (const double deviation : deviations) result.back().push_back(deviation * normal(random));
  }
  return result;
}

const std::vector<double> kDeviations{1, 0.1, 30}, kEqual{1, 1, 1};

TEST(PosteriorChain, AGaussianIsAsWideAsItself) {
  const auto none = [](std::span<const double>) { return 0.0; };
  const PosteriorChain chain = run_posterior_chain(draws(kDeviations, 30), none, kEqual, 1);
  EXPECT_EQ(chain.width, 1);
  EXPECT_EQ(chain.accepted, 1);
}

// A posterior that is a Gaussian of another width.
TEST(PosteriorChain, TellsTheWidthOfAnotherGaussian) {
  for (const double width : {0.6, 1.5}) {
    const auto excess = [&](std::span<const double> d) {
      double sum = 0;
      for (std::size_t j = 0; j < d.size(); ++j)
        sum += 0.5 * std::pow(d[j] / kDeviations[j], 2) * (1 / (width * width) - 1);
      return sum;
    };
    const PosteriorChain chain = run_posterior_chain(draws(kDeviations, 40000), excess, kEqual, 1);
    EXPECT_TRUE(relative(chain.width, width, 0.05));
    EXPECT_LT(chain.accepted, 0.95);
  }
}

// Half of the space has no density: the distance from the mode is the same, and half of the steps
// are taken.
TEST(PosteriorChain, TakesNoStepToWhereThereIsNoDensity) {
  const auto excess = [](std::span<const double> d) {
    return d[0] > 0 ? 0 : std::numeric_limits<double>::infinity();
  };
  const PosteriorChain chain = run_posterior_chain(draws({1}, 20000), excess, std::vector{1.0}, 1);
  EXPECT_TRUE(relative(chain.width, 1, 0.05));
  EXPECT_GT(chain.accepted, 0.4);
  EXPECT_LT(chain.accepted, 0.9);
}

// Entries without weight do not count.
TEST(PosteriorChain, WeighsTheEntries) {
  const auto excess = [](std::span<const double> d) { return 10 * d[0] * d[0]; };
  const std::vector<double> second{0, 1, 0};
  const PosteriorChain all = run_posterior_chain(draws({1, 1, 1}, 5000), excess, kEqual, 1);
  const PosteriorChain one = run_posterior_chain(draws({1, 1, 1}, 5000), excess, second, 1);
  EXPECT_LT(all.width, 0.92);
  EXPECT_TRUE(relative(one.width, 1, 0.1));
}

}  // namespace
}  // namespace plenoflame::test::posterior_chain_test
