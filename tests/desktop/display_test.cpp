// The way from values to colours. References: closed forms, and the published ends of the colour
// maps.
#include "model/image_display.h"
#include "model/jobs/coarse_picture.h"
#include "model/schematic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "emission_span.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/scene_file.h"
#include "scenes.h"

#include "support/approx.h"

namespace plenoflame::desktop::test {
namespace {

using plenoflame::test::relative;

/// CIE lightness of an sRGB colour.
double lightness(Rgb c) {
  const auto linear = [](unsigned char v) {
    const double x = v / 255.0;
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
  };
  const double y = 0.2126 * linear(c.red) + 0.7152 * linear(c.green) + 0.0722 * linear(c.blue);
  return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
}

// 1000 places of equal absorption and one temperature each, in steps of 1 K: the sums of T^4 from
// the coldest on are those of the integral, (T^5 - 1000^5) / (2000^5 - 1000^5), to a step of 1 K.
// Places that are hotter and absorb nothing have no part.
TEST(EmissionSpan, LeavesOutWhatHardlyShines) {
  std::vector<float> temperature, absorption;
  for (int k = 0; k < 1000; ++k) {
    temperature.push_back(1000.5F + static_cast<float>(k));
    absorption.push_back(2);
  }
  temperature.push_back(3000);
  absorption.push_back(0);
  const auto with_share_below = [](double share) {
    return std::pow(std::pow(1000, 5) + share * (std::pow(2000, 5) - std::pow(1000, 5)), 0.2);
  };
  const auto [low, high] = emission_span(temperature, absorption);
  EXPECT_TRUE(relative(low, with_share_below(0.01), 2e-3));
  EXPECT_TRUE(relative(high, with_share_below(0.999), 2e-3));
  EXPECT_EQ(emission_span({temperature.data() + 1000, 1}, {absorption.data() + 1000, 1})[1], 0);
}

TEST(ColourMap, HasThePublishedEnds) {
  const auto is = [](Rgb c, int red, int green, int blue) {
    return c.red == red && c.green == green && c.blue == blue;
  };
  EXPECT_TRUE(is(colour(ColourMap::viridis, 0), 0x44, 0x01, 0x54));
  EXPECT_TRUE(is(colour(ColourMap::viridis, 1), 0xfd, 0xe7, 0x25));
  EXPECT_TRUE(is(colour(ColourMap::cividis, 0), 0x00, 0x22, 0x4e));
  EXPECT_TRUE(is(colour(ColourMap::cividis, 1), 0xfe, 0xe8, 0x38));
  EXPECT_TRUE(is(colour(ColourMap::inferno, 1), 0xfc, 0xff, 0xa4));
  EXPECT_TRUE(is(colour(ColourMap::grey, 2), 255, 255, 255));
}

TEST(ColourMap, LightnessRisesEvenly) {
  for (const ColourMap map : {ColourMap::viridis, ColourMap::cividis, ColourMap::inferno}) {
    const double whole = lightness(colour(map, 1)) - lightness(colour(map, 0));
    for (int i = 0; i < 16; ++i) {
      const double step = lightness(colour(map, (i + 1) / 16.0)) - lightness(colour(map, i / 16.0));
      EXPECT_GT(step, 0.5 * whole / 16) << i;
      EXPECT_LT(step, 1.6 * whole / 16) << i;
    }
  }
}

TEST(ToneTable, AgreesWithTheFormula) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-7, 0.5);
  for (const ToneScale scale : {ToneScale::linear, ToneScale::gamma, ToneScale::logarithmic}) {
    ToneSettings settings;
    settings.scale = scale;
    settings.white = 3e-9;
    const ToneTable table(settings);
    for (int i = 0; i < 20000; ++i) {
      const double share = std::pow(10.0, exponent(random)), value = settings.white * share;
      // The scales once more, from their definitions.
      double expected = std::min(share, 1.0);
      if (scale == ToneScale::gamma)
        expected =
            expected <= 0.0031308 ? 12.92 * expected : 1.055 * std::pow(expected, 1 / 2.4) - 0.055;
      if (scale == ToneScale::logarithmic) expected = std::max(0.0, 1 + std::log10(expected) / 3);
      const int grey = static_cast<int>(table(static_cast<float>(value)) & 0xff);
      // Half a step of rounding, and what 1/512 of the value makes of it.
      EXPECT_LE(std::fabs(grey - 255 * expected), 1.01) << share;
    }
    EXPECT_EQ(table(0.0F) & 0xffffffU, 0U);
    EXPECT_EQ(table(-1.0F) & 0xffffffU, 0U);
    EXPECT_EQ(table(std::numeric_limits<float>::quiet_NaN()) & 0xffffffU, 0U);
    EXPECT_EQ(table(1e20F) & 0xffffffU, 0xffffffU);
  }
}

