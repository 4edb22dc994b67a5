// Patterns by the share of them that is dark, and by their corners.
#include <gtest/gtest.h>

#include "core/solids/surface_samples.h"
#include "plenoflame/image/png_file.h"
#include "solids/texture.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

namespace plenoflame::test::texture_test {
namespace {

TextureSpec pattern(TextureKind kind) {
  TextureSpec spec;
  spec.kind = kind;
  spec.cell = 0.02;
  spec.columns = 7;
  spec.rows = 4;
  spec.dark = 0.05;
  return spec;
}

/// Share of a rectangle (full sides) that is dark, on a fine grid.
double dark_share(const Texture& texture, double width, double height) {
  constexpr int kSteps = 1200;
  int dark = 0;
  for (int j = 0; j < kSteps; ++j)
    for (int i = 0; i < kSteps; ++i)
      dark += texture.reflectivity(
                  {((i + 0.5) / kSteps - 0.5) * width, ((j + 0.5) / kSteps - 0.5) * height}) < 0.5;
  return static_cast<double>(dark) / (kSteps * kSteps);
}

TEST(Texture, SharesThatAreDark) {
  const Texture board(pattern(TextureKind::checkerboard), 0.9, "");
  EXPECT_TRUE(relative(dark_share(board, 0.14, 0.08), 0.5, 1e-3));
  EXPECT_TRUE(relative(dark_share(board, 0.28, 0.16), 0.125, 1e-3));  // light around it
  const Texture dots(pattern(TextureKind::dots), 0.9, "");
  EXPECT_TRUE(relative(dark_share(dots, 0.14, 0.08), 3.14159265358979 / 16, 2e-3));
  TextureSpec star = pattern(TextureKind::siemens_star);
  star.size = {0.1, 0.1};
  EXPECT_TRUE(relative(dark_share(Texture(star, 0.9, ""), 0.1, 0.1), 3.14159265358979 / 8, 2e-3));
  // Each group of bars: 2 x 3 bars of half a period by two and a half.
  TextureSpec bars = pattern(TextureKind::bars);
  bars.columns = 3;
  const double area = 7.5 * 0.02 * 0.02 * (1 + 0.5 + 0.25);
  EXPECT_TRUE(relative(dark_share(Texture(bars, 0.9, ""), 0.2, 0.2) * 0.04, area, 5e-3));
}

// Around every mark of a checkerboard the four squares alternate; every mark of a dot grid is the
// centre of what is dark around it.
TEST(Texture, MarksAreCornersAndCentres) {
  const Texture board(pattern(TextureKind::checkerboard), 0.9, "");
  const auto corners = board.marks();
  ASSERT_EQ(corners.size(), 6u * 3u);
  EXPECT_EQ(corners[0].column, 0);
  EXPECT_LT(corners[0].at.x, corners[1].at.x);
  EXPECT_GT(corners[0].at.y, corners[6].at.y);
  const double e = 1e-9;
  for (const Texture::Mark& mark : corners) {
    const double a = board.reflectivity({mark.at.x + e, mark.at.y + e});
    const double b = board.reflectivity({mark.at.x - e, mark.at.y + e});
    EXPECT_NE(a, b);
    EXPECT_EQ(a, board.reflectivity({mark.at.x - e, mark.at.y - e}));
    EXPECT_EQ(b, board.reflectivity({mark.at.x + e, mark.at.y - e}));
  }
  const Texture dots(pattern(TextureKind::dots), 0.9, "");
  ASSERT_EQ(dots.marks().size(), 7u * 4u);
  for (const Texture::Mark& mark : dots.marks())
    for (const double turn : {0.0, 1.3, 2.9, 4.4}) {
      const Vec2 way{std::cos(turn), std::sin(turn)};
      EXPECT_EQ(dots.reflectivity(mark.at + 0.00499 * way), 0.05);
      EXPECT_EQ(dots.reflectivity(mark.at + 0.00501 * way), 0.9);
    }
}

// A picture of two columns and two rows: upright, linear in light, between its pixels straight.
TEST(Texture, Images) {
  TemporaryFolder folder;
  PngImage image;
  image.width = image.height = 2;
  image.transfer = Transfer::linear;
  image.samples = {0, 255, 51, 102};
  write_png(folder.file("p.png"), image);
  TextureSpec spec = pattern(TextureKind::image);
  spec.file = "p.png";
  spec.size = {4, 2};
  spec.dark = 0;
  const Texture texture(spec, 0.5, folder.path());
  EXPECT_TRUE(relative(texture.reflectivity({1, 0.5}), 0.5, 1e-6));    // top right
  EXPECT_TRUE(relative(texture.reflectivity({-1, -0.5}), 0.1, 1e-6));  // bottom left
  EXPECT_TRUE(relative(texture.reflectivity({1, -0.5}), 0.2, 1e-6));
  EXPECT_TRUE(relative(texture.reflectivity({0, 0.5}), 0.25, 1e-6));  // between 0 and 1
  EXPECT_TRUE(relative(texture.reflectivity({0, 0}), 0.5 * 1.6 / 4, 1e-6));
}

TEST(Texture, PatternPointsOfTurnedPlates) {
  SolidSurfaceSpec plate = shaped(SolidShape::plane, 1);
  plate.extent = {0.2, 0.2};
  plate.position = {1, 2, 3};
  plate.rotation = {0, -1.5707963267948966, 0};  // its x up, its z towards -x
  plate.material.texture = pattern(TextureKind::dots);
  const auto points = scene_of({plate})->pattern_points();
  ASSERT_EQ(points.size(), 28u);
  EXPECT_TRUE(within(points[0].point.x, 1, 1e-15, 1));
  EXPECT_TRUE(relative(points[0].point.y, 2 + 0.03, 1e-14));
  EXPECT_TRUE(relative(points[0].point.z, 3 - 0.06, 1e-14));
}

}  // namespace
}  // namespace plenoflame::test::texture_test
