#include "plenoflame/base/execution.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace plenoflame::execution_test {
namespace {

TEST(ParallelFor, RunsEveryIndexOnce) {
  for (const int threads : {1, 2, 7}) {
    Execution execution;
    execution.threads = threads;
    std::vector<std::atomic<int>> runs(1000);
    EXPECT_TRUE(parallel_for(execution, runs.size(), [&](std::size_t i, int worker) {
      ASSERT_GE(worker, 0);
      ASSERT_LT(worker, threads);
      ++runs[i];
    }));
    for (const auto& count : runs) EXPECT_EQ(count, 1);
  }
}

TEST(ParallelFor, RethrowsAndStops) {
  Execution execution;
  execution.threads = 3;
  EXPECT_THROW(parallel_for(execution, 100,
                            [](std::size_t i, int) {
                              if (i == 17) throw std::runtime_error("17");
                            }),
               std::runtime_error);
  std::stop_source source;
  execution.stop = source.get_token();
  std::atomic<int> done{0};
  EXPECT_FALSE(parallel_for(execution, 1000000, [&](std::size_t, int) {
    if (++done == 10) source.request_stop();
  }));
  EXPECT_LT(done, 1000000);
}

TEST(ParallelFor, NothingToDo) {
  EXPECT_TRUE(parallel_for(Execution{}, 0, [](std::size_t, int) { FAIL(); }));
}

}  // namespace
}  // namespace plenoflame::execution_test
