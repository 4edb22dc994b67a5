#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "render/sampling/worth_levels.h"
#include "support/cameras.h"

namespace plenoflame::test::worth_levels_test {
namespace {

TEST(WorthLevels, PointsGoAsAPowerOfWhatIsWorthLittle) {
  EXPECT_EQ(WorthLevels::of(1), 0);
  EXPECT_EQ(WorthLevels::of(0.125), 0);
  for (int k = 1; k <= static_cast<int>(WorthLevels::kCount); ++k) {
    const double limit = 0.35 * std::pow(std::exp2(-k), 1.5);
    EXPECT_EQ(WorthLevels::of(1.001 * limit), k - 1);
    EXPECT_EQ(WorthLevels::of(0.999 * limit), k);
  }
  EXPECT_EQ(WorthLevels::of(0), static_cast<int>(WorthLevels::kCount));
}

// Rings are found in steps, from outside: they hold no less than the mean share of the open
// aperture asks for, and by no more than two of their 64 steps.
TEST(WorthLevels, RingsFollowTheMeanShareThatIsOpen) {
  for (const char* name : {"paper-plenoptic2", "raytrix-r29", "paper-previous-60x60"}) {
    const Camera camera(preset_camera(name));
    const PupilSampling pupils(camera, Execution{});
    const double half = 0.5 * camera.spec().sensor.pixel_pitch;
    for (const PupilTable& table : pupils.tables()) {
      const WorthLevels worths(table, half);
      for (const double share : {0.0, 0.37, 0.9}) {
        const double h = share * table.field_step * static_cast<double>(table.nodes.size() - 1);
        const PupilNode node = table.at(h);
        ASSERT_FALSE(node.dark());
        const WorthLevels::Rings rings = worths.at(h);
        const OpenShare open(node, half);
        const double outer = node.outer_radius + half, step = outer / 32;
        int most = 0;
        for (double d = 0; d < outer; d += outer / 200) {
          const int level = rings.at(d * d);
          EXPECT_GE(level, WorthLevels::of(open.mean(std::max(d - step, 0.0)))) << name << " " << d;
          EXPECT_LE(level, WorthLevels::of(open.mean(d + step))) << name << " " << d;
          most = std::max(most, level);
        }
        EXPECT_EQ(rings.at(0), WorthLevels::of(open.mean(0)));
        EXPECT_EQ(most, static_cast<int>(WorthLevels::kCount)) << name;
      }
    }
  }
}

}  // namespace
}  // namespace plenoflame::test::worth_levels_test
