// Ground truth of scenes with solid surfaces, against quadratics of thin lenses.
#include <cmath>

#include "core/solids/surface_samples.h"
#include "plenoflame/media/layered_medium.h"
#include "plenoflame/render/ground_truth.h"
#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::surface_truth_test {
namespace {

using test::relative;
using test::within;

constexpr double kFocal = 0.1, kPixel = 10e-6, kDistance = 0.8;
constexpr double kFlame = 0.02, kSolid = 0.008, kAbsorption = 30, kWall = 1.2;

/// A solid ball in the middle of a homogeneous spherical flame, and a wall far behind, before a
/// thin lens without array.
CompiledScene ball_in_flame() {
  CameraSpec camera;
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = kFocal;
  camera.lens.diameter = 0.02;
  camera.sensor = {200, 160, 5 * kPixel};
  camera.focus.object_distance = 1;
  camera.focus.conjugate = "sensor";
  RigidTransform place;
  place.translation = {kDistance, 0, 0};  // the camera looks along +x
  CompiledScene scene = test::scene_of(
      camera, make_layered_medium({{{0, 0, 0}, {kFlame, kFlame, kFlame}, 1500, kAbsorption}}, place,
                                  {source_function(ChannelSpec{})}));
  SolidSurfaceSpec wall, ball = test::shaped(SolidShape::sphere, kSolid);
  wall.shape = SolidShape::plane;
  wall.position = {kWall, 0, 0};
  wall.rotation = {0, -0.5 * std::acos(-1.0), 0};  // faces the camera
  ball.position = {kDistance, 0, 0};
  scene.surfaces = test::scene_of({wall, ball});
  return scene;
}

/// Distance along the axis at which the line (x, y) = z slope enters (or leaves) a sphere on the
/// axis; 0: it passes.
double meets(Vec2 slope, double radius, bool leaves) {
  const double a = 1 + dot(slope, slope);
  const double root = kDistance * kDistance - a * (kDistance * kDistance - radius * radius);
  if (root <= 0) return 0;
  return (kDistance + (leaves ? 1 : -1) * std::sqrt(root)) / a;
}

TEST(SurfaceTruth, RaysEndOnTheFirstSurface) {
  const CompiledScene scene = ball_in_flame();
  LightField field;
  field.window = {0, 0, 200, 160};
  add_ground_truth(scene, field, test::threads(2));
  ASSERT_EQ(field.layers.size(), 7U);
  const double distance = 1 / (1 / kFocal - 1 / 1.0);
  int on_ball = 0, on_wall = 0, beside = 0;
  for (int row = 3; row < 160; row += 11)
    for (int column = 2; column < 200; column += 7) {
      const Vec2 slope{-(100 - column - 0.5) * 5 * kPixel / distance,
                       -(80 - row - 0.5) * 5 * kPixel / distance};
      const auto value = [&](const char* layer) {
        return static_cast<double>(field.layers.at(layer).at(column, row));
      };
      const double ball = meets(slope, kSolid, false);
      const double enters = meets(slope, kFlame, false);
      const double surface = ball > 0 ? ball : kWall;
      EXPECT_EQ(value(truth::kSurface), ball > 0 ? 2 : 1) << column << ' ' << row;
      EXPECT_TRUE(relative(value(truth::kSurfaceDistance), surface, 1e-6)) << column << ' ' << row;
      on_ball += ball > 0;
      on_wall += ball == 0;
      if (enters == 0) {
        ++beside;
        EXPECT_EQ(value(truth::kOpticalDepth), 0);
        EXPECT_TRUE(relative(value(truth::kDistance), kWall, 1e-6));
        continue;
      }
      const double end = ball > 0 ? ball : meets(slope, kFlame, true);
      const double stretch = std::sqrt(1 + dot(slope, slope));
      EXPECT_TRUE(relative(value(truth::kFirstHit), enters, 1e-6));
      EXPECT_TRUE(relative(value(truth::kLastHit), end, 1e-6));
      const double depth = kAbsorption * (end - enters) * stretch;
      EXPECT_TRUE(relative(value(truth::kOpticalDepth), depth, 1e-5));
      // Mean distance of the light of a homogeneous stretch of optical depth t, seen from its
      // front: (1 - t exp(-t) / (1 - exp(-t))) / k.
      const double mean = (1 - depth * std::exp(-depth) / -std::expm1(-depth)) / kAbsorption;
      EXPECT_TRUE(within(value(truth::kDistance), enters + mean / stretch, 1e-4, kFlame));
    }
  EXPECT_GE(on_ball, 10);
  EXPECT_GE(on_wall, 10);
  EXPECT_GE(beside, 10);
}

}  // namespace
}  // namespace plenoflame::surface_truth_test
