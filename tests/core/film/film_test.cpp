#include "plenoflame/film/film.h"

#include <cmath>
#include <utility>

#include "support/approx.h"

namespace plenoflame::test::film_test {
namespace {

TEST(Film, MeanAndStandardErrorOfReplicates) {
  Film film({10, 20, 3, 2}, 2, 4);
  // Four replicates of 8 samples each: means 1, 2, 4, 5 of the second channel at (12, 21).
  const double sums[] = {8, 16, 32, 40};
  for (int r = 0; r < 4; ++r) film.sum(1, r, 12, 21) += sums[r];
  film.add_samples(0, 8);
  const auto [flux, error] = film.images(1);
  EXPECT_TRUE(relative(flux.at(2, 1), 3, 1e-7));
  // Sample variance (4 + 1 + 1 + 4) / 3, over four.
  EXPECT_TRUE(relative(error.at(2, 1), std::sqrt(10.0 / 12), 1e-7));
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 3; ++column) {
      EXPECT_EQ(film.images(0).flux.at(column, row), 0.f);
      if (column == 2 && row == 1) continue;
      EXPECT_EQ(flux.at(column, row), 0.f);
    }
}

// Every value in a place of its own, on a film of several tiles of different sizes.
TEST(Film, EachSumHasItsPlace) {
  const PixelWindow w{7, 5, 2 * Film::kTile + 3, Film::kTile + 2};
  Film film(w, 2, 3);
  ASSERT_EQ(film.tile_count(), 6);
  const auto value = [](int c, int r, int column, int row) {
    return 1 + c + 2 * (r + 3.0 * (column + 1000.0 * row));
  };
  for (int row = w.y; row < w.y + w.height; ++row)
    for (int column = w.x; column < w.x + w.width; ++column)
      for (int c = 0; c < 2; ++c)
        for (int r = 0; r < 3; ++r) film.sum(c, r, column, row) = value(c, r, column, row);
  for (int tile = 0; tile < film.tile_count(); ++tile) film.add_samples(tile, 1 + tile);
  for (int c = 0; c < 2; ++c) {
    const auto [flux, error] = film.images(c);
    for (int tile = 0; tile < film.tile_count(); ++tile) {
      const PixelWindow part = film.tile(tile);
      for (int row = part.y; row < part.y + part.height; ++row)
        for (int column = part.x; column < part.x + part.width; ++column) {
          // Replicates differ by 2 from one to the next: variance 4, of the mean 4 / 3.
          const double mean = value(c, 1, column, row) / (1 + tile);
          ASSERT_EQ(flux.at(column - w.x, row - w.y), static_cast<float>(mean));
          ASSERT_TRUE(
              relative(error.at(column - w.x, row - w.y), std::sqrt(4.0 / 3) / (1 + tile), 1e-7));
          ASSERT_EQ(std::as_const(film).sum(c, 2, column, row), value(c, 2, column, row));
        }
    }
  }
}

TEST(Film, TilesWithoutLightTakeNoMemory) {
  Film film({0, 0, 3 * Film::kTile, 1}, 1, 4);
  film.sum(0, 3, Film::kTile + 1, 0) = 1;
  const Film& kept = film;
  EXPECT_TRUE(kept.tile_sums(0).empty());
  EXPECT_EQ(kept.tile_sums(1).size(), static_cast<std::size_t>(4 * Film::kTile));
  EXPECT_TRUE(kept.tile_sums(2).empty());
  EXPECT_EQ(kept.sum(0, 0, 5, 0), 0);
}

TEST(Film, OneReplicateHasNoStandardError) {
  Film film({0, 0, 1, 1}, 1, 1);
  film.sum(0, 0, 0, 0) = 6;
  film.add_samples(0, 3);
  const auto [flux, error] = film.images(0);
  EXPECT_TRUE(relative(flux.at(0, 0), 2, 1e-7));
  EXPECT_TRUE(error.empty());
}

TEST(Film, RelativeErrorOverLitPixels) {
  Image flux(4, 1), error(4, 1);
  const float f[] = {100, 50, 0.5f, 0}, e[] = {3, 4, 70, 80};
  for (int i = 0; i < 4; ++i) {
    flux.at(i, 0) = f[i];
    error.at(i, 0) = e[i];
  }
  // The third pixel is below a hundredth of the largest: not lit.
  EXPECT_TRUE(relative(estimated_relative_rmse(flux, error), std::sqrt(12.5) / 75, 1e-7));
  EXPECT_EQ(estimated_relative_rmse(Image(2, 2), Image(2, 2)), 0);
}

}  // namespace
}  // namespace plenoflame::test::film_test
