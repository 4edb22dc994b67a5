// Fields of albedos: extinction and emission of the voxel medium.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "plenoflame/base/error.h"
#include "plenoflame/media/uniform_medium.h"
#include "voxel_fixture.h"

namespace plenoflame::test::voxel_albedo_test {
namespace {

constexpr double kSpacing = 1e-3;
const std::array<int, 3> kSize{20, 18, 19};

VoxelField field(const SampleFunction& value, float background = 0, Vec3 move = {}) {
  return make_field({0, 0, 0}, kSize, value, scaled(kSpacing, move), background);
}
VoxelField even(float value, float background = 0) {
  return field([=](int, int, int) { return value; }, background);
}
SampleFunction noise(std::mt19937& random, float low, float high) {
  return [&random, low, high](int, int, int) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
}

std::unique_ptr<Medium> medium_of(const VoxelField& temperature, const VoxelField& absorption,
                                  const VoxelField& albedo,
                                  VoxelInterpolation mode = VoxelInterpolation::trilinear,
                                  std::vector<double> factors = {}) {
  VoxelMediumOptions options;
  options.absorption_factors = std::move(factors);
  options.extras.albedo = albedo;
  return make_voxel_medium(temperature, absorption, mode,
                           {SourceFunction::total(), SourceFunction::band(650e-9, 1e-12)}, options);
}

const std::vector<Ray> kRays{{{-5e-3, 2e-3, 3e-3}, normalize(Vec3{3, 1.1, 0.7})},
                             {{30e-3, 8e-3, 4e-3}, normalize(Vec3{-2, 0.4, 1})},
                             {{3.1e-3, 5.5e-3, 40e-3}, {0, 0, -1}}};

// The same albedo everywhere: extinction 1 / (1 - albedo) times the absorption, emission that of
// the absorption. In constant bricks and in varying ones, with a border of its own.
TEST(VoxelAlbedo, ConstantGridIsAsGoodAsAConstant) {
  std::mt19937 random(3);
  const float albedo = 0.375f, kept = 1 - albedo;
  for (const bool varying : {true, false}) {
    const VoxelField absorption = varying ? field(noise(random, 10, 90)) : even(50);
    VoxelField extinction = absorption;
    for (float& value : extinction.values) value /= kept;
    for (const auto mode : {VoxelInterpolation::trilinear, VoxelInterpolation::constant})
      for (const bool spectral : {false, true}) {
        const std::vector<double> factors =
            spectral ? std::vector<double>{0.7, 1.9} : std::vector<double>{};
        const auto grid = medium_of(even(1600, 300), absorption, even(albedo), mode, factors);
        const auto equal =
            make_voxel_medium(even(1600, 300), extinction, mode,
                              {SourceFunction::total(), SourceFunction::band(650e-9, 1e-12)},
                              {.absorption_factors = factors});
        for (const Isa isa : supported_isas()) {
          const Seen a = see<double>(*grid, kRays, with(isa));
          const Seen b = see<double>(*equal, kRays, with(isa));
          for (std::size_t r = 0; r < kRays.size(); ++r) {
            EXPECT_TRUE(relative(a.transmittance[r], b.transmittance[r], 1e-6));
            for (std::size_t c = 0; c < 2; ++c)
              // At the border the albedo falls to 0 with the absorption, in a trilinear grid.
              if (mode == VoxelInterpolation::constant)
                EXPECT_TRUE(relative(a.radiance[c][r], kept * b.radiance[c][r], 1e-6));
              else
                EXPECT_TRUE(a.radiance[c][r] > kept * b.radiance[c][r]);
          }
        }
        EXPECT_TRUE(relative(grid->albedo({9e-3, 9e-3, 9e-3}), 0.375, 1e-6));
        EXPECT_TRUE(relative(grid->largest_absorption(0), equal->largest_absorption(0), 1e-6));
      }
  }
}

// Places of extinction are drawn by it: below it the medium would be too clear, far above it slow.
TEST(VoxelAlbedo, LargestAbsorptionOfEveryChannel) {
  std::mt19937 random(8);
  const VoxelField absorption = field(noise(random, 10, 90));
  const std::vector<double> factors{0.7, 1.9};
  const std::shared_ptr<const Medium> voxels =
      medium_of(even(1600, 300), absorption, even(0), VoxelInterpolation::trilinear, factors);
  float most = 0;
  for (const float value : absorption.values) most = std::max(most, value);
  const std::vector<double> own = voxels->majorants();
  ASSERT_EQ(own.size(), 2u);
  const std::vector<double> twice = make_composite_medium({voxels, voxels})->majorants();
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_TRUE(relative(own[c], factors[c] * static_cast<double>(most), 1e-6));
    EXPECT_TRUE(relative(twice[c], 2 * own[c], 1e-12));
  }
  EXPECT_THROW(static_cast<void>(make_uniform_medium(1, 2)->majorants()), InputError);
}

// Noise: against the adaptive integrator of what the medium says at each place, which the next test
// holds to the samples themselves.
TEST(VoxelAlbedo, NoiseAgainstTheReference) {
  std::mt19937 random(4);
  const auto medium =
      medium_of(even(1600, 1600), field(noise(random, 0, 60)), field(noise(random, 0, 0.9f), 0.2f));
  for (std::size_t r = 0; r < kRays.size(); ++r) {
    const std::vector<double> expected = integrate_reference(*medium, kRays[r], 0, 1);
    for (const Isa isa : supported_isas()) {
      const Seen precise = see<double>(*medium, {kRays[r]}, with(isa));
      const Seen single = see<float>(*medium, {kRays[r]}, with(isa));
      EXPECT_TRUE(relative(-std::log(precise.transmittance[0]), expected[2], 1e-8));
      for (std::size_t c = 0; c < 2; ++c) {
        EXPECT_TRUE(relative(precise.radiance[c][0], expected[c], 1e-3)) << r;
        EXPECT_TRUE(relative(single.radiance[c][0], precise.radiance[c][0], 1e-5));
      }
    }
  }
}

// At a sample extinction is absorption / (1 - albedo), emission that of the absorption. The
// albedo's samples are moved by whole spacings.
TEST(VoxelAlbedo, CoefficientsAtASample) {
  VoxelField albedo = field([](int i, int j, int) { return 0.04f * i + 0.001f * j; }, 0,
                            {-2 * kSpacing, 3 * kSpacing, 0});
  const auto medium =
      medium_of(even(1500, 300), field([](int i, int, int k) { return 10.0f + i + k; }), albedo);
  double emission[2];
  const double extinction = medium->coefficients({5e-3, 9e-3, 4e-3}, emission);
  const double there = 0.04 * 7 + 0.001 * 6;  // the albedo's sample (7, 6, 4)
  EXPECT_TRUE(relative(medium->albedo({5e-3, 9e-3, 4e-3}), there, 1e-6));
  EXPECT_TRUE(relative(extinction, 19 / (1 - there), 1e-6));
  EXPECT_TRUE(relative(emission[0], 19 * SourceFunction::total()(1500), 1e-6));
}

TEST(VoxelAlbedo, Refusals) {
  const auto message = [](float value) -> std::string {
    VoxelField albedo = even(0.5f);
    albedo.name = "omega";
    albedo.values[66] = value;
    try {
      medium_of(even(1500, 300), even(1), albedo);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(0.99f), "");
  for (const float value : {1.0f, 1.5f, -0.1f, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_NE(message(value).find("field 'omega': the albedo at index (1, 0, 2) is"),
              std::string::npos);
}

}  // namespace
}  // namespace plenoflame::test::voxel_albedo_test