TEST(ToneTable, MarksSaturatedPixels) {
  ToneSettings settings;
  settings.white = 1;
  settings.saturation = 2;
  const ToneTable table(settings);
  EXPECT_EQ(table(1.9F) & 0xffffffU, 0xffffffU);
  const std::uint32_t marked = table(2.1F);
  EXPECT_NE((marked >> 16) & 0xff, marked & 0xff);  // no grey
  EXPECT_EQ(table(1e9F), marked);
}

TEST(ToneTable, SignedValuesMeetInTheMiddle) {
  ToneSettings settings;
  settings.is_signed = true;
  settings.map = ColourMap::diverging;
  settings.white = 2;
  const ToneTable table(settings);
  EXPECT_EQ(table(0.0F) & 0xffffffU, 0xf5f5f5U);
  EXPECT_EQ(table(-2.0F) & 0xffffffU, 0x21509eU);
  EXPECT_EQ(table(2.0F) & 0xffffffU, 0x9e4214U);
}

TEST(ImagePyramid, EveryLevelHasTheMeanOfTheImage) {
  auto image = std::make_shared<Image>(512, 256);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0, 4);
  double sum = 0;
  for (float& pixel : image->pixels) {
    pixel = value(random);
    sum += static_cast<double>(pixel);
  }
  const double mean = sum / static_cast<double>(image->pixels.size());
  const ImagePyramid pyramid(image, {});
  ASSERT_EQ(pyramid.level_count(), 4U);
  for (std::size_t i = 0; i < pyramid.level_count(); ++i) {
    const Image& level = pyramid.level(i);
    EXPECT_EQ(level.width, 512 >> i);
    double total = 0;
    for (const float pixel : level.pixels) total += static_cast<double>(pixel);
    EXPECT_TRUE(relative(total / static_cast<double>(level.pixels.size()), mean, 1e-6));
  }
  EXPECT_EQ(pyramid.level_for(1), 0U);
  EXPECT_EQ(pyramid.level_for(0.51), 0U);
  EXPECT_EQ(pyramid.level_for(0.5), 1U);
  EXPECT_EQ(pyramid.level_for(0.2), 2U);
  EXPECT_EQ(pyramid.level_for(0.001), 3U);
}

TEST(ImagePyramid, OddSizesKeepTheirLastRowAndColumn) {
  auto image = std::make_shared<Image>(131, 67, 2.0F);
  image->at(130, 66) = 10;
  const ImagePyramid pyramid(image, {});
  ASSERT_EQ(pyramid.level_count(), 3U);
  EXPECT_EQ(pyramid.level(1).width, 66);
  EXPECT_EQ(pyramid.level(1).height, 34);
  EXPECT_EQ(pyramid.level(1).at(65, 33), 10.0F);
  EXPECT_EQ(pyramid.level(1).at(0, 0), 2.0F);
  EXPECT_EQ(pyramid.largest(), 10.0F);
}

TEST(Histogram, CountsEveryPixelOnce) {
  Image image(100, 100);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<float>(i % 10);
  const Histogram linear = histogram(image, 9, false);
  double sum = linear.below;
  for (const double count : linear.counts) sum += count;
  EXPECT_EQ(sum, 10000);
  EXPECT_EQ(linear.counts.front(), 1000);
  EXPECT_EQ(linear.counts.back(), 2000);  // 8, and 9 itself
  const Histogram logarithmic = histogram(image, 4, true, 1);
  EXPECT_EQ(logarithmic.below, 1000);  // zeros; 1 is above 0.9
  EXPECT_EQ(logarithmic.upper, 9);
}

