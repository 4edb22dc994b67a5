// Boards found in rendered raw pictures, against the places where exact rays image their points.
#include "plenoflame/calibration/board_corners.h"

#include <fmt/format.h>
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
#include "support/length.h"
#include "support/thin_camera.h"

namespace plenoflame::test::board_corners_test {
namespace {

constexpr const char* kCamera = R"toml(
[camera.lens]
model = "ideal"
focal_length = "50 mm"
[camera.array]
lattice = "hexagonal"
model = "ideal"
pitch = "126 um"
diameter = "124 um"
rotation = "4 mrad"
offset = ["20 um", "-30 um"]
sensor_distance = "0.4 mm"
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

constexpr const char* kOneType = R"toml(
[[camera.array.types]]
name = "all"
focal_length = "0.5 mm"
)toml";
constexpr const char* kThreeTypes = R"toml(
[[camera.array.types]]
name = "a"
focal_length = "0.5 mm"
[[camera.array.types]]
name = "b"
focal_length = "0.46 mm"
[[camera.array.types]]
name = "c"
focal_length = "0.56 mm"
)toml";

struct Picture {
  Image light;
  CameraSpec camera;
  std::vector<PatternImage> truth;
};

/// @param types of microlenses
Picture clean_picture(const std::string& board, const char* types, double f_number, int samples) {
  const std::string aperture =
      "[camera.lens]\ndiameter = \"" + std::to_string(50 / f_number) + " mm\"";
  std::string camera = kCamera;
  camera.replace(camera.find("[camera.lens]"), 13, aperture);
  const CompiledScene scene = compile(parse_scene(camera + types + board, "test.toml").scene);
  RenderSettings settings;
  settings.samples = samples;
  return {render(scene, settings).light_field.channels[0].flux, scene.scene.camera,
          pattern_images(scene, 1024, {})};
}

/// @param electrons in the brightest pixels
Picture with_noise(Picture picture, float electrons) {
  float brightest = 0;
  for (const float value : picture.light.pixels) brightest = std::max(brightest, value);
  std::mt19937_64 random(7);
  std::normal_distribution<float> normal;
  for (float& value : picture.light.pixels) {
    value *= electrons / brightest;
    value += std::sqrt(std::max(value, 0.0F) + 36) * normal(random);
  }
  return picture;
}

/// @param y [mm] of the middle across the axis @param cell [mm]
std::string board_of(const std::string& kind, int columns, int rows, double y, double cell) {
  return R"(
[[surfaces]]
name = "board"
shape = "plane"
position = ["313 mm", ")" +
         std::to_string(y) + R"( mm", "-0.3 mm"]
rotation = ["8 deg", "-102 deg", "10 deg"]
extent = ["60 mm", "60 mm"]
material.reflectivity = 0.9
[surfaces.material.texture]
kind = ")" +
         kind + R"("
dark = 0.05
cell = ")" +
         std::to_string(cell) + " mm\"\ncolumns = " + std::to_string(columns) +
         "\nrows = " + std::to_string(rows) + "\n";
}

