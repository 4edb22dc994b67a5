// Films of finished pictures that take more samples.
#include "plenoflame/film/reopened.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::test::reopened_test {
namespace {

constexpr PixelWindow kWindow{13, 9, 100, 70};  // partial tiles

/// Sums of every replicate at random; one tile stays dark.
Film random_film(int channels, int replicates, std::uint64_t seed) {
  Film film(kWindow, channels, replicates);
  std::mt19937_64 random(seed);
  for (int tile = 0; tile < film.tile_count(); ++tile) {
    film.add_samples(tile, 8);
    if (tile == 1) continue;
    for (double& sum : film.tile_sums(tile))
      sum = std::uniform_real_distribution<double>(1, 3)(random);
  }
  return film;
}

LightField picture_of(const Film& film) {
  LightField picture;
  picture.window = film.window();
  for (int c = 0; c < film.channels(); ++c) {
    const FilmImages images = film.images(c);
    picture.channels.push_back({std::to_string(c), images.flux, images.standard_error});
  }
  picture.samples = 8.0 * film.replicates();
  picture.numbers["render.replicates"] = film.replicates();
  if (const std::string text = tile_samples_text(film); !text.empty())
    picture.texts[kTileSamples] = text;
  return picture;
}

TEST(Reopened, EstimateAndErrorStay) {
  for (const int replicates : {1, 2, 3, 4}) {
    const Film film = random_film(2, replicates, 1);
    const Film open = film_of(picture_of(film));
    EXPECT_EQ(open.all_tile_samples(), film.all_tile_samples());
    EXPECT_TRUE(open.tile_sums(1).empty());
    for (int c = 0; c < 2; ++c) {
      const FilmImages before = film.images(c), after = open.images(c);
      for (std::size_t i = 0; i < before.flux.pixels.size(); ++i) {
        ASSERT_TRUE(relative(static_cast<double>(after.flux.pixels[i]),
                             static_cast<double>(before.flux.pixels[i]), 1e-6));
        if (replicates > 1) {
          ASSERT_TRUE(relative(static_cast<double>(after.standard_error.pixels[i]),
                               static_cast<double>(before.standard_error.pixels[i]), 1e-6))
              << replicates;
        }
      }
      EXPECT_EQ(after.standard_error.empty(), replicates == 1);
    }
  }
}

// The mean square of the errors of two films' mean is the mean of theirs over two: places of
// replicates that went with the new ones' would make it larger or smaller.
TEST(Reopened, ErrorsOfMoreSamplesAddInSquares) {
  const Film first = random_film(1, 2, 2), second = random_film(1, 2, 3);
  Film both = film_of(picture_of(first));
  for (int tile = 0; tile < both.tile_count(); ++tile) {
    both.add_samples(tile, second.tile_samples(tile));
    if (second.tile_sums(tile).empty()) continue;
    for (std::size_t i = 0; i < both.tile_sums(tile).size(); ++i)
      both.tile_sums(tile)[i] += second.tile_sums(tile)[i];
  }
  const auto mean_square = [](const Film& film) {
    double sum = 0;
    for (const float e : film.images(0).standard_error.pixels)
      sum += static_cast<double>(e) * static_cast<double>(e);
    return sum;
  };
  // 4400 lit pixels: the mean of the cross terms is off by a share of 1 / sqrt(4400) or so.
  EXPECT_TRUE(relative(mean_square(both), (mean_square(first) + mean_square(second)) / 4, 0.06));
}

TEST(Reopened, TilesOfDifferentSamples) {
  Film film = random_film(1, 2, 4);
  EXPECT_EQ(tile_samples_text(film), "");
  film.add_samples(3, 56);
  EXPECT_EQ(tile_samples_text(film), "3x8 1x64");
  const LightField picture = picture_of(film);
  EXPECT_EQ(film_of(picture).all_tile_samples(), film.all_tile_samples());
  for (const char* wrong :
       {"3x8", "4x8 1x64", "3x8 1y64", "3x8 1x-1", "x", "3x8 1x", "99999999999999999999x1"}) {
    LightField bad = picture;
    bad.texts[kTileSamples] = wrong;
    EXPECT_THROW(film_of(bad), InputError) << wrong;
  }
  LightField none = picture;
  none.numbers.clear();
  EXPECT_THROW(film_of(none), InputError);
}

}  // namespace
}  // namespace plenoflame::test::reopened_test
