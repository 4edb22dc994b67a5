// Emission lines on voxel grids: closed forms, the adaptive integrator of voxel_fixture.h, and what
// is skipped.
#include <gtest/gtest.h>

#include <random>

#include "plenoflame/base/error.h"
#include "voxel_fixture.h"

namespace plenoflame::test::voxel_lines_test {
namespace {

constexpr double kSpacing = 1e-3;

struct Flame {
  VoxelField temperature, absorption;
  std::vector<VoxelField> lines;
  std::vector<double> weights;  // channel * lines + line
  std::vector<double> factors = {};
  std::unique_ptr<Medium> medium(VoxelInterpolation mode) const {
    const std::size_t channels = weights.size() / lines.size();
    return make_voxel_medium(
        temperature, absorption, mode,
        std::vector<SourceFunction>(channels, SourceFunction::band(650e-9, 1e-12)),
        {.absorption_factors = factors, .extras = {lines, weights}});
  }
};

VoxelField box(std::array<int, 3> high, const SampleFunction& value, Vec3 move = {},
               std::array<int, 3> low = {0, 0, 0}, float background = 0) {
  return make_field(low, high, value, scaled(kSpacing, move), background);
}
VoxelField even(std::array<int, 3> high, float value, float background = 0) {
  return box(
      high, [=](int, int, int) { return value; }, {}, {0, 0, 0}, background);
}

double relative_error(double value, double expected) {
  return std::fabs(value / expected - 1);
}

// A block of 24 x 20 x 20 voxels with one value each is 24 mm deep along x: eps L while it is
// clear, eps / kappa (1 - e^(-kappa L)) otherwise; cold, so that nothing else emits. Both as bricks
// that are passed at once and cell by cell. Fails when the absorption is left out, when a channel
// gets another one's weight, or when bricks that only emit are taken for empty.
TEST(VoxelLines, HomogeneousBlockInClosedForm) {
  const std::array<int, 3> size{24, 20, 20};
  constexpr double kEmission = 35, kLength = 24 * kSpacing;
  const std::vector<Ray> rays{{{-0.1, 0.0103, 0.0097}, {1, 0, 0}},
                              {{0.4, 0.01, 0.008}, {-1, 0, 0}}};
  for (const double kappa : {0.0, 1e-6, 0.3, 40.0, 3000.0, 2e5})
    for (const bool spectral : {false, true}) {
      Flame flame{even(size, 300, 300),
                  even(size, static_cast<float>(kappa)),
                  {even(size, kEmission), even(size, 2)},
                  {1, 0, 0.25, 3, 0, 0}};
      if (spectral) flame.factors = {1, 0.5, 2};
      const auto medium = flame.medium(VoxelInterpolation::constant);
      for (const Isa isa : supported_isas())
        for (const bool skip : {true, false}) {
          const Seen precise = see<double>(*medium, rays, with(isa, skip));
          const Seen single = see<float>(*medium, rays, with(isa, skip));
          for (int c = 0; c < 3; ++c)
            for (std::size_t r = 0; r < rays.size(); ++r) {
              const double own = spectral ? std::array{1.0, 0.5, 2.0}[c] : 1.0;
              const double k = static_cast<float>(kappa) * own;
              const double emission = std::array{kEmission, 0.25 * kEmission + 6, 0.0}[c];
              const double expected = emission * (k > 0 ? -std::expm1(-k * kLength) / k : kLength);
              if (expected == 0) {
                EXPECT_LT(precise.radiance[c][r], 1e-18);
                continue;
              }
              // Behind a transmittance of 1e-7 rays are cut.
              const double cut = skip && k * kLength > 16 ? 1e-7 : 1e-12;
              EXPECT_LT(relative_error(precise.radiance[c][r], expected), cut)
                  << kappa << " " << c << " " << skip;
              EXPECT_LT(relative_error(single.radiance[c][r], expected), 2e-5)
                  << kappa << " " << c << " " << skip;
            }
        }
    }
}

// Rays that end on something solid, or begin within the flame, see the light of what they pass and
// no more: of the same block from 5.3 to 17.8 mm, through bricks passed at once and cell by cell.
TEST(VoxelLines, CutWhereARayBeginsAndEnds) {
  const std::array<int, 3> size{24, 20, 20};
  const std::vector<Ray> rays{{{0, 0.0103, 0.0097}, {1, 0, 0}}, {{24e-3, 0.01, 0.008}, {-1, 0, 0}}};
  constexpr double kFrom = 5.3e-3, kTo = 17.8e-3;
  for (const double kappa : {0.0, 40.0}) {
    const Flame flame{
        even(size, 300, 300), even(size, static_cast<float>(kappa)), {even(size, 35)}, {1}};
    const double expected =
        35 * (kappa > 0 ? -std::expm1(-kappa * (kTo - kFrom)) / kappa : kTo - kFrom);
    for (const auto mode : {VoxelInterpolation::constant, VoxelInterpolation::trilinear}) {
      const auto medium = flame.medium(mode);
      for (const Isa isa : supported_isas())
        for (const bool skip : {true, false})
          for (std::size_t r = 0; r < rays.size(); ++r) {
            const Seen precise = see<double>(*medium, rays, with(isa, skip), kFrom, kTo);
            const Seen single = see<float>(*medium, rays, with(isa, skip), kFrom, kTo);
            EXPECT_LT(relative_error(precise.radiance[0][r], expected), 1e-12) << kappa << skip;
            EXPECT_LT(relative_error(single.radiance[0][r], expected), 2e-5) << kappa << skip;
          }
    }
  }
}

// Emission that rises evenly through gas that absorbs evenly, on an oblique ray that begins and
// ends inside: exact. Fails when the weights of the two nodes are made equal.
TEST(VoxelLines, LinearEmissionInHomogeneousGasIsExact) {
  const std::array<int, 3> size{32, 32, 32};
  for (const double kappa : {0.0, 20.0, 500.0}) {
    const Flame flame{even(size, 300, 300),
                      even(size, static_cast<float>(kappa)),
                      {box(size, [](int i, int j, int) { return 3 + 2.0f * i + j; })},
                      {1}};
    const auto medium = flame.medium(VoxelInterpolation::trilinear);
    const Vec3 d = normalize(Vec3{2, 1.3, 0.4});
    const Vec3 from{3.3e-3, 4.4e-3, 5.5e-3};
    const double length = 22e-3, at = 3 + 2 * 3.3 + 4.4, slope = (2 * d.x + d.y) / kSpacing;
    const double tau = kappa * length;
    const double expected = kappa > 0
                                ? at * -std::expm1(-tau) / kappa +
                                      slope * (1 - std::exp(-tau) * (1 + tau)) / (kappa * kappa)
                                : at * length + 0.5 * slope * length * length;
    for (const Isa isa : supported_isas()) {
      const Seen precise = see<double>(*medium, {{from, d}}, with(isa), 0, length, from);
      const Seen single = see<float>(*medium, {{from, d}}, with(isa), 0, length, from);
      EXPECT_LT(relative_error(precise.radiance[0][0], expected), 1e-12) << kappa;
      EXPECT_LT(relative_error(single.radiance[0][0], expected), 1e-5) << kappa;
    }
  }
}

Flame random_flame(float thickness, float temperature = 1600) {
  std::mt19937 random(7);
  const auto value = [&](float low, float high) {
    return SampleFunction([&random, low, high](int, int, int) {
      return std::uniform_real_distribution<float>(low, high)(random);
    });
  };
  const std::array<int, 3> size{20, 18, 19};
  return {box(
              size, [=](int, int, int) { return temperature; }, {}, {0, 0, 0}, temperature),
          box(size, value(0, thickness)),
          {box(size, value(0, 0.02f)), box({9, 30, 12}, value(0, 0.03f))},
          {0.7, 0, 0.2, 1.5}};
}

VoxelField weighted(const Flame& flame, std::size_t channel) {
  // Both lines in one field, on the smallest box that holds both.
  std::map<std::array<int, 3>, float> sum;
  for (std::size_t l = 0; l < 2; ++l) {
    const VoxelField& line = flame.lines[l];
    for (std::size_t b = 0; b < line.brick_origins.size(); ++b)
      for (int v = 0; v < 512; ++v) {
        const auto& o = line.brick_origins[b];
        sum[{o[0] + v / 64, o[1] + v / 8 % 8, o[2] + v % 8}] +=
            static_cast<float>(flame.weights[2 * channel + l]) * line.values[b * 512 + v];
      }
  }
  return box({40, 40, 40}, [&](int i, int j, int k) {
    const auto found = sum.find({i, j, k});
    return found == sum.end() ? 0.0f : found->second;
  });
}

// Noise of one voxel, evenly hot, with two lines, one of which reaches out of the absorption:
// against an integrator that shares nothing. Two nodes per cell leave an error of the cell's
// optical thickness; its square along the axes, where emission and absorption are linear within a
// cell. Fails when the weights do not know on which side of a cell the absorption is.
TEST(VoxelLines, NoiseAgainstTheReference) {
  const std::vector<Ray> oblique{{{-5e-3, 2e-3, 3e-3}, normalize(Vec3{3, 1.1, 0.7})},
                                 {{30e-3, 8e-3, 4e-3}, normalize(Vec3{-2, 0.4, 1})},
                                 {{4e-3, 40e-3, 9e-3}, normalize(Vec3{0.1, -1, 0.05})}};
  const std::vector<Ray> along{{{-5e-3, 7.3e-3, 5.9e-3}, {1, 0, 0}},
                               {{6.4e-3, -5e-3, 9.2e-3}, {0, 1, 0}},
                               {{3.1e-3, 5.5e-3, 40e-3}, {0, 0, -1}}};
  const auto worst = [](const Flame& flame, const std::vector<Ray>& rays) {
    const auto medium = flame.medium(VoxelInterpolation::trilinear);
    double most = 0;
    for (const Isa isa : supported_isas()) {
      const Seen precise = see<double>(*medium, rays, with(isa));
      const Seen plain = see<double>(*medium, rays, with(isa, false));
      const Seen single = see<float>(*medium, rays, with(isa));
      for (std::size_t c = 0; c < 2; ++c) {
        const VoxelField line = weighted(flame, c);
        for (std::size_t r = 0; r < rays.size(); ++r) {
          const auto expected = integrate_voxels(
              {flame.temperature, flame.absorption, VoxelInterpolation::trilinear, &line}, rays[r],
              {0, 1}, line_source(650e-9, 1e-12));
          const double value = precise.radiance[c][r];
          most = std::max(most, relative_error(value, double(expected.radiance)));
          EXPECT_LT(relative_error(plain.radiance[c][r], value), 1e-6);
          EXPECT_LT(relative_error(single.radiance[c][r], value), 1e-5);
        }
      }
    }
    return most;
  };
  EXPECT_LT(worst(random_flame(100), oblique), 1e-5);
  // Cold: nothing but the lines, in cells of an optical thickness of 0.1 on average, and of half.
  const double thick = worst(random_flame(200, 300), along);
  EXPECT_LT(thick, 1e-4);
  EXPECT_LT(worst(random_flame(100, 300), along), thick / 3);
}

// A region that only emits is no empty space: bounds, occupied boxes and rays know it. The field's
// samples are moved against the absorption's, by whole spacings.
TEST(VoxelLines, EmissionBeyondTheAbsorption) {
  const Flame flame{
      even({8, 8, 8}, 1500, 300),
      even({8, 8, 8}, 10),
      {box({6, 6, 6}, [](int, int, int) { return 4.0f; }, {43 * kSpacing, -11 * kSpacing, 0})},
      {1}};
  const auto medium = flame.medium(VoxelInterpolation::constant);
  const Vec3 middle{46e-3, -8e-3, 3e-3};
  EXPECT_TRUE(medium->bounds().lower.y < middle.y && medium->bounds().upper.x > middle.x);
  const auto boxes = medium->occupied();
  EXPECT_TRUE(std::any_of(boxes.begin(), boxes.end(), [&](const Box& b) {
    return b.lower.x < middle.x && b.upper.x > middle.x && b.lower.y < middle.y &&
           b.upper.y > middle.y;
  }));
  double emission = 0;
  EXPECT_EQ(medium->coefficients(middle, &emission), 0);
  EXPECT_EQ(emission, 4);
  medium->coefficients({4e-3, 4e-3, 4e-3}, &emission);
  EXPECT_TRUE(relative(emission, 10 * SourceFunction::band(650e-9, 1e-12)(1500), 1e-6));
  for (const Isa isa : supported_isas())
    for (const bool skip : {true, false}) {
      const Seen seen = see<double>(*medium, {{{46e-3, -1, 3e-3}, {0, 1, 0}}}, with(isa, skip));
      EXPECT_TRUE(relative(seen.radiance[0][0], 4 * 6e-3, 1e-12));
      EXPECT_EQ(seen.transmittance[0], 1);
    }
}

// A flame that absorbs nowhere is seen by its line all the same.
TEST(VoxelLines, NothingButALine) {
  VoxelField nothing = even({8, 8, 8}, 0);
  const Flame flame{even({8, 8, 8}, 300, 300), nothing, {even({8, 8, 8}, 4)}, {0.5}};
  const auto medium = flame.medium(VoxelInterpolation::constant);
  EXPECT_FALSE(medium->bounds().empty());
  EXPECT_EQ(medium->largest_absorption(0), 0);
  const Seen seen =
      see<double>(*medium, {{{-1, 4e-3, 3e-3}, {1, 0, 0}}}, with(Isa::baseline), -1e30, 1e30);
  EXPECT_TRUE(relative(seen.radiance[0][0], 0.5 * 4 * 8e-3, 1e-12));
}

// The sum of media that overlap is integrated.
TEST(VoxelLines, OverlappingMedia) {
  const Flame one = random_flame(60);
  Flame two = random_flame(30);
  for (VoxelField* field : {&two.temperature, &two.absorption, two.lines.data(), &two.lines[1]})
    field->index_to_world.translation = {7.3e-3, -2.1e-3, 1.7e-3};
  const auto both = make_composite_medium(
      {one.medium(VoxelInterpolation::trilinear), two.medium(VoxelInterpolation::trilinear)});
  const Ray ray{{-5e-3, 6e-3, 7e-3}, normalize(Vec3{3, 0.2, 0.4})};
  const Seen seen = see<double>(*both, {ray}, with(Isa::baseline));
  const std::vector<double> expected = integrate_reference(*both, ray, 0, 1);
  for (std::size_t c = 0; c < 2; ++c)
    EXPECT_LT(relative_error(seen.radiance[c][0], expected[c]), 1e-8);
}

std::string refused(const Flame& flame) {
  try {
    flame.medium(VoxelInterpolation::trilinear);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(VoxelLines, Refusals) {
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  const Flame good{even({8, 8, 8}, 300, 300), even({8, 8, 8}, 1), {even({8, 8, 8}, 4)}, {1}};
  EXPECT_EQ(refused(good), "");
  Flame bad = good;
  bad.lines[0].name = "CH*";
  bad.lines[0].index_to_world.translation.x = 0.4 * kSpacing;
  EXPECT_TRUE(has(refused(bad), "field 'CH*' is not on the lattice of 'test'"));
  bad = good;
  bad.lines[0].index_to_world = scaled(2 * kSpacing);
  EXPECT_TRUE(has(refused(bad), "not on the lattice"));
  bad = good;
  bad.lines[0].values[66] = -1;
  EXPECT_TRUE(has(refused(bad), "value -1 at index (1, 0, 2)"));
  bad = good;
  bad.lines[0].background = 1;
  EXPECT_TRUE(has(refused(bad), "all of space would glow"));
  bad = good;
  bad.weights = {-1};
  EXPECT_TRUE(has(refused(bad), "weight"));
  bad = good;
  bad.lines.assign(9, bad.lines[0]);
  bad.weights.assign(9, 1);
  EXPECT_TRUE(has(refused(bad), "8 emission lines at most"));
}

}  // namespace
}  // namespace plenoflame::test::voxel_lines_test
