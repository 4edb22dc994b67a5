#include "render/transport/emission_proposal.h"

#include <gtest/gtest.h>

#include "plenoflame/base/constants.h"
#include "plenoflame/media/layered_medium.h"
#include "plenoflame/sampling/philox.h"
#include "support/approx.h"

namespace plenoflame::test::emission_proposal_test {
namespace {

struct Estimate {
  double mean = 0, error = 0;
};

/// Emission of the medium's channel 0, integrated over its volume by drawing points.
Estimate emitted(const Medium& medium, int count) {
  const EmissionProposal proposal(medium, 5, {});
  double sum = 0, squares = 0;
  std::vector<double> emission(static_cast<std::size_t>(medium.channel_count()));
  for (int i = 0; i < count; ++i) {
    const auto a = philox(1, static_cast<std::uint64_t>(i), 0),
               b = philox(1, static_cast<std::uint64_t>(i), 1);
    const auto point = proposal.draw(unit_uniform(a[0], a[1]), unit_uniform(b[0]),
                                     unit_uniform(b[1]), unit_uniform(b[2]));
    EXPECT_GT(point.density, 0);
    medium.coefficients(point.position, emission.data());
    sum += emission[0] / point.density;
    squares += emission[0] / point.density * (emission[0] / point.density);
  }
  const double mean = sum / count;
  return {mean, std::sqrt((squares / count - mean * mean) / count)};
}

// Volume of an ellipsoid times kappa sigma T^4 / pi.
TEST(EmissionProposal, EllipsoidsAddUpToTheirVolumes) {
  const double per_volume = constants::stefan_boltzmann * std::pow(1500.0, 4) / constants::pi;
  const auto volume = [](Vec3 a) { return 4.0 / 3 * constants::pi * a.x * a.y * a.z; };
  const Vec3 big{0.02, 0.03, 0.05}, small{0.002, 0.003, 0.004};
  // A bright speck inside of a dim body: nine hundredths of the light from a 1250th of the volume.
  const auto medium =
      make_layered_medium({{{0.005, 0, 0.01}, small, 1500, 120}, {{0, 0, 0}, big, 1500, 1}},
                          {rotation_xyz({0.3, 0.2, -0.4}), {1, 2, 3}}, {SourceFunction::total()});
  const Estimate estimate = emitted(*medium, 200000);
  const double expected = per_volume * (120 * volume(small) + volume(big) - volume(small));
  EXPECT_TRUE(within_standard_errors(estimate.mean, expected, estimate.error, 4));
  // Weights that vary little: no more scatter than this costs 200000 draws.
  EXPECT_LT(estimate.error, 2e-3 * expected);
}

// 1 / density has the volume of all places that can be drawn as its mean: the whole of the bounds,
// the dark corners as well.
TEST(EmissionProposal, EveryPlaceCanBeDrawn) {
  const auto medium = make_layered_medium(
      {{{0.03, 0, 0}, {0.005, 0.005, 0.005}, 2000, 50}, {{0, 0, 0}, {0.05, 0.04, 0.03}, 300, 1}},
      {}, {SourceFunction::total()});
  const EmissionProposal proposal(*medium, 5, {});
  double sum = 0, squares = 0;
  const int count = 400000;
  for (int i = 0; i < count; ++i) {
    const auto a = philox(2, static_cast<std::uint64_t>(i), 0),
               b = philox(2, static_cast<std::uint64_t>(i), 1);
    const double volume = 1 / proposal
                                  .draw(unit_uniform(a[0], a[1]), unit_uniform(b[0]),
                                        unit_uniform(b[1]), unit_uniform(b[2]))
                                  .density;
    sum += volume;
    squares += volume * volume;
  }
  const double mean = sum / count, error = std::sqrt((squares / count - mean * mean) / count);
  const Vec3 size = medium->bounds().upper - medium->bounds().lower;
  EXPECT_LT(error, 0.03 * mean);
  EXPECT_TRUE(within_standard_errors(mean, size.x * size.y * size.z, error, 4));
}

TEST(EmissionProposal, ColdMediumIsDark) {
  const auto medium =
      make_layered_medium({{{0, 0, 0}, {1, 1, 1}, 0, 1}}, {}, {SourceFunction::total()});
  EXPECT_TRUE(EmissionProposal(*medium, 1, {}).dark());
}

}  // namespace
}  // namespace plenoflame::test::emission_proposal_test
