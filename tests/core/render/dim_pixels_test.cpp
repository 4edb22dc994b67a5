// Pixels of so little worth that they get one or two points of each randomisation: right in the
// mean, with standard errors that know about it.
#include "core/render/dim_pixels.h"

#include "support/flame_scenes.h"

namespace plenoflame::test::dim_pixels_test {
namespace {

TEST(DimPixels, AreRightInTheMeanAndKnowTheirErrors) {
  expect_dim_pixels_right(compile(paper_flame(64, 64, 0.001)), {2, 8, 600, 1 << 13});
}

// Every ray has walks of its own, numbered by the points that are there.
TEST(DimPixels, OfASceneThatScatters) {
  Scene scene = paper_flame(48, 48, 0.001);
  scene.flames[0].scattering = {0.6, PhaseFunction::henyey_greenstein, 0.5};
  expect_dim_pixels_right(compile(scene), {2, 8, 150, 1 << 11});
}

}  // namespace
}  // namespace plenoflame::test::dim_pixels_test
