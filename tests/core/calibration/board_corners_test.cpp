// Boards found in rendered raw pictures, against the places where exact rays image their points.
#include "plenoflame/calibration/board_corners.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "plenoflame/base/error.h"
#include "plenoflame/render/pattern_images.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/scene_file.h"
#include "support/approx.h"

namespace plenoflame::test::board_corners_test {
namespace {

constexpr const char* kCamera = R"toml(
[camera.lens]
model = "ideal"
focal_length = "50 mm"
diameter = "16 mm"
[camera.array]
lattice = "hexagonal"
model = "ideal"
pitch = "126 um"
diameter = "124 um"
rotation = "4 mrad"
offset = ["20 um", "-30 um"]
sensor_distance = "0.4 mm"
[[camera.array.types]]
name = "all"
focal_length = "0.5 mm"
[camera.focus]
mode = "distance"
lens_distance = "57.5 mm"
[camera.sensor]
columns = 560
rows = 440
pixel_pitch = "5.5 um"
[[channels]]
name = "red"
kind = "line"
wavelength = "650 nm"
width = "10 nm"
[[lights]]
kind = "environment"
radiance = "10 W/(m^2 sr)"
)toml";

struct Picture {
  Image light;
  CameraSpec camera;
  std::vector<PatternImage> truth;
};

/// @param kind of pattern @param y [mm] place of the board's middle across the axis
Picture picture_of(const std::string& kind, int columns, int rows, double y = 0.2) {
  const std::string board = R"(
[[surfaces]]
name = "board"
shape = "plane"
position = ["313 mm", ")" + std::to_string(y) +
                            R"( mm", "-0.3 mm"]
rotation = ["8 deg", "-102 deg", "10 deg"]
extent = ["60 mm", "60 mm"]
material.reflectivity = 0.9
[surfaces.material.texture]
kind = ")" + kind + R"("
dark = 0.05
cell = "2.5 mm"
columns = )" + std::to_string(columns) +
                            "\nrows = " + std::to_string(rows) + "\n";
  const CompiledScene scene = compile(parse_scene(std::string(kCamera) + board, "test.toml").scene);
  RenderSettings settings;
  settings.samples = 16;
  Picture picture{render(scene, settings).light_field.channels[0].flux, scene.scene.camera,
                  pattern_images(scene, 1024, {})};
  // 4000 electrons in the brightest pixels, without units.
  float brightest = 0;
  for (const float value : picture.light.pixels) brightest = std::max(brightest, value);
  std::mt19937_64 random(7);
  std::normal_distribution<float> normal;
  for (float& value : picture.light.pixels) {
    value *= 4000 / brightest;
    value += std::sqrt(std::max(value, 0.0F) + 36) * normal(random);
  }
  return picture;
}

/// Each corner that was found lies where the rays of one point arrive, and names one and the same
/// point whenever its column and row are the same.
void expect_found(const Picture& picture, const BoardCorners& found, double rms) {
  std::map<std::pair<int, int>, std::set<std::pair<int, int>>> meant;
  double squares = 0;
  for (const BoardCorner& corner : found.corners) {
    double least = std::numeric_limits<double>::infinity();
    std::pair<int, int> point;
    for (const PatternImage& image : picture.truth) {
      if (image.image.lens.q != corner.lens.q || image.image.lens.r != corner.lens.r) continue;
      const double d = length(Vec2{image.image.column, image.image.row} - corner.pixel);
      if (d >= least) continue;
      least = d;
      point = {image.point.column, image.point.row};
    }
    EXPECT_LT(least, 10 * rms) << corner.column << " " << corner.row;
    squares += 0.5 * least * least;
    meant[{corner.column, corner.row}].insert(point);
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(found.corners.size())), rms);
  std::set<std::pair<int, int>> points;
  for (const auto& [label, of] : meant) {
    EXPECT_EQ(of.size(), 1u) << label.first << " " << label.second;
    points.insert(of.begin(), of.end());
  }
  EXPECT_EQ(points.size(), meant.size());
  // Steps of columns and rows are steps of the board.
  for (const auto& [label, of] : meant) {
    const auto next = meant.find({label.first + 1, label.second});
    if (next == meant.end()) continue;
    const auto a = *of.begin(), b = *next->second.begin();
    EXPECT_EQ(std::abs(a.first - b.first) + std::abs(a.second - b.second), 1);
  }
}

