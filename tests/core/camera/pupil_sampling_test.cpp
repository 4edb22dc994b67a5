#include "plenoflame/camera/pupil_sampling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/cameras.h"

namespace plenoflame::test {
namespace {

void expect_same_cuts(const PupilNode& a, const PupilNode& b) {
  for (int i = 0; i < 40; ++i) {
    const double angle = 0.7 * i, distance = a.outer_radius * i / 40;
    const Vec2 place{distance * std::cos(angle), distance * std::sin(angle)};
    const PixelCut p = a.cuts.of_square(place, 0.03 * a.outer_radius, {0.6, 0.8});
    const PixelCut q = b.cuts.of_square(place, 0.03 * a.outer_radius, {0.6, 0.8});
    ASSERT_EQ(p.dark, q.dark);
    ASSERT_EQ(p.open, q.open);
    if (p.dark || p.open) continue;
    ASSERT_EQ(p.middle, q.middle);
    ASSERT_EQ(p.value, q.value);
    ASSERT_EQ(p.slope, q.slope);
  }
}

TEST(PupilSampling, TablesAreTheSameForAnyNumberOfThreads) {
  // A wide field: it needs many nodes.
  const CameraSpec plain = preset_camera("raytrix-r29");
  CameraSpec tilted = plain;
  tilted.array.tilt = {0.004, -0.002};
  for (const CameraSpec& spec : {plain, tilted}) {
    const Camera camera(spec);
    const PupilSampling one(camera, one_thread());
    for (const int count : {2, 7}) {
      const PupilSampling many(camera, threads(count));
      ASSERT_EQ(many.tables().size(), 3u);
      for (std::size_t type = 0; type < 3; ++type) {
        const PupilTable &a = one.tables()[type], &b = many.tables()[type];
        ASSERT_EQ(a.nodes.size(), b.nodes.size());
        int lit = 0;
        for (std::size_t i = 0; i < a.nodes.size(); ++i) {
          const PupilNode &n = a.nodes[i], &m = b.nodes[i];
          ASSERT_EQ(n.dark(), m.dark());
          if (n.dark()) continue;
          ++lit;
          EXPECT_EQ(n.centre, m.centre);
          EXPECT_EQ(n.outer_radius, m.outer_radius);
          EXPECT_EQ(n.opened, m.opened);
          EXPECT_EQ(a.edges[i].size(), b.edges[i].size());
          expect_same_cuts(n, m);
        }
        EXPECT_GT(lit, 20);
      }
    }
  }
}

}  // namespace
}  // namespace plenoflame::test
