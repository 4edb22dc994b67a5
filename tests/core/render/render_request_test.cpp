// Settings of a front end and of the scene. The numbers are those of the command's help.
#include "plenoflame/render/render_request.h"

#include <gtest/gtest.h>

namespace plenoflame::test::render_request_test {
namespace {

TEST(RenderRequest, AreTheScenesUnlessAskedOtherwise) {
  Scene scene;
  scene.render.samples = 48;
  scene.render.seed = 7;
  const RenderSettings plain = render_settings(scene);
  EXPECT_EQ(plain.estimator, Estimator::backward);
  EXPECT_EQ(plain.samples, 48);
  EXPECT_EQ(plain.seed, 7U);
  EXPECT_EQ(plain.replicates, RenderSettings{}.replicates);
  EXPECT_EQ(plain.target_error, 0);
  RenderRequest request;
  request.samples = 3;
  request.seed = 0;
  const RenderSettings asked = render_settings(scene, request);
  EXPECT_EQ(asked.samples, 3);
  EXPECT_EQ(asked.seed, 0U);
}

// A replicate needs a sample of its own.
TEST(RenderRequest, OneSampleHasOneReplicate) {
  RenderRequest request;
  request.samples = 1;
  EXPECT_EQ(render_settings({}, request).replicates, 1);
}

TEST(RenderRequest, ATargetIsNotLimitedByTheScenesSamples) {
  Scene scene;
  scene.render.samples = 4;
  RenderRequest request;
  request.target_error = 0.01;
  EXPECT_EQ(render_settings(scene, request).samples, kMostSamples);
  request.samples = 100;
  EXPECT_EQ(render_settings(scene, request).samples, 100);
  EXPECT_EQ(render_settings(scene, request).target_error, 0.01);
  request = {};
  request.time_limit = 5;
  EXPECT_EQ(render_settings(scene, request).samples, kMostSamples);
  EXPECT_EQ(render_settings(scene, request).time_limit, 5);
}

// Rays per pixel say nothing about the number of bundles.
TEST(RenderRequest, BundlesAreCountedByThemselves) {
  Scene scene;
  scene.render.samples = 4;
  RenderRequest forward;
  forward.estimator = Estimator::forward;
  EXPECT_EQ(render_settings(scene, forward).samples, 1000000);
  EXPECT_EQ(render_settings(scene, forward).replicates, kForwardReplicates);
  scene.render.estimator = Estimator::forward;
  EXPECT_EQ(render_settings(scene).samples, 4);
  EXPECT_EQ(render_settings(scene).replicates, 4);
  scene.render.samples = RenderSpec{}.samples;  // the default is not a number of bundles
  EXPECT_EQ(render_settings(scene).samples, 1000000);
  forward.target_error = 0.1;
  EXPECT_EQ(render_settings(scene, forward).samples, kMostBundles);
}

}  // namespace
}  // namespace plenoflame::test::render_request_test