TEST(LineProfile, FollowsTheLine) {
  Image image(40, 30);
  for (int row = 0; row < 30; ++row)
    for (int column = 0; column < 40; ++column)
      image.at(column, row) = static_cast<float>(column + 100 * row);
  const auto along = line_profile(image, 2.5, 3.5, 12.5, 3.5);
  ASSERT_EQ(along.size(), 11U);
  for (std::size_t i = 0; i < along.size(); ++i) EXPECT_EQ(along[i], 302 + static_cast<double>(i));
  const auto down = line_profile(image, 5.5, 27.5, 5.5, 32.5);
  ASSERT_EQ(down.size(), 6U);
  EXPECT_EQ(down[2], 2905);
  EXPECT_TRUE(std::isnan(down[3]));
}

TEST(CoarsePicture, HasTheSameBitsWhateverIsKept) {
  Scene scene = parse_scene(small_scene_text(), "small.toml").scene;
  SensorSpec& sensor = scene.camera.sensor;
  sensor.columns *= 2;  // of pixels that large ones can stand for
  sensor.rows *= 2;
  sensor.pixel_pitch *= 0.5;
  CoarseScene kept;
  PixelValues before;
  // The scene as it is, another place of the flame, another camera, the flame again.
  for (int step = 0; step < 4; ++step) {
    if (step % 2 == 1) scene.flames[0].position.z += 3e-3;
    if (step == 2) scene.camera.focus.object_distance *= 1.1;
    const CompiledScene compiled = compile(scene);
    const auto picture = coarse_picture(compiled, {}, kept);
    CoarseScene nothing;
    const auto fresh = coarse_picture(compiled, {}, nothing);
    ASSERT_TRUE(picture && fresh);
    EXPECT_EQ(picture->channels[0].flux.pixels, fresh->channels[0].flux.pixels) << step;
    EXPECT_NE(picture->channels[0].flux.pixels, before) << step;
    before = picture->channels[0].flux.pixels;
  }
}

TEST(Schematic, ShortensEmptyStretchesAlone) {
  // Parts at -0.42..-0.4, -0.02..0 and 0.9..1.1 m of an axis along y through (1, 2, 3).
  const Vec3 origin{1, 2, 3}, axis{0, 1, 0};
  const Schematic drawing(origin, axis, {{0.9, 1.1}, {-0.02, 0}, {-0.42, -0.4}}, 0.1);
  ASSERT_EQ(drawing.gaps().size(), 2U);
  const auto y = [&](double along) { return drawing.place({5, 2 + along, 7}).y - 2; };
  // To rounding, of lengths of some metres.
  const auto is = [](double actual, double expected) {
    return std::fabs(actual - expected) <= 1e-14 * (4 + std::fabs(expected));
  };
  EXPECT_TRUE(is(y(0), 0));
  EXPECT_TRUE(is(y(-0.02), -0.02));
  EXPECT_TRUE(is(y(0.9), 0.1));
  EXPECT_TRUE(is(y(1.1), 0.3));
  EXPECT_TRUE(is(y(2.1), 1.3));
  EXPECT_TRUE(is(y(0.45), 0.05));
  EXPECT_TRUE(is(y(-0.4), -0.12));
  EXPECT_TRUE(is(y(-0.42), -0.14));
  EXPECT_TRUE(is(y(-0.21), -0.07));
  EXPECT_EQ(drawing.place({5, 3, 7}).x, 5);
  // A line bends where gaps begin and end, at the places that it has there.
  const auto line = drawing.line({0, 3, 0}, {0.7, 1.6, 0});
  ASSERT_EQ(line.size(), 4U);
  EXPECT_TRUE(is(line[0].x, 0.05));  // at 0.9
  EXPECT_TRUE(is(line[1].x, 0.5));   // at 0
  EXPECT_TRUE(is(line[1].y, 2));
  EXPECT_TRUE(is(line[3].x, 0.7));
  EXPECT_TRUE(Schematic(origin, axis, {{0.05, 0.1}}, 0.1).is_to_scale());
  EXPECT_TRUE(Schematic().is_to_scale());
}

CameraOnAxis camera_at(Vec3 position, Vec3 axis) {
  CameraOnAxis camera;
  camera.position = position;
  camera.axis = axis;
  camera.lens_back = -0.01;
  camera.array_front = -0.1;
  camera.sensor = -0.102;
  camera.width = 0.05;
  return camera;
}

