// Lit pixels are found wherever they stand, and only these; sums over parts are those over all.
#include "film/lit_runs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "film/image_sums.h"
#include "support/approx.h"

namespace plenoflame::test::lit_runs_test {
namespace {

Execution on(int threads) {
  Execution execution;
  execution.threads = threads;
  return execution;
}

TEST(LitRuns, FindOnePixelWhereverItStands) {
  const float least = std::numeric_limits<float>::denorm_min();
  for (const int size : {1, static_cast<int>(kRun) - 1, static_cast<int>(kRun),
                         static_cast<int>(kRun) + 1, 3 * static_cast<int>(kRun) + 7})
    for (int lit = 0; lit < size; ++lit)
      for (const float value : {least, 2.5F}) {
        Image image(size, 1);
        image.at(lit, 0) = value;
        std::size_t runs = 0;
        for_lit_runs(image, {0, 0, size, 1}, [&](std::size_t first, std::size_t end) {
          ++runs;
          ASSERT_LE(first, static_cast<std::size_t>(lit));
          ASSERT_GT(end, static_cast<std::size_t>(lit));
          ASSERT_LE(end, static_cast<std::size_t>(size));
        });
        ASSERT_EQ(runs, 1u);
        ASSERT_EQ(largest_of(image, whole_of(image), on(1)), value);
        ASSERT_EQ(sum_of(image, whole_of(image), on(1)), static_cast<double>(value));
      }
}

TEST(LitRuns, NothingIsLitWhereAllIsZero) {
  for (const int size : {0, 1, 5 * static_cast<int>(kRun)}) {
    const Image image(size, size > 0 ? 1 : 0, -0.0F);
    for_lit_runs(image, {0, 0, size, size > 0 ? 1 : 0}, [](std::size_t, std::size_t) { FAIL(); });
    EXPECT_EQ(largest_of(image, whole_of(image), on(1)), 0);
    EXPECT_EQ(sum_of(image, whole_of(image), on(1)), 0);
  }
}

// A film of which three tiles are lit, one at the ragged corner, in a window that begins somewhere.
TEST(LitRuns, SumsOverPartsAreThoseOverAllAndTheSameOnAnyNumberOfThreads) {
  const PixelWindow window{11, 7, 5 * Film::kTile + 9, 3 * Film::kTile + 5};
  Film film(window, 1, 4);
  for (int tile = 0; tile < film.tile_count(); ++tile) film.add_samples(tile, 3);
  unsigned state = 1;
  for (const int tile : {2, 9, film.tile_count() - 1})
    for (double& sum : film.tile_sums(tile)) {
      state = state * 1664525u + 1013904223u;
      sum = static_cast<double>(state >> 8) * static_cast<double>(tile);
    }
  const FilmImages images = film.images(0, on(3));
  const ImageParts parts = film.lit_parts();
  ASSERT_EQ(parts.size(), 3u);
  // One by one, in the order of the pixels.
  const PixelValues &flux = images.flux.pixels, &error = images.standard_error.pixels;
  const float largest = *std::max_element(flux.begin(), flux.end());
  double sum = 0, lit = 0, may_be = 0, squares = 0, total = 0;
  for (std::size_t i = 0; i < flux.size(); ++i) {
    const double f = static_cast<double>(flux[i]), e = static_cast<double>(error[i]);
    sum += f;
    if (f + 2 * e > 0.01 * static_cast<double>(largest)) may_be += 1;
    if (!(f > 0.01 * static_cast<double>(largest))) continue;
    lit += 1;
    squares += e * e;
    total += f;
  }
  ASSERT_GT(may_be, lit);
  ASSERT_GT(flux.size() / 2, lit);
  const StatedError whole = stated_error(images.flux, images.standard_error, 4);
  EXPECT_TRUE(relative(whole.relative_rmse, std::sqrt(squares / lit) / (total / lit), 1e-12));
  EXPECT_GT(whole.bound, whole.relative_rmse * std::sqrt(may_be / lit));
  // In rows that are no whole number of lanes; what is no number is not lit.
  Image odd(101, 2, 5), its_error(101, 2, 2);
  odd.at(100, 1) = its_error.at(100, 1) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(largest_of(odd, whole_of(odd), on(1)), 5);
  const StatedError of_odd = stated_error(odd, its_error, 2, whole_of(odd), on(1));
  EXPECT_TRUE(relative(of_odd.relative_rmse, 0.4, 1e-12));
  EXPECT_GT(of_odd.bound, 0.4);
  for (const int threads : {1, 2, 3}) {
    EXPECT_EQ(largest_of(images.flux, parts, on(threads)), largest);
    EXPECT_EQ(sum_of(images.flux, parts, on(threads)), sum_of(images.flux, parts, on(1)));
    EXPECT_TRUE(relative(sum_of(images.flux, parts, on(threads)), sum, 1e-12));
    EXPECT_TRUE(relative(sum_of(images.flux, whole_of(images.flux), on(threads)), sum, 1e-12));
    const StatedError stated =
        stated_error(images.flux, images.standard_error, 4, parts, on(threads));
    EXPECT_TRUE(relative(stated.relative_rmse, whole.relative_rmse, 1e-12));
    EXPECT_TRUE(relative(stated.bound, whole.bound, 1e-9));
    EXPECT_EQ(stated.relative_rmse,
              stated_error(images.flux, images.standard_error, 4, parts, on(1)).relative_rmse);
  }
}

}  // namespace
}  // namespace plenoflame::test::lit_runs_test
