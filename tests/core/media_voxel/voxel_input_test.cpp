// The medium's statements about itself, its refusals, and skipping, which changes nothing.
#include <gtest/gtest.h>

#include <limits>

#include "plenoflame/base/error.h"
#include "voxel_fixture.h"

namespace plenoflame::test::voxel_input_test {
namespace {

VoxelField uniform_field(float value, float background, const AffineTransform& transform,
                         std::array<int, 3> high = {12, 12, 12}) {
  return make_field(
      {0, 0, 0}, high, [&](int, int, int) { return value; }, transform, background);
}

std::string message_of(const VoxelField& temperature, const VoxelField& absorption) {
  try {
    make_voxel_medium(temperature, absorption, VoxelInterpolation::trilinear,
                      {SourceFunction::total()});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(VoxelInput, Refusals) {
  const auto transform = scaled(1e-3);
  const VoxelField good_t = uniform_field(1500, 300, transform);
  VoxelField good_k = uniform_field(10, 0, transform);
  good_k.name = "absorption";
  EXPECT_EQ(message_of(good_t, good_k), "");

  VoxelField bad = good_k;
  bad.background = 1;
  EXPECT_NE(message_of(good_t, bad).find("background"), std::string::npos);
  for (const float value :
       {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    bad = good_k;
    // Brick 1 starts at (0, 0, 8) in this order; its value 0 2 3 is the sample (0, 2, 11).
    ASSERT_EQ(bad.brick_origins[1], (std::array<int, 3>{0, 0, 8}));
    bad.values[512 + 2 * 8 + 3] = value;
    EXPECT_NE(message_of(good_t, bad).find("'absorption'"), std::string::npos);
    EXPECT_NE(message_of(good_t, bad).find("(0, 2, 11)"), std::string::npos);
    EXPECT_NE(message_of(bad, good_k).find("(0, 2, 11)"), std::string::npos);
  }
  bad = good_k;
  bad.index_to_world.linear.rows[2] = bad.index_to_world.linear.rows[1];
  EXPECT_NE(message_of(good_t, bad).find("singular"), std::string::npos);
  bad = good_k;
  bad.brick_origins[1] = bad.brick_origins[0];
  EXPECT_NE(message_of(good_t, bad).find("twice"), std::string::npos);
  bad = good_k;
  bad.brick_origins[1][0] = 4;
  EXPECT_NE(message_of(good_t, bad).find("multiple of 8"), std::string::npos);
  bad = good_k;
  bad.values.pop_back();
  EXPECT_NE(message_of(good_t, bad).find("512"), std::string::npos);
  bad = good_k;
  bad.brick_origins[0] = {-8000000, -8000000, -8000000};
  EXPECT_NE(message_of(good_t, bad).find("stray"), std::string::npos);
  EXPECT_THROW(make_voxel_medium(good_t, good_k, VoxelInterpolation::trilinear, {}), InputError);
}

TEST(VoxelInput, NothingAbsorbs) {
  const auto medium =
      make_voxel_medium(uniform_field(1500, 300, scaled(1e-3)), uniform_field(0, 0, scaled(1e-3)),
                        VoxelInterpolation::trilinear, {SourceFunction::total()});
  EXPECT_TRUE(medium->bounds().empty());
  const Seen seen = see<float>(*medium, {{{0, 0, 0}, {1, 0, 0}}}, with(best_isa()));
  EXPECT_EQ(seen.radiance[0][0], 0);
  EXPECT_EQ(seen.transmittance[0], 1);
  EXPECT_EQ(medium->sample({1e-3, 1e-3, 1e-3}).absorption, 0);
}

TEST(VoxelInput, BoundsSampleAndSpacing) {
  const auto transform = scaled(2e-3, {1, 2, 3});
  const auto absorption = make_field(
      {3, 4, 5}, {9, 12, 7}, [](int i, int j, int k) { return float(i + j + k); }, transform);
  const auto t = uniform_field(1500, 300, transform);
  const auto smooth =
      make_voxel_medium(t, absorption, VoxelInterpolation::trilinear, {SourceFunction::total()});
  // Trilinear: the cells around the samples 3..8, 4..11, 5..6.
  EXPECT_TRUE(relative(smooth->bounds().lower.x, 1 + 2e-3 * 2, 1e-15));
  EXPECT_TRUE(relative(smooth->bounds().upper.x, 1 + 2e-3 * 9, 1e-15));
  EXPECT_TRUE(relative(smooth->bounds().upper.y, 2 + 2e-3 * 12, 1e-15));
  EXPECT_TRUE(relative(smooth->bounds().lower.z, 3 + 2e-3 * 4, 1e-15));
  EXPECT_TRUE(relative(smooth->feature_size(), 2e-3, 1e-12));
  const MediumSample at = smooth->sample(transform.point({4.5, 6.25, 5.5}));
  EXPECT_TRUE(relative(at.absorption, 4.5 + 6.25 + 5.5, 1e-9));
  EXPECT_TRUE(relative(at.temperature, 1500, 1e-9));
  EXPECT_TRUE(relative(smooth->source(0, 1500), double(total_source(1500)), 1e-9));
  const auto blocky =
      make_voxel_medium(t, absorption, VoxelInterpolation::constant, {SourceFunction::total()});
  EXPECT_TRUE(relative(blocky->bounds().lower.x, 1 + 2e-3 * 2.5, 1e-15));
  EXPECT_TRUE(relative(blocky->bounds().upper.x, 1 + 2e-3 * 8.5, 1e-15));
  EXPECT_EQ(blocky->sample(transform.point({4.4, 6.4, 5.6})).absorption, 4 + 6 + 6);
}

TEST(VoxelInput, BreakpointsAreTheCellFaces) {
  const auto transform = scaled(1e-3);
  const auto medium =
      make_voxel_medium(uniform_field(1500, 300, transform), uniform_field(10, 0, transform),
                        VoxelInterpolation::trilinear, {SourceFunction::total()});
  std::vector<double> t;
  medium->append_breakpoints({{-0.1, 4.5e-3, 5.5e-3}, {1, 0, 0}}, t);
  std::sort(t.begin(), t.end());
  for (int plane = -1; plane <= 12; ++plane) {
    const double at = 0.1 + plane * 1e-3;
    EXPECT_TRUE(std::any_of(t.begin(), t.end(), [&](double x) { return relative(x, at, 1e-12); }))
        << plane;
  }
  EXPECT_TRUE(relative(t.front(), 0.099, 1e-12));
  EXPECT_TRUE(relative(t.back(), 0.112, 1e-12));
  t.clear();
  medium->append_breakpoints({{-0.1, 40e-3, 5.5e-3}, {1, 0, 0}}, t);
  EXPECT_TRUE(t.empty());
}

// Constant inside, empty around, an opaque part: everything that can be skipped.
struct Skippable {
  VoxelField temperature, absorption;
  Skippable()
      : temperature(make_field(
            {0, 0, 0}, {80, 40, 40}, [](int i, int, int) { return i < 40 ? 1500.0f : 1700.0f; },
            scaled(1e-3), 300)),
        absorption(make_field(
            {0, 0, 0}, {80, 40, 40},
            [](int i, int j, int) {
              if (j >= 30 && i > 60) return 0.0f;
              return i < 40 ? 3.0f : 2000.0f;
            },
            scaled(1e-3))) {}
};

TEST(VoxelInput, SkippingChangesNothing) {
  const Skippable fields;
  const auto medium = make_voxel_medium(fields.temperature, fields.absorption,
                                        VoxelInterpolation::trilinear, {SourceFunction::total()});
  std::vector<Ray> rays;
  for (int r = 0; r < 64; ++r)
    rays.push_back({{-0.05, 1e-3 * (r % 8) * 5.1, 1e-3 * (r / 8) * 5.3},
                    normalize(Vec3{1, 0.1 * std::sin(r), 0.1 * std::cos(r)})});
  const Seen all = see<double>(*medium, rays, with(Isa::baseline, false));
  const Seen some = see<double>(*medium, rays, with(Isa::baseline, true));
  EXPECT_EQ(all.counters.skipped_empty, 0);
  EXPECT_EQ(all.counters.skipped_constant, 0);
  EXPECT_EQ(all.counters.opaque_tails, 0);
  EXPECT_GT(some.counters.skipped_constant, 64);
  EXPECT_GT(some.counters.opaque_tails, 20);
  EXPECT_LT(some.counters.cells, 0.5 * all.counters.cells);
  EXPECT_EQ(some.counters.rays, all.counters.rays);
  for (std::size_t r = 0; r < rays.size(); ++r) {
    // The tail that was cut is seen through a transmittance below 1e-7.
    EXPECT_TRUE(within(some.radiance[0][r], all.radiance[0][r], 1e-7, double(total_source(1700))));
    if (all.transmittance[r] > 1e-6) {
      EXPECT_TRUE(relative(some.radiance[0][r], all.radiance[0][r], 1e-12));
    }
    EXPECT_TRUE(within(some.transmittance[r], all.transmittance[r], 1e-7, 1));
  }
}

// Light behind a transmittance of 1e-7 is cut, and none before: tau of 16.1.
TEST(VoxelInput, OpaqueTailsBeginWhereTheySay) {
  const auto tails = [](double tau, auto real) {
    const auto kappa = static_cast<float>(tau / 80e-3);
    const auto medium = make_voxel_medium(
        make_field(
            {0, 0, 0}, {81, 41, 41}, [](int i, int, int) { return 1500.0f + i; }, scaled(1e-3),
            300),
        make_field(
            {0, 0, 0}, {81, 41, 41}, [&](int, int, int) { return kappa; }, scaled(1e-3)),
        VoxelInterpolation::trilinear, {SourceFunction::total()});
    std::vector<Ray> rays;
    for (int r = 0; r < 64; ++r)
      rays.push_back({{-0.05, 1e-3 * (5 + r % 8 * 3.1), 1e-3 * (5 + r / 8 * 3.3)}, {1, 0, 0}});
    double all = 0;
    for (const Isa isa : supported_isas())
      all += see<decltype(real)>(*medium, rays, with(isa, true)).counters.opaque_tails;
    return all / 64 / static_cast<double>(supported_isas().size());
  };
  // A ray of tau 15 ends by itself; one of 30 is cut in the brick where it passes 16.1.
  EXPECT_EQ(tails(15, float()), 0);
  EXPECT_EQ(tails(15, double()), 0);
  EXPECT_EQ(tails(30, float()), 1);
  EXPECT_EQ(tails(30, double()), 1);
}

// Planck's law from where nothing is stimulated to where most is: what the kernels leave out of it
// must not show.
TEST(VoxelInput, StimulatedEmissionIsExactWhereverItMatters) {
  const auto field = [](float value, float background) {
    return make_field(
        {0, 0, 0}, {24, 16, 16}, [&](int i, int, int) { return i < 20 ? value : value + 1; },
        scaled(1e-3), background);
  };
  std::vector<Ray> rays;
  for (int r = 0; r < 16; ++r) rays.push_back({{-0.05, 1e-3 * (3 + 0.7 * r), 8e-3}, {1, 0, 0}});
  const double temperature = 1500;
  for (double power = 1; power < 24; power += 0.5) {
    // e^(-c2 / (lambda T)) = 2^-power
    const double wavelength = 0.01438776877 / (temperature * power * std::log(2.0));
    const SourceFunction source = SourceFunction::band(wavelength, 1e-3 * wavelength);
    const auto medium = make_voxel_medium(field(1500, 1500), field(5000, 0),
                                          VoxelInterpolation::trilinear, {source});
    for (const Isa isa : supported_isas()) {
      const Seen single = see<float>(*medium, rays, with(isa, true));
      const Seen twice = see<double>(*medium, rays, with(isa, true));
      for (std::size_t r = 0; r < rays.size(); ++r) {
        EXPECT_TRUE(relative(single.radiance[0][r], source(temperature), 4e-7)) << power;
        EXPECT_TRUE(relative(twice.radiance[0][r], source(temperature), 3e-8)) << power;
      }
    }
  }
}

TEST(VoxelInput, SkippingEmptyBricksIsBitIdentical) {
  // Two balls with empty bricks and blocks between them, no constant brick, nothing opaque.
  const auto ball = [](int i, int j, int k, int x) {
    const int r2 = (i - x) * (i - x) + (j - 8) * (j - 8) + (k - 8) * (k - 8);
    return r2 < 40 ? 3.0f + 0.01f * r2 : 0.0f;
  };
  const auto kappa = [&](int i, int j, int k) { return ball(i, j, k, 8) + ball(i, j, k, 190); };
  const auto transform = scaled(1e-3);
  const auto medium = make_voxel_medium(
      make_field(
          {0, 0, 0}, {200, 16, 16}, [](int i, int j, int) { return 1200.0f + i + j; }, transform,
          300),
      make_field({0, 0, 0}, {200, 16, 16}, kappa, transform), VoxelInterpolation::trilinear,
      {SourceFunction::total(), SourceFunction::band(650e-9, 10e-9)});
  std::vector<Ray> rays;
  for (int r = 0; r < 64; ++r)
    rays.push_back({{-0.05, 1e-3 * (4 + r % 8), 1e-3 * (3.5 + r / 8)},
                    normalize(Vec3{1, 0.02 * std::sin(r), 0.02 * std::cos(r)})});
  for (const Isa isa : supported_isas()) {
    const Seen all = see<float>(*medium, rays, with(isa, false));
    const Seen some = see<float>(*medium, rays, with(isa, true));
    EXPECT_GT(some.counters.skipped_empty, 64);
    EXPECT_EQ(all.counters.skipped_empty, 0);
    EXPECT_EQ(some.radiance, all.radiance);
    EXPECT_EQ(some.transmittance, all.transmittance);
  }
}

}  // namespace
}  // namespace plenoflame::test::voxel_input_test
