// The flames as eyes see them. References: the adaptive integrator along single rays, the light of
// the medium, and the order of the colours of a black body.
#include <gtest/gtest.h>

#include <cmath>

#include "model/eye_view.h"
#include "model/flame_look.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/scene_file.h"
#include "support/approx.h"

using namespace plenoflame;
using namespace plenoflame::desktop;

namespace {

/// A flame of two layers one metre before the camera, with the channels X, Y, Z.
Scene layered(const std::string& more = {}) {
  return parse_scene(
             "[camera]\npreset = \"paper-previous-60x60\"\n\n"
             "[[channels]]\nname = \"X\"\nkind = \"named\"\nresponse = \"cie_x\"\n"
             "[[channels]]\nname = \"Y\"\nkind = \"named\"\nresponse = \"cie_y\"\n"
             "[[channels]]\nname = \"Z\"\nkind = \"named\"\nresponse = \"cie_z\"\n"
             "[[flames]]\npreset = \"paper-layered\"\nposition = [\"1 m\", \"0 m\", \"-29 mm\"]\n" +
                 more,
             "")
      .scene;
}

/// One pixel through the middle of the flames, seen along y.
EyeWindow through_the_middle(const EyeFlame& flame) {
  const Box box = flame.box();
  const Vec3 middle = 0.5 * (box.lower + box.upper);
  EyeWindow window;
  window.eye = middle - Vec3{0, 0.5, 0};
  window.across = {1e-6, 0, 0};
  window.down = {0, 0, -1e-6};
  window.corner = middle - 0.5 * (window.across + window.down);
  window.width = window.height = 1;
  window.kept = {{-10, -10, -10}, {10, 10, 10}};
  return window;
}

Vec3 place_of(const EyeFlame& flame, std::size_t point) {
  const auto row = static_cast<std::size_t>(flame.count[0]),
             layer = row * static_cast<std::size_t>(flame.count[1]);
  return flame.origin + Vec3{static_cast<double>(point % row) * flame.step.x,
                             static_cast<double>(point % layer / row) * flame.step.y,
                             static_cast<double>(point / layer) * flame.step.z};
}

/// Emission of three channels, and absorption.
std::array<double, 4> light_at(const Medium& medium, Vec3 place) {
  std::array<double, 4> light{};
  light[3] = medium.coefficients(place, light.data());
  return light;
}

}  // namespace

TEST(EyeView, LightIsThatOfTheReferenceIntegrator) {
  const Scene scene = layered();
  const auto flame = eye_flame(scene, 160, {});
  ASSERT_TRUE(flame);
  const EyeWindow window = through_the_middle(*flame);
  const EyeLight::Pixel seen = eye_light(*flame, window, {}).pixels.front();
  const CompiledScene compiled = compile(scene);
  const std::vector<double> nodes =
      integrate_reference(*compiled.medium, {window.eye, {0, 1, 0}}, 0, 1, 1e-8);
  std::array<double, 3> expected{};
  for (std::size_t c = 0; c < 3; ++c)
    for (int n = 0; n < compiled.node_count(); ++n)
      expected[c] += (compiled.mix.empty() ? (static_cast<int>(c) == n ? 1.0 : 0.0)
                                           : compiled.mix.weight(static_cast<int>(c), n)) *
                     nodes[static_cast<std::size_t>(n)];
  // The layers' sharp edges lie between points of the lattice: within one of 40 points across.
  EXPECT_TRUE(test::relative(static_cast<double>(seen.x), expected[0], 0.05));
  EXPECT_TRUE(test::relative(static_cast<double>(seen.y), expected[1], 0.05));
  EXPECT_TRUE(test::relative(static_cast<double>(seen.z), expected[2], 0.05));
  EXPECT_TRUE(test::relative(-std::log(static_cast<double>(seen.passed)), nodes.back(), 0.3));
}

// The mean of eight places around a point, since layers end between points.
TEST(EyeView, PointsHaveTheMediumsLightAndMediaThatAreKnownGiveTheSame) {
  const Scene scene = layered("brightness = 3\n");
  const CompiledScene compiled = compile(scene);
  const auto flame = eye_flame(scene, 40, {}), same = eye_flame(scene, 40, {}, compiled.loaded);
  ASSERT_EQ(flame->points.size(), same->points.size());
  ASSERT_EQ(compiled.node_count(), 3);  // of the same channels
  std::size_t lit = 0;
  for (std::size_t i = 0; i < flame->points.size(); ++i) {
    std::array<double, 4> mean{};
    for (const double x : {-0.25, 0.25})
      for (const double y : {-0.25, 0.25})
        for (const double z : {-0.25, 0.25}) {
          const Vec3 aside{x * flame->step.x, y * flame->step.y, z * flame->step.z};
          const auto light = light_at(*compiled.medium, place_of(*flame, i) + aside);
          for (std::size_t n = 0; n < 4; ++n) mean[n] += light[n] / 8;
        }
    for (const EyeFlame::Point& p : {flame->points[i], same->points[i]}) {
      EXPECT_TRUE(test::relative(static_cast<double>(p.x), mean[0], 1e-3));
      EXPECT_TRUE(test::relative(static_cast<double>(p.y), mean[1], 1e-3));
      EXPECT_TRUE(test::relative(static_cast<double>(p.z), mean[2], 1e-3));
      EXPECT_TRUE(test::relative(static_cast<double>(p.absorption), mean[3], 1e-6));
    }
    lit += mean[3] > 0 ? 1 : 0;
  }
  EXPECT_GT(lit, 1000U);
}

