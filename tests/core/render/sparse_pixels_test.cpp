// Pixels of so little worth that chance decides whether they are sampled: right in the mean, with
// standard errors that know about it.
#include "core/render/sparse_pixels.h"

#include "support/flame_scenes.h"

namespace plenoflame::test {
namespace {

TEST(SparsePixels, AreRightInTheMeanAndKnowTheirErrors) {
  expect_dim_pixels_right(compile(paper_flame(64, 64, 0.001)), {2, 8, 600, 1 << 13});
}

// Chance takes two bits for each of them from words of 64.
TEST(SparsePixels, WithMoreRandomisationsThanAWordHasBitsFor) {
  expect_dim_pixels_right(compile(paper_flame(48, 48, 0.001)), {48, 4 * 48, 60, 1 << 14});
}

// Every ray has walks of its own, numbered by the points that are there.
TEST(SparsePixels, OfASceneThatScatters) {
  Scene scene = paper_flame(48, 48, 0.001);
  scene.flames[0].scattering = {0.6, PhaseFunction::henyey_greenstein, 0.5};
  expect_dim_pixels_right(compile(scene), {2, 8, 150, 1 << 11});
}

}  // namespace
}  // namespace plenoflame::test
