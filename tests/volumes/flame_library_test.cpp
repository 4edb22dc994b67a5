#include "plenoflame/volumes/flame_library.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "plenoflame/base/error.h"
#include "support/approx.h"
#include "volumes/support.h"

namespace plenoflame::flame_library_test {
namespace {

using test::contains;
using test::FieldSampler;
using test::message_of;
using test::relative;

const double kPi = std::acos(-1.0);

double sum_of(const VoxelField& field) {
  double sum = 0;
  for (const float value : field.values) sum += static_cast<double>(value);
  return sum;
}

/// Calls visit(index, absorption) for every sample that absorbs.
template <class Visit>
void for_each_sample(const VoxelField& field, Visit&& visit) {
  for (std::size_t i = 0; i < field.values.size(); ++i) {
    if (field.values[i] == 0) continue;
    const auto& o = field.brick_origins[i / 512];
    const auto v = static_cast<int>(i % 512);
    visit(std::array<int, 3>{o[0] + v / 64, o[1] + v / 8 % 8, o[2] + v % 8},
          static_cast<double>(field.values[i]));
  }
}

/// Checks the properties that every generated flame must have.
void expect_sound(const FlameFields& flame, double lowest, double highest) {
  EXPECT_EQ(flame.absorption.name, "absorption");
  EXPECT_EQ(flame.temperature.name, "temperature");
  EXPECT_EQ(flame.absorption.background, 0);
  EXPECT_EQ(flame.temperature.background, static_cast<float>(kAmbientTemperature));
  ASSERT_FALSE(flame.absorption.values.empty());
  for (const float value : flame.absorption.values) ASSERT_GE(value, 0);
  const std::set<std::array<int, 3>> hot(flame.temperature.brick_origins.begin(),
                                         flame.temperature.brick_origins.end());
  EXPECT_EQ(hot.size(), flame.temperature.brick_origins.size());
  const FieldSampler temperature(flame.temperature);
  for_each_sample(flame.absorption, [&](const std::array<int, 3>& at, double) {
    const auto t = static_cast<double>(temperature.at(at[0], at[1], at[2]));
    ASSERT_GE(t, lowest);
    ASSERT_LE(t, highest);
    for (const int side : {-2, 2})
      for (std::size_t axis = 0; axis < 3; ++axis) {
        auto brick = at;
        brick[axis] += side;
        for (int& x : brick) x = static_cast<int>(std::floor(x / 8.0)) * 8;
        ASSERT_TRUE(hot.contains(brick)) << "temperature ends too close to absorption";
      }
  });
}

TEST(SootAbsorption, AsPublished) {
  // E(m) = 0.26 at 650 nm: 7.54 1/m per ppm; 0.37: 10.73; 532 nm: 9.21.
  EXPECT_TRUE(relative(soot_absorption(1e-6, 0.26, 650e-9), 7.54, 1e-3));
  EXPECT_TRUE(relative(soot_absorption(1e-6, 0.37, 650e-9), 10.73, 1e-3));
  EXPECT_TRUE(relative(soot_absorption(1e-6, 0.26, 532e-9), 9.21, 1e-3));
}

/// Chord through the axis at height u: Gaussian integrals in closed form.
double chord_of(const SootFlameOptions& o, double u) {
  const double m = o.peak_position, q = o.sharpness, p = q * m / (1 - m);
  const double along = std::pow(u / m, p) * std::pow((1 - u) / (1 - m), q);
  const double r0 = (1 - u) * (o.base_radius + o.bulge * u);
  const double annulus = std::sqrt(kPi) * o.annulus_width * (1 + std::erf(r0 / o.annulus_width));
  const double core = o.core_share * u * u * std::sqrt(kPi) * o.core_width;
  const double kappa = 6 * kPi * o.absorption_function * o.peak_volume_fraction / o.wavelength;
  return kappa * along * (annulus + core);
}

TEST(SootFlame, ChordsThroughTheAxis) {
  for (SootFlameOptions options : {candle_flame(), diffusion_flame()}) {
    options.absorption_function = 0.3;
    const FlameFields flame = make_soot_flame(options, {});
    const FieldSampler absorption(flame.absorption);
    for (const double u : {0.2, 0.5, 0.7}) {
      const int k = static_cast<int>(std::lround(u * options.height / options.voxel_size));
      double along_x = 0, along_y = 0;
      for (int i = -100; i <= 100; ++i) {
        along_x += static_cast<double>(absorption.at(i, 0, k));
        along_y += static_cast<double>(absorption.at(0, i, k));
      }
      // The trapezoidal rule on Gaussians of several voxels' width; their two halves meet in a kink
      // on the axis, of the order of exp(-(r0/w)^2).
      const double expected = chord_of(options, k * options.voxel_size / options.height);
      EXPECT_TRUE(relative(along_x * options.voxel_size, expected, 1e-3)) << u;
      EXPECT_TRUE(relative(along_y * options.voxel_size, expected, 1e-3)) << u;
    }
  }
}

TEST(SootFlame, WithinThePublishedRanges) {
  struct Case {
    SootFlameOptions options;
    double least_kappa, most_kappa, coolest, hottest;
  };
  // f_v of 1 to 4 ppm in a candle, 8 to 10 ppm in a diffusion flame, times 7.54 1/m per ppm.
  for (const Case& c :
       {Case{candle_flame(), 7.5, 30, 900, 1900}, Case{diffusion_flame(), 60, 76, 1000, 2050}}) {
    const FlameFields flame = make_soot_flame(c.options, {});
    expect_sound(flame, 290, c.hottest);
    const double densest =
        *std::max_element(flame.absorption.values.begin(), flame.absorption.values.end());
    EXPECT_GE(densest, c.least_kappa);
    EXPECT_LE(densest, c.most_kappa);
    // The flame glows wherever there is half of the largest soot or more.
    const FieldSampler temperature(flame.temperature);
    for_each_sample(flame.absorption, [&](const std::array<int, 3>& at, double kappa) {
      if (kappa < densest / 2) return;
      ASSERT_GE(temperature.at(at[0], at[1], at[2]), 1400);
      ASSERT_LE(temperature.at(at[0], at[1], at[2]), 2000);
    });
  }
}

TEST(SootFlame, NothingBelowTheBurnerOrAboveTheTip) {
  const SootFlameOptions options = candle_flame();
  for_each_sample(make_soot_flame(options, {}).absorption,
                  [&](const std::array<int, 3>& at, double) {
                    ASSERT_GT(at[2] * options.voxel_size, 0);
                    ASSERT_LT(at[2] * options.voxel_size, options.height);
                  });
}

TEST(SootFlame, BoundsHoldEverythingWorthKeeping) {
  // The soot at the border of the bounds is below what is left out: a wide flame must not be cut.
  SootFlameOptions options = diffusion_flame();
  options.bulge = 30e-3;  // barrel: widest at u = 0.42
  options.core_width = 0.5e-3;
  options.voxel_size = 0.5e-3;
  const FlameFields flame = make_soot_flame(options, {});
  const int k = static_cast<int>(std::lround(0.4 * options.height / options.voxel_size));
  double sum = 0;
  const FieldSampler absorption(flame.absorption);
  for (int i = -100; i <= 100; ++i) sum += static_cast<double>(absorption.at(i, 0, k));
  EXPECT_TRUE(relative(sum * options.voxel_size,
                       chord_of(options, k * options.voxel_size / options.height), 1e-4));
}

TEST(CylinderFlame, VolumeChordsAndTemperature) {
  CylinderFlameOptions options;
  options.voxel_size = 3e-3;  // 80 mm is no multiple
  const FlameFields flame = make_cylinder_flame(options, {});
  expect_sound(flame, 273.1, 2073.2);
  EXPECT_TRUE(relative(sum_of(flame.absorption) * std::pow(options.voxel_size, 3),
                       8 * kPi * 0.08 * 0.08 * 0.3, 2e-5));
  const FieldSampler absorption(flame.absorption), temperature(flame.temperature);
  double along_x = 0, along_z = 0;
  for (int i = -60; i <= 120; ++i) {
    along_x += static_cast<double>(absorption.at(i, 0, 50));
    along_z += static_cast<double>(absorption.at(5, 5, i));
  }
  EXPECT_TRUE(relative(along_x * options.voxel_size, 8 * 0.16, 1e-3));  // mean over a voxel's width
  EXPECT_TRUE(relative(along_z * options.voxel_size, 8 * 0.3, 1e-6));
  // Printed formula with r, z in mm, argument scaled to 0 .. pi: T(30, 60 mm).
  const double argument = kPi / 450 * (30.0 * 30.0 / (2 * 80.0 * 80.0 / 300) + 60);
  EXPECT_TRUE(relative(static_cast<double>(temperature.at(10, 0, 20)),
                       1800 * std::sin(argument) + 273.15, 1e-7));
  EXPECT_TRUE(relative(static_cast<double>(temperature.at(0, 10, 20)),
                       1800 * std::sin(argument) + 273.15, 1e-7));
}

TEST(TurbulentFlame, SeededAndSameForAnyNumberOfThreads) {
  TurbulentFlameOptions options;
  options.voxel_size = 4e-3;
  options.smallest_scale = 8e-3;
  Execution one, three;
  one.threads = 1;
  three.threads = 3;
  const FlameFields a = make_turbulent_flame(options, one),
                    b = make_turbulent_flame(options, three);
  EXPECT_EQ(a.absorption.brick_origins, b.absorption.brick_origins);
  EXPECT_EQ(a.absorption.values, b.absorption.values);
  EXPECT_EQ(a.temperature.values, b.temperature.values);
  expect_sound(a, kAmbientTemperature, 2000);
  options.seed = 2;
  EXPECT_NE(make_turbulent_flame(options, one).absorption.values, a.absorption.values);
}

TEST(TurbulentFlame, LaminarWithoutIntensity) {
  TurbulentFlameOptions options;
  options.voxel_size = 4e-3;
  options.intensity = 0;
  const FlameFields flame = make_turbulent_flame(options, {});
  const FieldSampler absorption(flame.absorption);
  // Symmetric about the axis, and soot peaks at 40 1/m.
  for (int i = 0; i < 10; ++i)
    for (int k = 0; k < 50; ++k) {
      EXPECT_EQ(absorption.at(i, 3, k), absorption.at(-i, 3, k));
      EXPECT_EQ(absorption.at(i, 3, k), absorption.at(3, i, k));
    }
  const float densest =
      *std::max_element(flame.absorption.values.begin(), flame.absorption.values.end());
  EXPECT_LE(densest, 40.0f);
  EXPECT_GT(densest, 39.0f);
}

/// Fluctuations between neighbours at distance d, of a field that has them on all scales, grow
/// with d; a field of one scale saturates. RMS differences of temperature over 2 and 8 voxels.
TEST(TurbulentFlame, HasManyScales) {
  TurbulentFlameOptions options;
  options.voxel_size = 1.5e-3;
  options.height = 150e-3;
  const auto growth = [&](double smallest) {
    options.smallest_scale = smallest;
    const FlameFields flame = make_turbulent_flame(options, {});
    const FieldSampler temperature(flame.temperature);
    double near = 0, far = 0;
    for (int i = -4; i <= 4; ++i)
      for (int j = -4; j <= 4; ++j)
        for (int k = 20; k < 60; ++k) {
          const auto at = [&](int d) { return static_cast<double>(temperature.at(i, j, k + d)); };
          near += std::pow(at(2) - at(0), 2);
          far += std::pow(at(8) - at(0), 2);
        }
    return std::sqrt(far / near);
  };
  const double many = growth(3e-3), one = growth(40e-3);
  EXPECT_LT(many, 3.2);  // smooth: 4
  EXPECT_GT(many, 1.2);  // white: 1
  EXPECT_GT(one, many);
}

TEST(FlameLibrary, RefusesImpossibleOptions) {
  SootFlameOptions soot;
  soot.peak_position = 1;
  EXPECT_TRUE(contains(message_of<InputError>([&] { make_soot_flame(soot, {}); }),
                       "peak position must be between 0 and 1"));
  soot = {};
  soot.rim_temperature = std::nan("");
  EXPECT_TRUE(contains(message_of<InputError>([&] { make_soot_flame(soot, {}); }), "temperature"));
  CylinderFlameOptions cylinder;
  cylinder.radius = -1;
  EXPECT_TRUE(
      contains(message_of<InputError>([&] { make_cylinder_flame(cylinder, {}); }), "radius"));
  TurbulentFlameOptions turbulent;
  turbulent.smallest_scale = 0;
  EXPECT_TRUE(contains(message_of<InputError>([&] { make_turbulent_flame(turbulent, {}); }),
                       "smallest scale"));
  turbulent = {};
  turbulent.voxel_size = 1e-6;
  EXPECT_TRUE(contains(message_of<InputError>([&] { make_turbulent_flame(turbulent, {}); }),
                       "choose a larger one"));
}

TEST(FlameLibrary, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  Execution execution;
  execution.stop = source.get_token();
  EXPECT_THROW(make_layered_flame({}, execution), Cancelled);
}

}  // namespace
}  // namespace plenoflame::flame_library_test
