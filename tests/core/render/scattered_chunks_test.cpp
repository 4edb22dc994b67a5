// The memory of one chunk of bundles while smoke scatters them to the camera from many places.
#include <gtest/gtest.h>

#include <stop_token>

#include "plenoflame/film/film.h"
#include "render/forward/forward_surfaces.h"
#include "support/small_scene.h"

namespace plenoflame::test::scattered_chunks_test {
namespace {

/// Smoke so thick that light is scattered a dozen times before it leaves, in three colours.
Scene thick_smoke(bool grey) {
  Scene scene = small_scene(singlet(), large_array(Lattice::square, LensModel::real));
  FlameSpec& smoke = scene.flames[0];
  smoke.layers = {{"smoke", {0, 0, 0.01}, {0.01, 0.01, 0.01}, 1500, 20}};
  smoke.scattering.albedo = 0.97;
  if (!grey) smoke.spectrum.kind = SpectrumKind::power;
  scene.channels = {{"red", ChannelKind::band, 650e-9, 10e-9},
                    {"green", ChannelKind::band, 550e-9, 10e-9},
                    {"blue", ChannelKind::band, 450e-9, 10e-9}};
  return scene;
}

ForwardChunk traced(const CompiledScene& scene, std::size_t most_waiting,
                    const std::stop_token& stop = {}) {
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  const SensorSpec& sensor = scene.camera.spec().sensor;
  const Film film({0, 0, sensor.columns, sensor.rows}, 3, settings.replicates);
  const EmissionProposal proposal(*scene.medium, 1, {});
  const SurfaceBundles bundles(scene, settings, film, &proposal, stop, most_waiting);
  ForwardChunk chunk;
  bundles.trace(0, 2000, chunk);
  return chunk;
}

// Adding arrivals more or less often changes no bit of them, only how many wait. Bundles still on
// their way keep their spectra when room is made.
TEST(ScatteredChunks, AreTheSameHoweverLittleWaits) {
  for (const bool grey : {true, false}) {
    const CompiledScene scene = compile(thick_smoke(grey));
    const ForwardChunk whole = traced(scene, SurfaceBundles::kMostWaiting);
    const ForwardChunk pieces = traced(scene, 300);
    EXPECT_TRUE(whole.done && pieces.done);
    EXPECT_GT(whole.work.rays_reached, 4000);
    EXPECT_EQ(whole.most_waiting, static_cast<std::size_t>(whole.work.rays_reached));
    // A step of all bundles adds one arrival of each at most.
    EXPECT_LT(pieces.most_waiting, 300 + 2000);
    EXPECT_EQ(whole.work.rays_reached, pieces.work.rays_reached);
    ASSERT_EQ(whole.deposits.size(), pieces.deposits.size());
    EXPECT_EQ(whole.flux, pieces.flux);
    for (std::size_t i = 0; i < whole.deposits.size(); ++i) {
      EXPECT_EQ(whole.deposits[i].column, pieces.deposits[i].column);
      EXPECT_EQ(whole.deposits[i].row, pieces.deposits[i].row);
      EXPECT_EQ(whole.deposits[i].replicate, pieces.deposits[i].replicate);
    }
  }
}

// A chunk may take minutes: who stops it does not wait for its end, and gets nothing of it.
TEST(ScatteredChunks, StopBetweenPlaces) {
  std::stop_source source;
  source.request_stop();
  const CompiledScene scene = compile(thick_smoke(true));
  const ForwardChunk chunk = traced(scene, SurfaceBundles::kMostWaiting, source.get_token());
  EXPECT_FALSE(chunk.done);
  EXPECT_EQ(chunk.work.medium.rays, 0);
}

}  // namespace
}  // namespace plenoflame::test::scattered_chunks_test
