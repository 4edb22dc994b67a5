// What is lit is found wherever it stands, and only that.
#include "film/lit_runs.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace plenoflame::test {
namespace {

TEST(LitRuns, FindOnePixelWhereverItStands) {
  const float least = std::numeric_limits<float>::denorm_min();
  for (const std::size_t size : {std::size_t{1}, kRun - 1, kRun, kRun + 1, 3 * kRun + 7})
    for (std::size_t lit = 0; lit < size; ++lit)
      for (const float value : {least, 2.5F}) {
        std::vector<float> pixels(size, 0);
        pixels[lit] = value;
        std::size_t runs = 0;
        for_lit_runs(pixels, [&](std::size_t first, std::size_t end) {
          ++runs;
          ASSERT_LE(first, lit);
          ASSERT_GT(end, lit);
          ASSERT_LE(end, size);
        });
        ASSERT_EQ(runs, 1u);
        ASSERT_EQ(largest_of(pixels), value);
        ASSERT_EQ(sum_of(pixels), static_cast<double>(value));
      }
}

TEST(LitRuns, NothingIsLitWhereAllIsZero) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, 5 * kRun}) {
    const std::vector<float> pixels(size, -0.0F);
    for_lit_runs(pixels, [](std::size_t, std::size_t) { FAIL(); });
    EXPECT_EQ(largest_of(pixels), 0);
    EXPECT_EQ(sum_of(pixels), 0);
  }
}

}  // namespace
}  // namespace plenoflame::test
