#include "render/run/sample_plan.h"

#include <cmath>

#include "support/approx.h"

namespace plenoflame::test::sample_plan_test {
namespace {

/// Mean square error over lit pixels of tiles that go exactly as foreseen.
double error_of(const std::vector<TileNeed>& tiles, const std::vector<int>& samples) {
  double squares = 0, lit = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    squares += tiles[i].lit * tiles[i].difficulty / std::pow(samples[i], 2 * kErrorSlope);
    lit += tiles[i].lit;
  }
  return squares / lit;
}

/// Rounds until the goal is met. @return samples
std::vector<int> run(std::vector<TileNeed> tiles, double goal, int limit, int& rounds) {
  std::vector<int> samples;
  for (rounds = 0; rounds < 100; ++rounds) {
    const std::vector<int> next = plan_samples(tiles, goal, limit);
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      EXPECT_GE(next[i], tiles[i].samples);
      EXPECT_LE(next[i], limit);
      tiles[i].samples = next[i];
    }
    if (next == samples) break;
    samples = next;
    if (error_of(tiles, samples) <= goal) break;
  }
  return samples;
}

TEST(SamplePlan, OneTileGetsWhatItsErrorAsksFor) {
  // At 8 samples the error is 10 times the goal: n = 8 * 10^(1 / slope).
  const double goal = 1e-6;
  const TileNeed tile{4096, 8, 100 * goal * std::pow(8, 2 * kErrorSlope)};
  int rounds = 0;
  const std::vector<int> samples = run({tile}, goal, 1 << 20, rounds);
  const double exact = 8 * std::pow(10, 1 / kErrorSlope);
  // Whole nets only: the first power of two times 8 that will do.
  EXPECT_EQ(samples[0], 8 << static_cast<int>(std::ceil(std::log2(exact / 8))));
  EXPECT_LE(rounds, 3);
}

TEST(SamplePlan, HardTilesGetMoreByLagrangesRule) {
  std::vector<TileNeed> tiles;
  for (const double difficulty : {1.0, 4.0, 16.0, 64.0}) tiles.push_back({1000, 8, difficulty});
  const double goal = error_of(tiles, {8, 8, 8, 8}) / 400;
  int rounds = 0;
  const std::vector<int> samples = run(tiles, goal, 1 << 20, rounds);
  for (std::size_t i = 1; i < 4; ++i) {
    const double ratio = std::pow(4, 1 / (2 * kErrorSlope + 1));
    EXPECT_TRUE(relative(samples[i] / static_cast<double>(samples[i - 1]), ratio, 0.5)) << i;
  }
  // Fewer rays than the same error takes with equal numbers, of which the best takes 0.697 here.
  double rays = 0, equal = 0;
  for (const int n : samples) rays += n;
  equal =
      4 * std::pow(error_of(tiles, {1, 1, 1, 1}) / error_of(tiles, samples), 1 / (2 * kErrorSlope));
  EXPECT_LT(rays, 0.78 * equal);
}

// A part of many tiles is doubled: no more than the goal asks for.
TEST(SamplePlan, ManyTilesMeetTheGoalClosely) {
  std::vector<TileNeed> tiles;
  for (int i = 0; i < 500; ++i) tiles.push_back({100.0 + i % 7, 8, 1 + 0.01 * i});
  for (const double part : {0.9, 0.5, 0.1, 0.012}) {
    const double goal = part * error_of(tiles, std::vector<int>(500, 8));
    const std::vector<int> samples = plan_samples(tiles, goal, 1 << 20);
    EXPECT_LE(error_of(tiles, samples), goal);
    EXPECT_GE(error_of(tiles, samples), 0.99 * goal);
    for (const int n : samples) EXPECT_TRUE(n == 8 || n == 16 || n == 32 || n == 64 || n == 128);
  }
}

TEST(SamplePlan, NothingToGainAndLimits) {
  // A dark tile stays as it is, one at its limit too; the rest goes on.
  const std::vector<int> samples = plan_samples({{0, 8, 0}, {10, 64, 1}, {10, 8, 1}}, 1e-12, 64);
  EXPECT_EQ(samples, (std::vector{8, 64, 64}));
  EXPECT_EQ(plan_samples({{10, 64, 1}}, 1e-12, 64), std::vector{64});
  EXPECT_EQ(plan_samples({{0, 8, 0}}, 1e-12, 64), std::vector{8});
}

TEST(SamplePlan, SomethingGrowsWhenLittleIsMissing) {
  const std::vector<TileNeed> tiles{{10, 64, 1}, {10, 64, 1.01}};
  const double goal = 0.99 * error_of(tiles, {64, 64});
  EXPECT_GT(plan_samples(tiles, goal, 1 << 20)[1], 64);
  // Tiles are not decided upon by their own errors: the goal may seem to be met, and is not.
  EXPECT_GT(plan_samples(tiles, 2 * goal, 1 << 20)[1], 64);
}

}  // namespace
}  // namespace plenoflame::test::sample_plan_test
