// Whole pictures through windows: both estimators, the ray stream, exported rays and ground truth
// see the same; what is wrong with a window is said with its place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/render/estimators_agree.h"
#include "core/render/left_out.h"
#include "core/render/stream_picture.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "plenoflame/camera/window_design.h"
#include "plenoflame/optics/glass.h"
#include "plenoflame/render/ground_truth.h"
#include "plenoflame/render/ray_paths.h"
#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::windows_test {
namespace {

constexpr double kRight = 0.5 * constants::pi;

/// Across the camera's axis, which is the world's x.
WindowSpec plate() {
  WindowSpec window;
  window.name = "plate";
  window.position = {0.5, 0, 0};
  window.rotation = {0, kRight, 0};
  window.thickness = 0.04;
  window.diameter = 0.3;
  window.index = 1.7;
  window.fresnel = true;
  return window;
}

WindowSpec tilted_wedge() {
  WindowSpec window = plate();
  window.shape = WindowShape::wedge;
  window.name = "wedge";
  window.rotation = {0, kRight - 0.3, 0.2};
  window.angle = 0.01;
  window.absorption = 5;
  return window;
}

/// Around the flame.
WindowSpec tube() {
  WindowSpec window;
  window.shape = WindowShape::tube;
  window.name = "tube";
  window.position = {1, 0, -0.03};
  window.radius = 0.012;
  window.thickness = 0.003;
  window.height = 0.06;
  window.index = 1.46;
  window.fresnel = true;
  return window;
}

/// Around the camera.
WindowSpec dome() {
  WindowSpec window;
  window.shape = WindowShape::dome;
  window.name = "dome";
  window.position = {0.05, 0, 0};
  window.rotation = {0, kRight, 0};
  window.radius = 0.25;
  window.thickness = 0.02;
  window.height = 0.25;
  window.index = 1.5;
  return window;
}

Scene scene_behind(const std::vector<WindowSpec>& windows) {
  Scene scene = small_scene(singlet(), large_array(Lattice::square, LensModel::real));
  scene.windows = windows;
  return scene;
}

class ThroughWindows : public ::testing::TestWithParam<std::vector<WindowSpec>> {};

TEST_P(ThroughWindows, BothEstimatorsMakeOnePicture) {
  expect_estimators_agree(compile(scene_behind(GetParam())));
}

// Microlenses that are left out, because what straight beams might see of the scene has
// been widened by what windows displace, would have seen nothing.
TEST_P(ThroughWindows, WhatIsLeftOutSeesNothing) {
  Scene scene = scene_behind(GetParam());
  scene.camera.array.pitch = scene.camera.array.diameter = 0.5e-3;
  for (MicrolensSpec& type : scene.camera.array.types) {
    type.radius_front *= 0.5;
    type.radius_back *= 0.5;
  }
  scene.camera.array.sensor_distance *= 0.5;
  scene.camera.sensor = {240, 240, 0.05e-3};
  scene.flames[0].scale = 0.4;
  const CompiledScene compiled = compile(scene);
  const double share = expect_left_out_sees_nothing(compiled);
  // Beams of microlenses are wide. Rays that a dome turns so much are hardly bounded.
  const bool bounded = GetParam().back().shape != WindowShape::dome;
  EXPECT_LE(share, bounded ? 0.7 : 1.0);
}

TEST_P(ThroughWindows, TheStreamOfRaysMakesThePicture) {
  expect_stream_makes_picture(compile(scene_behind(GetParam())), {20, 20, 20, 20},
                              {RayStreamContent::rays, RayStreamContent::radiance});
}

TEST_P(ThroughWindows, ExportedRaysObeySnellsLawAndMakeThePixel) {
  const CompiledScene scene = compile(scene_behind(GetParam()));
  RenderSettings settings;
  settings.samples = 64;
  RayPaths paths = empty_ray_paths(scene);
  add_pixel_rays(scene, settings, {{31, 28}}, {}, paths);
  settings.window = {31, 28, 1, 1};
  settings.precision = Precision::double_precision;
  const RenderResult picture = render(scene, settings);
  double flux = 0;
  int faces = 0;
  for (std::size_t r = 0; r < paths.rays.size(); ++r) {
    const RayPath& ray = paths.rays[r];
    flux += ray.weight * paths.radiance_of(r, 0);
    for (std::size_t i = ray.first + 1; i + 1 < ray.first + ray.count; ++i) {
      const RayVertex* v = paths.vertices.data() + i;
      if (v[0].surface != kWindowVertex) continue;
      ++faces;
      const Vec3 before = normalize(v[0].position - v[-1].position);
      const Vec3 behind = normalize(v[1].position - v[0].position);
      // n1 d1 - n2 d2 is along the normal: as long as the faces' cosines say.
      const Vec3 change = v[-1].index * before - v[0].index * behind;
      const Vec3 normal = normalize(change);
      EXPECT_TRUE(within(length(v[-1].index * cross(before, normal)),
                         length(v[0].index * cross(behind, normal)), 1e-9, 1));
      EXPECT_NE(v[-1].index, v[0].index);
    }
  }
  EXPECT_GT(faces, 15);
  EXPECT_TRUE(
      relative(flux, static_cast<double>(picture.light_field.channels[0].flux.pixels[0]), 1e-5));
}

INSTANTIATE_TEST_SUITE_P(Windows, ThroughWindows,
                         ::testing::Values(std::vector{plate()}, std::vector{tube()},
                                           std::vector{dome()},
                                           std::vector{tilted_wedge(), tube(), dome()}));

TEST(Windows, ThatDoNotRefractChangeNothing) {
  WindowSpec nothing = tube();
  nothing.index = 1;
  RenderSettings settings;
  settings.samples = 32;
  settings.skip = false;
  settings.control_variate = false;
  settings.precision = Precision::double_precision;
  const RenderResult without = render(compile(scene_behind({})), settings);
  const RenderResult with = render(compile(scene_behind({nothing})), settings);
  double sum = 0, apart = 0;
  for (std::size_t i = 0; i < without.light_field.channels[0].flux.pixels.size(); ++i) {
    const auto flux = static_cast<double>(without.light_field.channels[0].flux.pixels[i]);
    sum += flux;
    apart += std::fabs(static_cast<double>(with.light_field.channels[0].flux.pixels[i]) - flux);
  }
  EXPECT_GT(sum, 0);
  EXPECT_LT(apart, 1e-6 * sum);
}

// A plate across the axis keeps the same share of all light near the axis, whatever it displaces.
TEST(Windows, APlateKeepsItsShare) {
  WindowSpec window = plate();
  window.absorption = 10;
  RenderSettings settings;
  settings.samples = 512;
  const auto total = [&](const std::vector<WindowSpec>& windows) {
    const RenderResult result = render(compile(scene_behind(windows)), settings);
    double sum = 0;
    for (const float flux : result.light_field.channels[0].flux.pixels)
      sum += static_cast<double>(flux);
    return sum;
  };
  const double clear = std::exp(-10 * 0.04), r = std::pow(0.7 / 2.7, 2);
  const double expected = (1 - r) * (1 - r) * clear / (1 - r * r * clear * clear);
  // Within the aperture's few degrees, and but for the aperture that the shift makes seem larger.
  EXPECT_TRUE(relative(total({window}) / total({}), expected, 0.06));
  window.index = 1;
  EXPECT_TRUE(relative(total({window}) / total({}), clear, 0.01));
}

TEST(Windows, GroundTruthIsWhereThingsAre) {
  const Execution execution;
  const auto truth = [&](const std::vector<WindowSpec>& windows) {
    Scene scene = scene_behind(windows);
    scene.camera.array = {};
    scene.camera.sensor = {61, 61, 0.2e-3};
    scene.camera.focus.conjugate = "sensor";
    const CompiledScene compiled = compile(scene);
    RenderSettings settings;
    settings.samples = 8;
    LightField field = render(compiled, settings).light_field;
    add_ground_truth(compiled, field, execution);
    return field;
  };
  const LightField without = truth({}), with = truth({plate(), tube()});
  // The middle pixel's ray goes along the axis, which both windows leave alone.
  for (const char* layer : {truth::kFirstHit, truth::kLastHit, truth::kDistance,
                            truth::kOpticalDepth, truth::kTemperature}) {
    const auto expected = static_cast<double>(without.layers.at(layer).at(30, 30));
    ASSERT_GT(expected, 0) << layer;
    EXPECT_TRUE(relative(static_cast<double>(with.layers.at(layer).at(30, 30)), expected, 1e-5))
        << layer;
  }
  // Beside it the plate shows points nearer to the axis: the flame looks larger.
  int lit_without = 0, lit_with = 0;
  const LightField plate_alone = truth({plate()});
  for (int i = 0; i < 61; ++i) {
    lit_without += without.layers.at(truth::kOpticalDepth).at(30, i) > 0;
    lit_with += plate_alone.layers.at(truth::kOpticalDepth).at(30, i) > 0;
  }
  EXPECT_GE(lit_with, lit_without);
}

TEST(Windows, DesignTellsShiftAstigmatismAndLoss) {
  const Camera camera(scene_behind({}).camera);
  WindowSpec flat = plate();
  const WindowDesign of_plate = window_design(camera, WindowSet({flat}));
  EXPECT_TRUE(of_plate.crossed);
  EXPECT_TRUE(relative(of_plate.shift_x, 0.04 * (1 - 1 / 1.7), 1e-6));
  EXPECT_TRUE(relative(of_plate.shift_y, 0.04 * (1 - 1 / 1.7), 1e-6));
  EXPECT_TRUE(relative(of_plate.loss, 1 - 2 * 1.7 / (1.7 * 1.7 + 1), 1e-6));
  // A tube bends no ray of a point on its axis across it (camera x); along it its wall is a plate.
  const WindowDesign of_tube = window_design(camera, WindowSet({tube()}));
  EXPECT_TRUE(within(of_tube.shift_x, 0, 1e-9, 1));
  EXPECT_TRUE(relative(of_tube.shift_y, 0.003 * (1 - 1 / 1.46), 1e-6));
  EXPECT_TRUE(relative(of_tube.astigmatism(), 0.003 * (1 - 1 / 1.46), 1e-6));
  WindowSpec aside = plate();
  aside.position.y = 1;
  EXPECT_FALSE(window_design(camera, WindowSet({aside})).crossed);
}

TEST(Windows, OfGlassThatDispersesGiveEachWavelengthAWayOfItsOwn) {
  Scene scene = scene_behind({plate()});
  scene.windows[0].glass = "N-SF11";
  scene.channels = {{"red", ChannelKind::band, 700e-9, 10e-9},
                    {"blue", ChannelKind::band, 450e-9, 10e-9}};
  const CompiledScene compiled = compile(scene);
  ASSERT_EQ(compiled.paths().size(), 2U);
  EXPECT_TRUE(
      relative(compiled.paths()[0].windows->index(0), Glass("N-SF11").index(700e-9), 1e-12));
  EXPECT_TRUE(
      relative(compiled.paths()[1].windows->index(0), Glass("N-SF11").index(450e-9), 1e-12));
}

#ifdef PLENOFLAME_TEST_SURFACES
// A solid surface may stand before, behind and on a window, but not in its glass.
TEST(Windows, NoSurfaceReachesIntoTheGlass) {
  Scene scene = scene_behind({plate()});
  SolidSurfaceSpec ball;
  ball.name = "ball";
  ball.shape = SolidShape::sphere;
  ball.radius = 0.03;
  ball.material.kind = MaterialKind::black;
  const auto refused = [&](Vec3 position, double radius) {
    ball.position = position;
    ball.radius = radius;
    scene.surfaces = {ball};
    try {
      compile(scene);
      return false;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("window \"plate\" and surface \"ball\""),
                std::string::npos)
          << error.what();
      return true;
    }
  };
  EXPECT_FALSE(refused({0.46, 0, 0}, 0.03));
  EXPECT_TRUE(refused({0.46, 0, 0}, 0.045)) << "through the first face";
  EXPECT_TRUE(refused({0.58, 0.05, 0}, 0.045)) << "through the second face";
  EXPECT_TRUE(refused({0.52, 0.145, 0}, 0.01)) << "at the rim";
  EXPECT_TRUE(refused({0.52, 0, 0}, 0.4)) << "around it";
}
#endif