// The upper end of a grid fades in light and absorption. A closed flame keeps both.
TEST(EyeView, GridsFadeAtTheirUpperEndAndLayersDoNot) {
  Scene scene = layered();
  const CompiledScene compiled = compile(scene);
  const auto closed = eye_flame(scene, 61, {}, compiled.loaded);
  scene.flames[0].kind = FlameKind::vdb;  // the same medium, as if it were of a grid
  const auto grid = eye_flame(scene, 61, {}, compiled.loaded);
  const auto [nx, ny, nz] = closed->count;
  int full = 0, fading = 0;
  for (int k = 1; k + 1 < nz; ++k) {
    const auto i = static_cast<std::size_t>((k * ny + ny / 2) * nx + nx / 2);
    const auto here = light_at(*compiled.medium, place_of(*grid, i));
    if (!(here[1] > 0)) continue;  // a pole
    const double height = (k - 1.0) / (nz - 3);
    const double light = static_cast<double>(grid->points[i].y) / here[1],
                 soot = static_cast<double>(grid->points[i].absorption) / here[3];
    if (height < 0.84) {
      EXPECT_TRUE(test::relative(light, 1, 1e-3));
      EXPECT_TRUE(test::relative(soot, 1, 1e-6));
      ++full;
    } else if (std::fabs(height - 0.92) < 0.02) {
      EXPECT_GT(light, 0.2);
      EXPECT_LT(light, 0.8);
      EXPECT_TRUE(test::relative(soot, light, 1e-3));
      EXPECT_TRUE(test::relative(static_cast<double>(closed->points[i].y), here[1], 0.05));
      EXPECT_TRUE(test::relative(static_cast<double>(closed->points[i].absorption), here[3], 0.05));
      ++fading;
    }
  }
  EXPECT_GT(full, 40);
  EXPECT_GE(fading, 2);
}

TEST(EyeView, WhatIsCutAwayGivesNoLight) {
  const auto flame = eye_flame(layered(), 60, {});
  EyeWindow window = through_the_middle(*flame);
  const Box box = flame->box();
  const float whole = eye_light(*flame, window, {}).pixels.front().y;
  window.kept.upper.y = 0.5 * (box.lower.y + box.upper.y);
  const float half = eye_light(*flame, window, {}).pixels.front().y;
  // The front half is weakened by nothing, so that it gives more than half of the light.
  EXPECT_GT(half, 0.49F * whole);
  EXPECT_LT(half, 0.95F * whole);
  window.kept.upper.y = box.lower.y - 1e-3;
  EXPECT_EQ(eye_light(*flame, window, {}).pixels.front().passed, 1);
}

TEST(EyeView, SootIsOrangeAndBrighterByEachStop) {
  const auto flame = eye_flame(layered(), 60, {});
  const EyeLight light = eye_light(*flame, through_the_middle(*flame), {});
  int before = -1;
  for (const double stops : {-4.0, -3.0, -2.0, -1.0, 0.0}) {
    const auto rgba = eye_picture(light, flame->bright, stops, 0);
    ASSERT_EQ(rgba.size(), 4U);
    EXPECT_GT(rgba[0], rgba[1]);
    EXPECT_GT(rgba[1], rgba[2]);
    const int shown = rgba[0] * rgba[3];  // over black
    EXPECT_GT(shown, before);
    before = shown;
  }
  EXPECT_GT(before, 200 * 255);
}

TEST(EyeView, TwiceTheBrightnessIsTwiceTheLight) {
  const auto once = eye_flame(layered(), 40, {}),
             twice = eye_flame(layered("brightness = 2\n"), 40, {});
  EXPECT_TRUE(test::relative(twice->bright, 2 * once->bright, 1e-5));
  EXPECT_FALSE(
      eye_flame(parse_scene("[camera]\npreset = \"paper-previous-60x60\"\n", "").scene, 40, {}));
}

TEST(EyeView, GlareSpreadsLightAndKeepsMostOfIt) {
  EyeLight light{41, 41, std::vector<EyeLight::Pixel>(41 * 41)};
  light.pixels[20 * 41 + 20] = {1, 1, 1, 0.5F};
  const auto sharp = eye_picture(light, 100, 0, 0), soft = eye_picture(light, 1, 0, 3);
  const auto alpha = [](const std::vector<std::uint8_t>& rgba, int x, int y) {
    return rgba[4 * static_cast<std::size_t>(41 * y + x) + 3];
  };
  EXPECT_EQ(alpha(sharp, 22, 20), 0);
  EXPECT_GT(alpha(soft, 22, 20), 0);
  EXPECT_GT(alpha(soft, 20, 20), alpha(soft, 22, 20));
  EXPECT_EQ(alpha(soft, 22, 20), alpha(soft, 18, 20));
  EXPECT_EQ(alpha(soft, 40, 40), 0);
}

TEST(FlameLook, ExposureIsKept) {
  FlameLook look;
  EXPECT_EQ(look.drawing, FlameDrawing::eye);
  look.exposure = -1.5;
  const auto read = look_from_text(look_to_text(look));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->exposure, -1.5);
}
