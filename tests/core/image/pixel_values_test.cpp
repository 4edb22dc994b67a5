#include <algorithm>
#include <utility>

#include <gtest/gtest.h>

#include "plenoflame/image/image.h"

namespace plenoflame::test::pixel_values_test {
namespace {

TEST(PixelValues, AreZeroUntilTheyAreSet) {
  for (int round = 0; round < 20; ++round) {
    // Memory that was used before, small and large.
    for (const std::size_t count : {7u, 4096u, 1u << 20}) {
      PixelValues used(count, 3.5F);
      EXPECT_EQ(std::count(used.begin(), used.end(), 3.5F), static_cast<std::ptrdiff_t>(count));
    }
    for (const int side : {3, 64, 1024}) {
      const Image image(side, side);
      ASSERT_EQ(image.pixels.size(), static_cast<std::size_t>(side * side));
      EXPECT_EQ(std::count(image.pixels.begin(), image.pixels.end(), 0.0F), side * side);
    }
  }
}

TEST(PixelValues, GrowByZerosWhereOthersWere) {
  PixelValues values(1000, -2.0F);
  values.resize(10);
  values.resize(900);
  EXPECT_EQ(std::count(values.begin(), values.end(), -2.0F), 10);
  EXPECT_EQ(std::count(values.begin(), values.end(), 0.0F), 890);
  values.clear();
  values.resize(1000);
  EXPECT_EQ(std::count(values.begin(), values.end(), 0.0F), 1000);
  values.resize(100000);
  EXPECT_EQ(std::count(values.begin(), values.end(), 0.0F), 100000);
}

TEST(PixelValues, AreCopiedMovedAndCompared) {
  Image image(4, 2, 1.5F);
  image.at(3, 1) = 2;
  Image copy = image;
  EXPECT_EQ(copy.pixels, image.pixels);
  copy.at(0, 0) = 0;
  EXPECT_NE(copy.pixels, image.pixels);
  const Image moved = std::move(copy);
  EXPECT_EQ(moved.at(0, 0), 0);
  EXPECT_EQ(moved.at(3, 1), 2);
  EXPECT_EQ(moved.at(1, 1), 1.5F);
}

}  // namespace
}  // namespace plenoflame::test::pixel_values_test