struct Fault {
  const char* name;
  std::vector<WindowSpec> windows;
  const char* key;
  const char* words;
};

void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.name;
}

template <class Change>
WindowSpec changed(WindowSpec window, Change change) {
  change(window);
  return window;
}

class BadWindow : public ::testing::TestWithParam<Fault> {};

TEST_P(BadWindow, IsRefusedAtItsKey) {
  PositionMap positions;
  for (std::size_t i = 0; i < GetParam().windows.size(); ++i)
    for (const char* key : {"position", "radius", "thickness", "height", "angle"})
      positions.set("windows[" + std::to_string(i) + "]." + key,
                    {"bad.toml", static_cast<int>(10 * i + 1), 1});
  try {
    compile(scene_behind(GetParam().windows), load_core_medium, {}, positions);
    ADD_FAILURE() << "nothing was wrong with " << GetParam().name;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().words), std::string::npos) << error.what();
    EXPECT_EQ(to_string(error.position()), to_string(positions.find(GetParam().key)));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Faults, BadWindow,
    ::testing::Values(Fault{"wall",
                            {changed(tube(), [](WindowSpec& w) { w.thickness = 0.02; })},
                            "windows[0].radius",
                            "must be above the thickness"},
                      Fault{"high dome",
                            {changed(dome(), [](WindowSpec& w) { w.height = 0.6; })},
                            "windows[0].height",
                            "more than twice its radius"},
                      Fault{"sharp wedge",
                            {changed(tilted_wedge(), [](WindowSpec& w) { w.angle = 0.5; })},
                            "windows[0].angle",
                            "thinner by"},
                      Fault{"two in one place",
                            {plate(),
                             changed(tilted_wedge(), [](WindowSpec& w) { w.position.x = 0.52; })},
                            "windows[1].position",
                            "reach into each other"},
                      Fault{"of one name",
                            {changed(plate(), [](WindowSpec& w) { w.name = "a"; }),
                             changed(tilted_wedge(), [](WindowSpec& w) { w.name = "a"; })},
                            "windows[1].name",
                            "windows 0 and 1 are both named \"a\""},
                      Fault{"in the lens",
                            {changed(plate(), [](WindowSpec& w) { w.position.x = -0.03; })},
                            "windows[0].position",
                            "reaches into the camera's main lens"},
                      Fault{"in the camera",
                            {changed(plate(), [](WindowSpec& w) { w.position.x = -0.12; })},
                            "windows[0].position",
                            "reaches into the camera, behind its main lens"},
                      Fault{"in the flame",
                            {changed(tube(), [](WindowSpec& w) { w.radius = 0.007; })},
                            "windows[0].position",
                            "stands in flame \"small\""}));

}  // namespace
}  // namespace plenoflame::test::windows_test
