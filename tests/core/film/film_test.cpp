#include "plenoflame/film/film.h"

#include <cmath>

#include "support/approx.h"

namespace plenoflame::test {
namespace {

TEST(Film, MeanAndStandardErrorOfReplicates) {
  Film film({10, 20, 3, 2}, 2, 4);
  // Four replicates of 8 samples each: means 1, 2, 4, 5 of the second channel at (12, 21).
  const double sums[] = {8, 16, 32, 40};
  for (int r = 0; r < 4; ++r) film.sum(1, r, 12, 21) += sums[r];
  const Image flux = film.flux(1, 8), error = film.standard_error(1, 8);
  EXPECT_TRUE(relative(flux.at(2, 1), 3, 1e-7));
  // Sample variance (4 + 1 + 1 + 4) / 3, over four.
  EXPECT_TRUE(relative(error.at(2, 1), std::sqrt(10.0 / 12), 1e-7));
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 3; ++column) {
      EXPECT_EQ(film.flux(0, 8).at(column, row), 0.f);
      if (column == 2 && row == 1) continue;
      EXPECT_EQ(flux.at(column, row), 0.f);
    }
}

TEST(Film, OneReplicateHasNoStandardError) {
  Film film({0, 0, 1, 1}, 1, 1);
  film.sum(0, 0, 0, 0) = 6;
  EXPECT_TRUE(relative(film.flux(0, 3).at(0, 0), 2, 1e-7));
  EXPECT_TRUE(film.standard_error(0, 3).empty());
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
}  // namespace plenoflame::test
