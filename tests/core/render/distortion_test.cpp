// Whole pictures of lenses with distortion: both estimators see the same, and nothing that is left
// out is seen.
#include <gtest/gtest.h>

#include <cmath>

#include "core/render/estimators_agree.h"
#include "core/render/left_out.h"
#include "core/render/stream_picture.h"
#include "support/small_scene.h"

namespace plenoflame::test::distortion_test {
namespace {

Scene scene_with(const DistortionSpec& distortion) {
  Scene scene = small_scene(singlet(), large_array(Lattice::square, LensModel::real));
  scene.camera.lens.distortion = distortion;
  return scene;
}

/// A degree off the axis k1 of some hundreds bends as lenses of a wide field do at their edge.
const DistortionSpec kBarrel{-200, 0, 0, 0, 0, 0.9}, kCushion{150, 2000, 0, 0.4, -0.6, 1.1};

class LensesWithDistortion : public ::testing::TestWithParam<DistortionSpec> {};

TEST_P(LensesWithDistortion, BothEstimatorsMakeOnePicture) {
  expect_estimators_agree(compile(scene_with(GetParam())));
}

TEST_P(LensesWithDistortion, ThePictureIsAnother) {
  RenderSettings settings;
  settings.samples = 16;
  const RenderResult bent = render(compile(scene_with(GetParam())), settings);
  const RenderResult straight = render(compile(scene_with({})), settings);
  double apart = 0;
  for (std::size_t i = 0; i < bent.light_field.channels[0].flux.pixels.size(); ++i)
    apart += std::fabs(static_cast<double>(bent.light_field.channels[0].flux.pixels[i]) -
                       static_cast<double>(straight.light_field.channels[0].flux.pixels[i]));
  EXPECT_GT(apart, 0.02 * straight.statistics.flux);
}

TEST_P(LensesWithDistortion, WhatIsLeftOutSeesNothing) {
  Scene scene = scene_with(GetParam());
  scene.flames[0].scale = 0.4;
  EXPECT_LT(expect_left_out_sees_nothing(compile(scene)), 1);
}

TEST_P(LensesWithDistortion, TheStreamOfRaysMakesThePicture) {
  expect_stream_makes_picture(compile(scene_with(GetParam())), {0, 0, 60, 60},
                              {RayStreamContent::radiance});
}

INSTANTIATE_TEST_SUITE_P(Distortion, LensesWithDistortion, ::testing::Values(kBarrel, kCushion));

}  // namespace
}  // namespace plenoflame::test::distortion_test