ThingSeen box_at(Vec3 lower, Vec3 upper, bool flat = false) {
  ThingSeen thing;
  for (const double x : {lower.x, upper.x})
    for (const double y : {lower.y, upper.y})
      for (const double z : {lower.z, upper.z}) thing.corners.push_back({x, y, z});
  thing.flat = flat;
  return thing;
}

TEST(Schematic, SingleCameraStaysAndThingsKeepTheirShape) {
  const CameraOnAxis camera = camera_at({0, 0, 0}, {1, 0, 0});
  const ThingSeen flame = box_at({1, -0.02, -0.02}, {1.04, 0.02, 0.02});
  const ThingSeen ball = box_at({3, -0.05, -0.05}, {3.1, 0.05, 0.05});
  const ThingSeen floor = box_at({-1, -1, -0.1}, {4, 1, -0.1}, true);
  const ThingSeen wall = box_at({5, -2, -2}, {5, 2, 2}, true);
  const auto drawn = shortened_axes({camera}, {flame, ball, floor, wall}).front();
  EXPECT_EQ(drawn.gaps().size(), 3U);  // to the flame, to the ball, to the wall
  const auto x = [&](double along) { return drawn.place({along, 0, 0}).x; };
  EXPECT_EQ(x(0), 0);
  EXPECT_LT(x(1), 0.4);
  EXPECT_DOUBLE_EQ(x(1.04), x(1) + 0.04);
  EXPECT_DOUBLE_EQ(x(3.1), x(3) + 0.1);
  EXPECT_GT(x(3), x(1.04));
  EXPECT_GT(x(5), x(3.1));
  // A thing beside or behind the camera: to scale. One that runs along the axis holds it open.
  EXPECT_TRUE(shortened_axes({camera}, {box_at({-0.1, 0, 0}, {1, 1, 1})}).front().is_to_scale());
  EXPECT_LT(shortened_axes({camera}, {box_at({0.05, 0, 0}, {4, 0.1, 0.1})}).front().gaps().size(),
            2U);
}

TEST(Schematic, SeveralCamerasComeNearerAndHaveRoom) {
  const ThingSeen flame = box_at({-0.02, -0.02, -0.03}, {0.02, 0.02, 0.03});
  for (const int count : {2, 3, 6, 24}) {
    std::vector<CameraOnAxis> cameras;
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count;
      const Vec3 out{std::cos(angle), std::sin(angle), 0};
      cameras.push_back(camera_at(2.0 * out, -out));
    }
    const auto drawings = shortened_axes(cameras, {flame});
    ASSERT_EQ(drawings.size(), cameras.size());
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      for (const Vec3& corner : flame.corners)
        EXPECT_LT(length(drawings[i].place(corner) - corner), 1e-14);
      const Vec3 place = drawings[i].place(cameras[i].position);
      EXPECT_LT(length(place), count < 24 ? 0.5 : 1.9) << count;
      EXPECT_LT(length(place - length(place) * -cameras[i].axis), 1e-14);
      for (std::size_t k = 0; k < i; ++k)
        EXPECT_GT(length(place - drawings[k].place(cameras[k].position)), 0.05) << count;
    }
  }
  // Two side by side, which could not both come nearer along one line, stay apart.
  const std::vector<CameraOnAxis> pair{camera_at({2, 0.03, 0}, {-1, 0, 0}),
                                       camera_at({2, -0.03, 0}, {-1, 0, 0})};
  const auto drawings = shortened_axes(pair, {flame});
  EXPECT_GT(length(drawings[0].place(pair[0].position) - drawings[1].place(pair[1].position)),
            0.05);
  // One sees the flame, the other has it behind its back.
  const auto mixed =
      shortened_axes({camera_at({2, 0, 0}, {-1, 0, 0}), camera_at({0, 2, 0}, {0, 1, 0})}, {flame});
  EXPECT_FALSE(mixed[0].is_to_scale());
  EXPECT_TRUE(mixed[1].is_to_scale());
  for (const Schematic& drawing : shortened_axes(pair, {})) EXPECT_TRUE(drawing.is_to_scale());
}

}  // namespace
}  // namespace plenoflame::desktop::test
