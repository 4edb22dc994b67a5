// The share of a run that is reported over its batches and rounds: by hand, since it is arithmetic.
#include "render/run/run_progress.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "plenoflame/base/progress_share.h"
#include "plenoflame/render/work_counters.h"
#include "support/approx.h"

namespace plenoflame::test::run_progress_test {
namespace {

struct Reports {
  std::vector<Progress> all;
  Execution execution() {
    Execution execution;
    execution.progress = [this](const Progress& progress) { all.push_back(progress); };
    return execution;
  }
  double fraction() const { return all.back().fraction; }
};

TEST(RunProgress, IsTheShareOfAllThatIsForeseen) {
  Reports reports;
  const Execution execution = reports.execution();
  RunProgress run(execution, 0);
  run.foresee(0, 8);
  run.add(2, 100);
  EXPECT_DOUBLE_EQ(reports.fraction(), 0.25);
  run.add(4, 100);
  EXPECT_DOUBLE_EQ(reports.fraction(), 0.75);
  EXPECT_DOUBLE_EQ(reports.all.back().rays, 200);
  EXPECT_GE(reports.all.back().remaining_seconds, 0);
}

// The work of an earlier run counts as done.
TEST(RunProgress, BeginsWhereAnEarlierRunStopped) {
  Reports reports;
  const Execution execution = reports.execution();
  RunProgress run(execution, 0);
  run.foresee(6, 2);
  run.add(1, 0);
  EXPECT_DOUBLE_EQ(reports.fraction(), 0.875);
}

TEST(RunProgress, NeverFallsAndEndsAtOne) {
  Reports reports;
  const Execution execution = reports.execution();
  RunProgress run(execution, 0);
  run.explore(10);
  for (int i = 0; i < 10; ++i) run.add(1, 0);
  // An explored stretch does not tell how much follows.
  EXPECT_LT(reports.fraction(), 0.05);
  EXPECT_LT(reports.all.back().remaining_seconds, 0);
  run.foresee(10, 30);
  run.add(10, 0);
  EXPECT_DOUBLE_EQ(reports.fraction(), 0.5);
  // Ten times as much turns out to be left: the share goes on from there.
  run.foresee(20, 200);
  run.add(20, 0);
  EXPECT_DOUBLE_EQ(reports.fraction(), 0.55);
  run.complete();
  EXPECT_DOUBLE_EQ(reports.fraction(), 1);
  EXPECT_DOUBLE_EQ(reports.all.back().remaining_seconds, 0);
  for (std::size_t i = 1; i < reports.all.size(); ++i)
    EXPECT_GE(reports.all[i].fraction, reports.all[i - 1].fraction);
}

// The work that is known to be left is the most that an open stretch may stand for.
TEST(RunProgress, AnOpenStretchStandsForWhatItMayBe) {
  Reports reports;
  const Execution execution = reports.execution();
  RunProgress run(execution, 0);
  run.explore(10, 0.4);
  run.add(5, 0);
  EXPECT_DOUBLE_EQ(reports.fraction(), 0.2);
  EXPECT_LT(reports.all.back().remaining_seconds, 0);
  run.add(5, 0);
  EXPECT_DOUBLE_EQ(reports.fraction(), 0.4);
  run.explore(10, 3);  // more than all: it is not promised to be the end
  run.add(10, 0);
  EXPECT_DOUBLE_EQ(reports.fraction(), 0.9);
}

// Counters of two workers, or of two rounds: every count is added to its like.
TEST(WorkCounters, AddUp) {
  WorkCounters one, other;
  double* const of_one[] = {&one.rays,
                            &one.pairs,
                            &one.tiles_skipped,
                            &one.medium.cells,
                            &one.table.clamped_sum,
                            &one.stages.surfaces};
  double* const of_other[] = {&other.rays,
                              &other.pairs,
                              &other.tiles_skipped,
                              &other.medium.cells,
                              &other.table.clamped_sum,
                              &other.stages.surfaces};
  for (int i = 0; i < 6; ++i) {
    *of_one[i] = 1 + i;
    *of_other[i] = 10 * (1 + i);
  }
  // All are doubles, of which none may be left out: 1 in each makes 2 in each.
  static_assert(sizeof(WorkCounters) % sizeof(double) == 0);
  one += other;
  for (int i = 0; i < 6; ++i) EXPECT_EQ(*of_one[i], 11 * (1 + i)) << i;
  using Counts = std::array<double, sizeof(WorkCounters) / sizeof(double)>;
  Counts ones;
  ones.fill(1);
  auto all = std::bit_cast<WorkCounters>(ones);
  all += WorkCounters(all);
  for (const double sum : std::bit_cast<Counts>(all)) EXPECT_EQ(sum, 2);
}

TEST(RunProgress, ATimeLimitEndsTheRunToo) {
  Reports reports;
  const Execution execution = reports.execution();
  RunProgress run(execution, 1e-9);  // over before the first report
  run.foresee(0, 1e9);
  run.add(1, 0);
  EXPECT_DOUBLE_EQ(reports.fraction(), 1);
  EXPECT_DOUBLE_EQ(reports.all.back().remaining_seconds, 0);
}

// Tiles that see little are a small part of the work, once their first samples have told so.
TEST(TileProgress, WeighsTilesByTheRaysThatTheyTake) {
  Reports reports;
  const Execution execution = reports.execution();
  RunProgress run(execution, 0);
  Film film({0, 0, 2 * Film::kTile, Film::kTile}, 1, 2);
  ASSERT_EQ(film.tile_count(), 2);
  TileProgress tiles(run, film);
  tiles.explore(film, {4, 4});
  tiles.add(0, 4, 0);
  film.add_samples(0, 4);
  tiles.add(1, 4, 4e6);
  film.add_samples(1, 4);
  tiles.foresee(film, {16, 16});
  const double before = run.fraction();
  EXPECT_DOUBLE_EQ(before, 0.02);
  tiles.add(0, 12, 0);
  EXPECT_LT(reports.fraction(), 0.26);  // 4 of 16 samples of the tile that counts are done
  tiles.add(1, 6, 6e6);
  EXPECT_GT(reports.fraction(), 0.6);
  EXPECT_LT(reports.fraction(), 0.65);
}

TEST(ShareOf, PutsAPartInItsPlace) {
  Reports reports;
  const Execution execution = reports.execution();
  const Execution part = share_of(execution, 0.5, 0.75);
  part.progress({0.5, 7, 8, 0.1, 10});
  EXPECT_DOUBLE_EQ(reports.fraction(), 0.625);
  // The part takes 20 s in all, and another of that length follows.
  EXPECT_DOUBLE_EQ(reports.all.back().remaining_seconds, 30);
  EXPECT_DOUBLE_EQ(reports.all.back().rays, 7);
  part.progress({0.5, 0, 0, -1, -1});
  EXPECT_LT(reports.all.back().remaining_seconds, 0);
  EXPECT_FALSE(share_of({}, 0, 1).progress);
}

// Two tiles, whose errors fall as samples^-0.86 (kErrorSlope): by hand.
TEST(TileProgress, ReportsTheErrorThatIsLeft) {
  Reports reports;
  const Execution execution = reports.execution();
  RunProgress run(execution, 0);
  Film film({0, 0, 2 * Film::kTile, 4}, 1, 2);
  TileProgress tiles(run, film);
  for (int t = 0; t < 2; ++t) film.add_samples(t, 8);
  tiles.measured(film, 0.1, {3e-20, 1e-20});
  tiles.foresee(film, {16, 32});
  tiles.add(1, 24, 100);
  EXPECT_TRUE(relative(reports.all.back().relative_error,
                       0.1 * std::sqrt(0.75 + 0.25 * std::pow(4, -1.72)), 1e-12));
  tiles.add(0, 8, 100);
  EXPECT_TRUE(relative(reports.all.back().relative_error,
                       0.1 * std::sqrt(0.75 * std::pow(2, -1.72) + 0.25 * std::pow(4, -1.72)),
                       1e-12));
}

}  // namespace
}  // namespace plenoflame::test::run_progress_test