TEST(BoardCorners, OfACheckerboard) {
  const Picture picture = picture_of("checkerboard", 6, 5);
  const BoardCorners found = find_board(picture.light, picture.camera, {false, 5, 4, 2.5e-3});
  EXPECT_EQ(found.points, 20u);
  EXPECT_TRUE(found.whole);
  EXPECT_GT(found.corners.size(), 100u);
  EXPECT_TRUE(relative(found.distance, 0.313, 0.02));
  expect_found(picture, found, 0.06);
}

TEST(BoardCorners, OfDots) {
  const Picture picture = picture_of("dots", 5, 4);
  const BoardCorners found = find_board(picture.light, picture.camera, {true, 5, 4, 2.5e-3});
  EXPECT_EQ(found.points, 20u);
  EXPECT_GT(found.corners.size(), 60u);
  expect_found(picture, found, 0.12);
}

TEST(BoardCorners, OfAPartOfABoard) {
  const Picture picture = picture_of("checkerboard", 12, 12, 12);
  const BoardCorners found = find_board(picture.light, picture.camera, {false, 11, 11, 2.5e-3});
  EXPECT_FALSE(found.whole);
  EXPECT_GE(found.points, 8u);
  expect_found(picture, found, 0.06);
}

// A whole board with an odd number of columns and rows together has but one first corner: turned by
// half a turn it is another one in the picture, and the same one of the board.
TEST(BoardCorners, TheFirstCornerIsThatOfTheBoard) {
  const Picture picture = picture_of("checkerboard", 6, 5);
  const BoardCorners upright = find_board(picture.light, picture.camera, {false, 5, 4, 2.5e-3});
  Picture turned = picture;
  std::reverse(turned.light.pixels.begin(), turned.light.pixels.end());
  turned.camera.array.offset = -1.0 * picture.camera.array.offset;
  const BoardCorners reversed = find_board(turned.light, turned.camera, {false, 5, 4, 2.5e-3});
  ASSERT_TRUE(upright.whole && reversed.whole);
  const auto mean = [](const BoardCorners& corners) {
    Vec2 sum;
    double count = 0;
    for (const BoardCorner& c : corners.corners)
      if (c.column == 0 && c.row == 0) sum = sum + c.pixel, count += 1;
    return (1 / count) * sum;
  };
  const Vec2 a = mean(upright), b = mean(reversed);
  EXPECT_LT(length(Vec2{560 - b.x, 440 - b.y} - a), 3);
}

TEST(BoardCorners, SaysWhatWasSeen) {
  const Picture picture = picture_of("checkerboard", 6, 5);
  const auto reason = [&](const Image& light, const BoardSpec& board) {
    try {
      find_board(light, picture.camera, board);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  Image even(picture.light.width, picture.light.height);
  std::fill(even.pixels.begin(), even.pixels.end(), 100.0F);
  EXPECT_NE(reason(even, {false, 5, 4, 2.5e-3}).find("no board is seen: 0 corners"),
            std::string::npos);
  EXPECT_NE(reason(picture.light, {false, 5, 4, 10e-3}).find("10 mm"), std::string::npos);
  EXPECT_NE(reason(picture.light, {false, 3, 3, 2.5e-3}).find("more than the board's 3 x 3"),
            std::string::npos);
  EXPECT_NE(reason(Image(20, 20), {false, 5, 4, 2.5e-3}).find("20 x 20"), std::string::npos);
  EXPECT_NE(reason(picture.light, {false, 1, 4, 2.5e-3}).find("2 x 2"), std::string::npos);
}

}  // namespace
}  // namespace plenoflame::test::board_corners_test
