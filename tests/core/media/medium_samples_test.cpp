#include "plenoflame/media/medium_samples.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/media/layered_medium.h"
#include "support/approx.h"

namespace plenoflame::medium_samples_test {
namespace {

using test::relative;

/// An ellipsoid of 1500 K with semi-axes of 20, 10 and 5 mm.
std::unique_ptr<Medium> ellipsoid() {
  return make_layered_medium({{{0, 0, 0}, {0.02, 0.01, 0.005}, 1500, 30}},
                             RigidTransform{{}, {1, 2, 3}}, {SourceFunction::total()});
}

// Every point has the value that the ellipsoid's equation gives it, and lies where it should.
TEST(MediumSamples, AreTheValuesAtTheirPlaces) {
  const auto medium = ellipsoid();
  for (const SamplePlaces places : {SamplePlaces::nodes, SamplePlaces::middles}) {
    const MediumSamples samples = sample_medium(*medium, places, 40);
    const auto [nx, ny, nz] = samples.count;
    EXPECT_EQ(nx, 40);
    EXPECT_EQ(ny, places == SamplePlaces::nodes ? 21 : 20);
    ASSERT_EQ(samples.temperature.size(), static_cast<std::size_t>(nx * ny * nz));
    ASSERT_EQ(samples.absorption.size(), samples.temperature.size());
    std::size_t at = 0, inside = 0;
    for (int k = 0; k < nz; ++k)
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i, ++at) {
          const Vec3 p =
              samples.origin + Vec3{i * samples.step.x, j * samples.step.y, k * samples.step.z};
          const double x = (p.x - 1) / 0.02, y = (p.y - 2) / 0.01, z = (p.z - 3) / 0.005;
          const double square = x * x + y * y + z * z;
          if (std::fabs(square - 1) < 1e-6) continue;  // on the surface
          EXPECT_EQ(samples.absorption[at], square < 1 ? 30.0F : 0.0F) << i << ' ' << j << ' ' << k;
          if (square >= 1) continue;
          EXPECT_EQ(samples.temperature[at], 1500.0F);
          ++inside;
        }
    EXPECT_GT(inside, samples.temperature.size() / 3);
  }
}

TEST(MediumSamples, CoverTheBounds) {
  const auto medium = ellipsoid();
  const Box box = medium->bounds();
  const MediumSamples nodes = sample_medium(*medium, SamplePlaces::nodes, 41);
  const Vec3 end =
      nodes.origin + Vec3{(nodes.count[0] - 1) * nodes.step.x, (nodes.count[1] - 1) * nodes.step.y,
                          (nodes.count[2] - 1) * nodes.step.z};
  EXPECT_TRUE(relative(nodes.step.x, 1e-3, 1e-9));
  EXPECT_TRUE(relative(nodes.step.z, 1e-3, 1e-9));
  EXPECT_LE(nodes.origin.z, box.lower.z * (1 + 1e-12));
  EXPECT_GE(end.z, box.upper.z * (1 - 1e-12));
  const MediumSamples middles = sample_medium(*medium, SamplePlaces::middles, 40);
  EXPECT_EQ(middles.count, (std::array<int, 3>{40, 20, 10}));
  EXPECT_TRUE(relative(middles.origin.x, box.lower.x + 0.5e-3, 1e-9));
}

TEST(MediumSamples, RefuseOnePointAndStopWhenAsked) {
  const auto medium = ellipsoid();
  EXPECT_THROW(sample_medium(*medium, SamplePlaces::nodes, 1), InputError);
  std::stop_source stop;
  stop.request_stop();
  Execution execution;
  execution.stop = stop.get_token();
  EXPECT_THROW(sample_medium(*medium, SamplePlaces::nodes, 20, execution), Cancelled);
}

}  // namespace
}  // namespace plenoflame::medium_samples_test