Picture picture_of(const std::string& kind, int columns, int rows, double y = 0.2) {
  return with_noise(clean_picture(board_of(kind, columns, rows, y, 2.5), kOneType, 3.125, 16),
                    4000);
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

/// The place of a board's first corner: the mean over the micro-images that show it [pixel].
Vec2 first_corner(const BoardCorners& board) {
  Vec2 sum;
  double count = 0;
  for (const BoardCorner& c : board.corners)
    if (c.column == 0 && c.row == 0) sum = sum + c.pixel, count += 1;
  return (1 / count) * sum;
}

// A whole board with an odd number of columns and rows together has but one first corner: turned by
// half a turn it is another one in the picture, and the same one of the board.
void expect_first_corner_of_the_board(Picture picture, const BoardCorners& upright) {
  std::reverse(picture.light.pixels.begin(), picture.light.pixels.end());
  picture.camera.array.offset = -1.0 * picture.camera.array.offset;
  const BoardCorners turned = find_board(picture.light, picture.camera, {false, 5, 4, 2.5e-3});
  ASSERT_TRUE(upright.whole && turned.whole);
  const Vec2 a = first_corner(upright), b = first_corner(turned);
  EXPECT_LT(length(Vec2{560 - b.x, 440 - b.y} - a), 3);
}

void expect_it_says_what_was_seen(const Picture& picture) {
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
  const std::string none = reason(even, {false, 5, 4, 2.5e-3});
  EXPECT_NE(none.find("no board is seen: 0 corners"), std::string::npos) << none;
  // A pixel is p (z / f - 1) a / B wide, where a is from the array to the image of z.
  const std::size_t at = none.find("and at ");
  ASSERT_NE(at, std::string::npos) << none;
  const double z = std::stod(none.substr(at + 7)), f = 50e-3, array = 57.5e-3;
  const double a = std::fabs(array - 1 / (1 / f - 1 / z));
  EXPECT_TRUE(relative(6 * 5.5e-6 * (z / f - 1) * a / 0.4e-3, 2.5e-3, 0.05)) << none;
  EXPECT_NE(reason(picture.light, {false, 5, 4, 10e-3}).find("10 mm"), std::string::npos);
  EXPECT_NE(reason(picture.light, {false, 3, 3, 2.5e-3}).find("more than the board's 3 x 3"),
            std::string::npos);
  EXPECT_NE(reason(Image(20, 20), {false, 5, 4, 2.5e-3}).find("20 x 20"), std::string::npos);
  EXPECT_NE(reason(picture.light, {false, 1, 4, 2.5e-3}).find("2 x 2"), std::string::npos);
}

// One picture for all of it: to make it and to find its board take seconds.
TEST(BoardCorners, OfACheckerboard) {
  const Picture picture = picture_of("checkerboard", 6, 5);
  const BoardCorners found = find_board(picture.light, picture.camera, {false, 5, 4, 2.5e-3});
  EXPECT_EQ(found.points, 20u);
  EXPECT_TRUE(found.whole);
  EXPECT_GT(found.corners.size(), 100u);
  EXPECT_TRUE(relative(found.distance, 0.313, 0.02));
  expect_found(picture, found, 0.06);
  expect_first_corner_of_the_board(picture, found);
  expect_it_says_what_was_seen(picture);
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

/// Pixel of a point at p (camera axes) behind a microlens at c: the thin lens images p, and a
/// straight line goes from that through c.
Vec2 thin_projection(const CameraSpec& s, Vec3 p, Vec2 c) {
  const double behind = 1 / (1 / s.lens.focal_length - 1 / p.z), a = s.focus.lens_distance - behind;
  const Vec2 at = c + (s.array.sensor_distance / a) * (c + (behind / p.z) * Vec2{p.x, p.y});
  return {0.5 * s.sensor.columns - at.x / s.sensor.pixel_pitch,
          0.5 * s.sensor.rows - at.y / s.sensor.pixel_pitch};
}

/// Errors of corners in a part of the micro-images.
struct CornerErrors {
  double count = 0, outwards = 0, squares = 0, pulls = 0;
  double blur = 0, blur_pulls = 0, blur_count = 0;
};

// Stop and microlenses blur and cut off what surrounds a corner. Its place moves neither outwards
// in the micro-image nor by more than its stated error, whether micro-images touch or are small.
class CornerPlaces : public testing::TestWithParam<double> {};

/// Errors by type and by whether a corner lies near the rim of its micro-image.
std::map<std::pair<int, bool>, CornerErrors> corner_errors(const Picture& picture,
                                                           double f_number) {
  const CameraSpec& camera = picture.camera;
  const BoardCorners found = find_board(picture.light, camera, {false, 5, 4, 3e-3});
  EXPECT_GE(found.points, f_number < 6 ? 20u : 14u);
  const MicrolensLattice lattice(camera.array);
  const double stop = 0.5 * camera.array.sensor_distance * camera.lens.focal_length / f_number /
                      camera.focus.lens_distance / camera.sensor.pixel_pitch;
  std::map<std::pair<int, bool>, CornerErrors> parts;
  for (const BoardCorner& corner : found.corners) {
    const Vec2 c = lattice.centre(corner.lens);
    Vec2 truth;
    double z = 0;
    double least = std::numeric_limits<double>::infinity();
    for (const PatternImage& image : picture.truth) {
      const Vec2 pixel = thin_projection(camera, image.in_camera, c);
      if (length(pixel - corner.pixel) >= least) continue;
      least = length(pixel - corner.pixel);
      truth = pixel;
      z = image.in_camera.z;
    }
    // The ray through the middle of the stop.
    const Vec2 out = truth - thin_projection(camera, {0, 0, 1e-9}, c), off = corner.pixel - truth;
    CornerErrors& part = parts[{lattice.type(corner.lens), length(out) > 0.6 * stop}];
    part.count += 1;
    part.outwards += dot(off, out) / length(out);
    part.squares += 0.5 * dot(off, off);
    part.pulls += 0.5 * dot(off, off) / (corner.error * corner.error);
    // The blur of a nearly sharp corner is hardly known.
    if (!(corner.blur_error > 0 && corner.blur_error < 0.5)) continue;
    const double blur = corner.blur - thin_camera::blur_at(camera, z, lattice.type(corner.lens));
    part.blur += blur;
    part.blur_pulls += std::pow(blur / corner.blur_error, 2);
    part.blur_count += 1;
  }
  return parts;
}

TEST_P(CornerPlaces, AreThoseOfTheMiddleOfTheMicrolens) {
  const double f_number = GetParam();
  const Picture clean =
      clean_picture(board_of("checkerboard", 6, 5, 0.2, 3), kThreeTypes, f_number, 64);
  CornerErrors all;
  for (const auto& [where, part] : corner_errors(with_noise(clean, 4000), f_number)) {
    const double outwards = part.outwards / part.count,
                 noise = std::sqrt(part.squares) / part.count;
    std::printf("f/%g, type %d, %s: %3.0f corners, outwards %+.4f pixel, %.4f RMS\n", f_number,
                where.first, where.second ? "rim   " : "middle", part.count, outwards,
                std::sqrt(part.squares / part.count));
    EXPECT_LT(std::fabs(outwards), 0.01 + 2 * noise) << where.first;
    all.count += part.count;
    all.outwards += part.outwards;
    all.squares += part.squares;
  }
  EXPECT_LT(std::fabs(all.outwards / all.count), 0.01);
  EXPECT_LT(std::sqrt(all.squares / all.count), f_number < 6 ? 0.025 : 0.04);
  // In dark pictures, noise of the light exceeds that of the rendering.
  all = {};
  for (const auto& [where, part] : corner_errors(with_noise(clean, 300), f_number)) {
    all.count += part.count;
    all.pulls += part.pulls;
    all.blur += part.blur;
    all.blur_pulls += part.blur_pulls;
    all.blur_count += part.blur_count;
  }
  const double pull = std::sqrt(all.pulls / all.count);
  std::printf("f/%g: %.0f corners, errors are %.2f times the stated ones\n", f_number, all.count,
              pull);
  EXPECT_GT(pull, 0.75);
  EXPECT_LT(pull, 1.3);
  const double blur_pull = std::sqrt(all.blur_pulls / all.blur_count);
  std::printf("f/%g: blur of %.0f corners, %+.4f pixel, errors are %.2f times the stated ones\n",
              f_number, all.blur_count, all.blur / all.blur_count, blur_pull);
  EXPECT_LT(std::fabs(all.blur / all.blur_count), 0.05);
  EXPECT_GT(blur_pull, 0.75);
  EXPECT_LT(blur_pull, 1.3);
}

/// Corners that a person sees: well within the stop's image.
std::size_t seen_by_a_person(const Picture& picture, double f_number) {
  const CameraSpec& camera = picture.camera;
  const double stop = 0.5 * camera.array.sensor_distance * camera.lens.focal_length / f_number /
                      camera.focus.lens_distance / camera.sensor.pixel_pitch;
  const MicrolensLattice lattice(camera.array);
  std::size_t count = 0;
  for (const PatternImage& image : picture.truth) {
    const Vec2 c = lattice.centre(image.image.lens),
               out = Vec2{image.image.column, image.image.row} -
                     thin_projection(camera, {0, 0, 1e-9}, c);
    count += length(out) < 0.7 * stop ? 1 : 0;
  }
  return count;
}

// Boards in micro-images as soft as those of a stopped-down camera with three types.
TEST(BoardCorners, OfSoftMicroImages) {
  if (!in_full()) return;
  constexpr double kStop = 4.8;
  constexpr int kBoards = 29, kLeast = 27;
  std::mt19937_64 random(29);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int boards = 0;
  for (int number = 0; number < kBoards; ++number) {
    std::string board = board_of("checkerboard", 6, 5, uniform(random), 3);
    const auto put = [&](const std::string& from, const std::string& to) {
      board.replace(board.find(from), from.size(), to);
    };
    const auto angle = [&](double middle, double reach) {
      return fmt::format("\"{} deg\"", middle + reach * uniform(random));
    };
    put("313 mm", fmt::format("{} mm", 312 + 6 * uniform(random)));
    put("\"8 deg\"", angle(0, 20));
    put("\"-102 deg\"", angle(-90, 20));
    put("\"10 deg\"", angle(0, 30));
    const Picture picture = with_noise(clean_picture(board, kThreeTypes, kStop, 16), 4000);
    const std::size_t seen = seen_by_a_person(picture, kStop);
    EXPECT_GT(seen, 20u) << number;
    std::size_t found = 0;
    std::string reason;
    try {
      found = find_board(picture.light, picture.camera, {false, 5, 4, 3e-3}).corners.size();
    } catch (const InputError& error) {
      reason = error.what();
    }
    std::printf("board %2d: %3zu corners of %3zu that a person sees %s\n", number, found, seen,
                reason.c_str());
    boards += 2 * found >= seen ? 1 : 0;
  }
  std::printf("f/%g: %d of %d boards found\n", kStop, boards, kBoards);
  EXPECT_GE(boards, kLeast);
}

INSTANTIATE_TEST_SUITE_P(BoardCorners, CornerPlaces,
                         testing::ValuesIn(in_full() ? std::vector{2.9, 4.8, 8.0}
                                                     : std::vector{2.9, 8.0}));

}  // namespace
}  // namespace plenoflame::test::board_corners_test
