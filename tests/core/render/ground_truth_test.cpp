#include "plenoflame/render/ground_truth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plenoflame/media/layered_medium.h"
#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::ground_truth_test {
namespace {

using test::relative;
using test::within;

constexpr double kFocal = 0.1, kGap = 1e-3, kPitch = 200e-6, kPixel = 10e-6;
constexpr double kAbsorption = 40, kRadius = 0.02, kDistance = 0.8;

/// Thin ideal lenses; a homogeneous sphere on the axis.
CompiledScene sphere_scene(bool array) {
  CameraSpec camera;
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = kFocal;
  camera.lens.diameter = 0.02;
  camera.sensor = {120, 100, kPixel};
  camera.focus.object_distance = 1;
  camera.focus.conjugate = array ? "array" : "sensor";
  if (array) {
    camera.array.present = true;
    camera.array.lattice = Lattice::hexagonal;
    camera.array.model = LensModel::ideal;
    camera.array.pitch = camera.array.diameter = kPitch;
    MicrolensSpec lens;
    lens.name = "type1";
    lens.focal_length = kGap;
    camera.array.types = {lens};
    camera.array.sensor_distance = kGap;
  }
  RigidTransform place;
  place.translation = {kDistance, 0, 0};  // the camera looks along +x
  return test::scene_of(
      camera, make_layered_medium({{{0, 0, 0}, {kRadius, kRadius, kRadius}, 1500, kAbsorption}},
                                  place, {source_function(ChannelSpec{})}));
}

struct Chord {
  double first = 0, last = 0, mean = 0, depth = 0;  ///< distances along the axis
};

/// The chord of the line (x, y) = position + z slope through the sphere: a quadratic; the mean
/// distance of the light of a homogeneous body, 1/k - L exp(-k L) / (1 - exp(-k L)) from where it
/// is entered.
Chord chord(Vec2 position, Vec2 slope) {
  const double a = 1 + dot(slope, slope);
  const double b = dot(position, slope) - kDistance;
  const double c = dot(position, position) + kDistance * kDistance - kRadius * kRadius;
  const double root = b * b - a * c;
  if (root <= 0) return {};
  Chord result;
  result.first = (-b - std::sqrt(root)) / a;
  result.last = (-b + std::sqrt(root)) / a;
  const double length = (result.last - result.first) * std::sqrt(a);
  result.depth = kAbsorption * length;
  const double inside = 1 / kAbsorption + length / -std::expm1(result.depth);
  result.mean = result.first + inside / std::sqrt(a);
  return result;
}

void check(const LightField& field, int column, int row, const Chord& expected) {
  const auto value = [&](const char* layer) {
    return static_cast<double>(field.layers.at(layer).at(column, row));
  };
  EXPECT_TRUE(relative(value(truth::kOpticalDepth), expected.depth, 1e-5)) << column << ' ' << row;
  EXPECT_TRUE(relative(value(truth::kFirstHit), expected.first, 1e-6)) << column << ' ' << row;
  EXPECT_TRUE(relative(value(truth::kLastHit), expected.last, 1e-6)) << column << ' ' << row;
  EXPECT_TRUE(relative(value(truth::kTemperature), expected.depth > 0 ? 1500 : 0, 1e-6));
  // To 1e-4 of the sphere, not of its distance.
  EXPECT_TRUE(within(value(truth::kDistance), expected.mean, 1e-4, kRadius))
      << column << ' ' << row;
}

// The ray through the middles of pixel and microlens goes on through the image of the microlens, 1
// m in front of the lens.
TEST(GroundTruth, BehindMicrolenses) {
  const CompiledScene scene = sphere_scene(true);
  const double distance = 1 / (1 / kFocal - 1 / 1.0);
  LightField field;
  field.window = {20, 5, 90, 95};
  Execution execution = test::threads(2);
  double told = 0;
  int times = 0;
  execution.progress = [&](const Progress& progress) {
    EXPECT_GT(progress.fraction, told);
    told = progress.fraction;
    ++times;
  };
  add_ground_truth(scene, field, execution);
  EXPECT_EQ(told, 1);
  EXPECT_EQ(times, 95);  // every row
  int lit = 0;
  for (const LensIndex lens :
       {LensIndex{0, 0}, LensIndex{1, 0}, LensIndex{-1, 1}, LensIndex{1, -2}}) {
    const Vec2 centre{kPitch * (lens.q + 0.5 * lens.r), kPitch * std::sqrt(0.75) * lens.r};
    for (const Vec2 offset : {Vec2{0, 0}, Vec2{50e-6, 20e-6}, Vec2{-30e-6, -60e-6}}) {
      const Vec2 at = (1 + kGap / distance) * centre + offset;
      const int column = static_cast<int>(std::floor(60 - at.x / kPixel));
      const int row = static_cast<int>(std::floor(50 - at.y / kPixel));
      const Vec2 s{(60 - column - 0.5) * kPixel, (50 - row - 0.5) * kPixel};
      const Vec2 stop = centre + distance / kGap * (centre - s);
      const Vec2 image = -1 / distance * centre;  // at 1 m
      const Chord expected = chord(stop, image - stop);
      lit += expected.depth > 0 ? 1 : 0;
      check(field, column - 20, row - 5, expected);
    }
  }
  EXPECT_GE(lit, 10);
}

TEST(GroundTruth, WithoutArray) {
  const CompiledScene scene = sphere_scene(false);
  const double distance = 1 / (1 / kFocal - 1 / 1.0);
  LightField field;
  field.window = {0, 0, 120, 100};
  add_ground_truth(scene, field, test::one_thread());
  for (const int column : {0, 37, 60, 119})
    for (const int row : {0, 50, 99}) {
      // Through the middle of the lens, straight on.
      const Vec2 s{(60 - column - 0.5) * kPixel, (50 - row - 0.5) * kPixel};
      check(field, column, row, chord({0, 0}, -1 / distance * s));
    }
}

TEST(GroundTruth, NothingIsZero) {
  CompiledScene scene = sphere_scene(true);
  scene.medium = nullptr;
  LightField field;
  field.window = {0, 0, 8, 8};
  add_ground_truth(scene, field);
  ASSERT_EQ(field.layers.size(), 5U);
  for (const auto& [name, image] : field.layers)
    for (const float value : image.pixels) EXPECT_EQ(value, 0.0F) << name;
}

}  // namespace
}  // namespace plenoflame::ground_truth_test
