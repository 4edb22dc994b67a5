// Whole pictures of lenses with distortion: both estimators see the same, and nothing that is left
// out is seen.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/render/estimators_agree.h"
#include "core/render/stream_picture.h"
#include "support/approx.h"
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
  const CompiledScene compiled = compile(scene);
  RenderSettings settings;
  settings.samples = 64;
  settings.precision = Precision::double_precision;
  const RenderResult left_out = render(compiled, settings);
  settings.skip = false;
  const RenderResult all = render(compiled, settings);
  EXPECT_GT(left_out.statistics.flux, 0);
  EXPECT_LT(left_out.statistics.rays, all.statistics.rays);
  const auto& few = left_out.light_field.channels[0].flux.pixels;
  const auto& every = all.light_field.channels[0].flux.pixels;
  const auto largest = static_cast<double>(*std::max_element(every.begin(), every.end()));
  for (std::size_t i = 0; i < every.size(); ++i)
    EXPECT_TRUE(within(static_cast<double>(few[i]), static_cast<double>(every[i]), 1e-6, largest))
        << i;
}

TEST_P(LensesWithDistortion, TheStreamOfRaysMakesThePicture) {
  const CompiledScene scene = compile(scene_with(GetParam()));
  RenderSettings settings;
  settings.samples = 32;
  settings.window = {0, 0, 60, 60};
  const RenderResult picture = render(scene, settings);
  const StreamPicture<double> stream(scene, settings, {}, RayStreamContent::radiance);
  double apart = 0;
  for (std::size_t i = 0; i < stream.flux(0).size(); ++i)
    apart += std::fabs(stream.flux(0)[i] -
                       static_cast<double>(picture.light_field.channels[0].flux.pixels[i]));
  EXPECT_GT(picture.statistics.flux, 0);
  EXPECT_LT(apart, 1e-5 * picture.statistics.flux);
}

INSTANTIATE_TEST_SUITE_P(Distortion, LensesWithDistortion, ::testing::Values(kBarrel, kCushion));

}  // namespace
}  // namespace plenoflame::test::distortion_test
