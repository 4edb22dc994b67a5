// Coefficients at several places of a cell at a time, against those of each place alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "media/voxels/cell_sampling.h"
#include "plenoflame/base/error.h"
#include "voxel_fixture.h"

namespace plenoflame::test::voxel_cells_test {
namespace {

constexpr int kPlaces = CellSampling::kMostAtOnce;

/// Along rays from everywhere, between all neighbouring breakpoints.
void expect_as_alone(const Medium& medium, int channels) {
  const auto* const cells = dynamic_cast<const CellSampling*>(&medium);
  ASSERT_NE(cells, nullptr);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> in(-1, 1);
  const Box box = medium.bounds();
  const Vec3 middle = 0.5 * (box.lower + box.upper), half = 0.5 * (box.upper - box.lower);
  int lit = 0;
  for (int n = 0; n < 40; ++n) {
    const Vec3 through =
        middle + Vec3{half.x * in(random), half.y * in(random), half.z * in(random)};
    const Vec3 direction = normalize(Vec3{in(random), in(random), in(random)});
    const Ray ray{through - 2 * length(half) * direction, direction};
    std::vector<double> limits;
    medium.append_breakpoints(ray, limits);
    std::sort(limits.begin(), limits.end());
    for (std::size_t k = 0; k + 1 < limits.size(); ++k) {
      const double width = limits[k + 1] - limits[k];
      if (!(width > 1e-9 * length(half))) continue;
      std::array<double, kPlaces> t{}, temperature{};
      for (int i = 0; i < kPlaces; ++i)
        t[static_cast<std::size_t>(i)] = limits[k] + width * (i + 0.5) / kPlaces;
      std::vector<double> emission(static_cast<std::size_t>(kPlaces * channels)),
          absorption(emission), one(static_cast<std::size_t>(medium.channel_count())), each(one);
      cells->coefficients_between(ray, t, channels,
                                  {emission.data(), absorption.data(), temperature.data()});
      for (std::size_t i = 0; i < kPlaces; ++i) {
        const Vec3 place = ray.at(t[i]);
        medium.coefficients(place, one.data());
        medium.absorptions(place, each.data());
        for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
          // Differences of stored values cancel: rounding counts against the largest of them.
          const std::size_t at = i * static_cast<std::size_t>(channels) + c;
          ASSERT_TRUE(relative(absorption[at], each[c], 1e-9)) << n << " " << k;
          ASSERT_TRUE(relative(emission[at], one[c], 1e-9)) << n << " " << k;
          lit += emission[at] > 0;
        }
        if (each[0] > 0) {
          ASSERT_TRUE(relative(temperature[i], medium.sample(place).temperature, 1e-9));
        }
      }
    }
  }
  EXPECT_GT(lit, 1000);
}

VoxelField noise(std::array<int, 3> low, std::array<int, 3> high, float least, float most,
                 const AffineTransform& transform, unsigned seed) {
  std::mt19937 random(seed);
  return make_field(
      low, high,
      [&](int, int, int) { return std::uniform_real_distribution<float>(least, most)(random); },
      transform);
}

TEST(VoxelCells, PlacesOfACellAreThoseOfEachAlone) {
  const AffineTransform cells = scaled(1e-3);
  const VoxelField absorption = noise({-3, 0, 1}, {15, 12, 13}, 10, 90, cells, 1);
  const VoxelField temperature = noise({-3, 0, 1}, {15, 12, 13}, 1200, 1900, cells, 2);
  const std::vector<SourceFunction> bands{SourceFunction::total(),
                                          SourceFunction::band(650e-9, 1e-9),
                                          SourceFunction::band(450e-9, 1e-9)};
  for (const VoxelInterpolation mode :
       {VoxelInterpolation::trilinear, VoxelInterpolation::constant})
    for (const int channels : {1, 3}) {
      expect_as_alone(*make_voxel_medium(temperature, absorption, mode, bands), channels);
      expect_as_alone(*make_voxel_medium(temperature, absorption, mode, bands,
                                         {.absorption_factors = {1.0, 1.3, 2.1}}),
                      channels);
    }
  // Temperature on a lattice of its own.
  expect_as_alone(*make_voxel_medium(noise({-4, -1, 0}, {16, 13, 14}, 1200, 1900,
                                           scaled(1e-3, {0.3e-3, -0.2e-3, 0.1e-3}), 3),
                                     absorption, VoxelInterpolation::trilinear, bands),
                  3);
  // Albedo and emission lines.
  VoxelMediumOptions options;
  VoxelExtras& extras = options.extras;
  extras.albedo = noise({-3, 0, 1}, {15, 12, 13}, 0.1F, 0.6F, cells, 4);
  extras.lines.push_back(noise({-3, 0, 1}, {15, 12, 13}, 100, 900, cells, 5));
  extras.line_weights = {0, 1, 0.2};
  expect_as_alone(
      *make_voxel_medium(temperature, absorption, VoxelInterpolation::trilinear, bands, options),
      3);
}

}  // namespace
}  // namespace plenoflame::test::voxel_cells_test
