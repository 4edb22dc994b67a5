// Single precision, the fitted source functions, steep cells, and rays that should not exist.
#include <gtest/gtest.h>

#include <limits>

#include "media/source_fit.h"
#include "voxel_fixture.h"

namespace plenoflame::test::voxel_precision_test {
namespace {

double value_of(const voxel::SourceFit& fit, double temperature) {
  const double v = 1 / temperature - 1 / fit.hottest;
  const bool beyond = !fit.far_terms.empty() && v > fit.split;
  const double u = beyond ? v - fit.split : v;
  double p = 0;
  for (const double term : beyond ? fit.far_terms : fit.terms) p = p * u + term;
  const double e = std::exp((beyond ? fit.at_split : 0) + u * p);
  return fit.highest * (1 - fit.occupation) * e / (1 - fit.occupation * e);
}

// Fails when `occupation` is left out of the fit, or a term is dropped.
TEST(SourceFit, MatchesTheBandAtEveryTemperature) {
  int fitted = 0;
  for (const double wavelength : {431e-9, 650e-9, 1.6e-6, 4e-6})
    for (const double width : {1e-9, 10e-9, 100e-9})
      for (const double coldest : {0.0, 300.0, 1000.0})
        for (const double hottest : {1200.0, 1900.0, 3500.0}) {
          const SourceFunction source = SourceFunction::band(wavelength, width);
          const voxel::SourceFit fit = voxel::fit_source(source, coldest, hottest, 1e-7, 12, 10);
          if (fit.terms.empty()) continue;
          ++fitted;
          for (double t = fit.coldest; t <= hottest; t += 7.3) {
            const double value = value_of(fit, t);
            const double fall = std::log(fit.highest / source(t));
            EXPECT_TRUE(relative(value, source(t), 1.5e-7 * (1 + fall)))
                << wavelength << " " << width << " " << t;
          }
        }
  EXPECT_GT(fitted, 80);  // of 108; the others keep their quadrature nodes
}

// Wide responses of several lobes: two polynomials. Fails when the second one is left out.
TEST(SourceFit, TwoPolynomialsForWideResponses) {
  int in_two = 0;
  for (const char* name :
       {"cie_x", "cie_y", "cie_z", "nikon_d5100_red", "nikon_d5100_green", "nikon_d5100_blue"})
    for (const double hottest : {1600.0, 1900.0, 2500.0}) {
      const SourceFunction source = SourceFunction::of(SpectralResponse::named(name));
      const voxel::SourceFit fit = voxel::fit_source(source, 0, hottest, 1e-7, 12, 10);
      ASSERT_FALSE(fit.terms.empty()) << name << " " << hottest;
      in_two += fit.far_terms.empty() ? 0 : 1;
      for (double t = fit.coldest; t <= hottest; t += 7.3) {
        const double value = value_of(fit, t);
        const double fall = std::log(fit.highest / source(t));
        EXPECT_TRUE(relative(value, source(t), 2e-7 * (1 + fall))) << name << " " << t;
      }
    }
  EXPECT_GT(in_two, 12);  // of 18
}

TEST(SourceFit, OneTemperatureAndNone) {
  const SourceFunction band = SourceFunction::band(650e-9, 10e-9);
  const voxel::SourceFit one = voxel::fit_source(band, 1500, 1500, 1e-7, 12, 10);
  EXPECT_EQ(one.terms.size(), 1u);
  EXPECT_EQ(one.highest, band(1500));
  EXPECT_TRUE(voxel::fit_source(SourceFunction::total(), 300, 1500, 1e-7, 12, 10).terms.empty());
  EXPECT_TRUE(voxel::fit_source(band, 0, 0, 1e-7, 12, 10).terms.empty());
}

// Fails when no cell is cut.
// A wall of 1900 K and 20 1/m in air of 300 K: the source function rises by e^60 across one cell.
std::unique_ptr<Medium> wall(double tolerance, std::vector<SourceFunction> channels) {
  const auto transform = scaled(0.25e-3);
  return make_voxel_medium(
      make_field(
          {8, 0, 0}, {40, 24, 24}, [](int, int, int) { return 1900.0f; }, transform, 300),
      make_field(
          {8, 0, 0}, {40, 24, 24}, [](int, int, int) { return 20.0f; }, transform),
      VoxelInterpolation::trilinear, std::move(channels), {tolerance});
}

TEST(VoxelPrecision, SteepCellsAreCut) {
  const auto transform = scaled(0.25e-3);
  const auto t = make_field(
      {8, 0, 0}, {40, 24, 24}, [](int, int, int) { return 1900.0f; }, transform, 300);
  const auto k = make_field(
      {8, 0, 0}, {40, 24, 24}, [](int, int, int) { return 20.0f; }, transform);
  const std::vector<SourceFunction> line{SourceFunction::band(650e-9, 1e-12)};
  std::vector<Ray> rays;
  for (int r = 0; r < 5; ++r)
    rays.push_back({{-0.01, 2.1e-3 + 0.3e-3 * r, 3.3e-3}, normalize(Vec3{1, 0.1 * r, 0.05})});
  double errors[3], cells[3];
  const double tolerances[3] = {0, VoxelMediumOptions{}.tolerance, 1e-6};
  for (int n = 0; n < 3; ++n) {
    const auto medium = wall(tolerances[n], line);
    const Seen seen = see<double>(*medium, rays, with(Isa::baseline));
    errors[n] = 0;
    cells[n] = seen.counters.cells;
    for (std::size_t r = 0; r < rays.size(); ++r) {
      const auto exact = integrate_voxels({t, k, VoxelInterpolation::trilinear}, rays[r], {0, 0.1},
                                          line_source(650e-9, 1e-12));
      errors[n] = std::max(errors[n], std::fabs(seen.radiance[0][r] / double(exact.radiance) - 1));
    }
  }
  EXPECT_GT(errors[0], 3e-4);  // what two nodes make of such a cell
  EXPECT_LT(errors[1], 1e-4);
  EXPECT_LT(errors[2], 2e-6);
  EXPECT_LT(cells[0], cells[1]);
  EXPECT_LT(cells[1], cells[2]);
}

TEST(VoxelPrecision, EveryInstructionSetAgreesWithDouble) {
  // Random smooth waves; 512 rays in one batch, several channels, each held to its own largest
  // radiance: 5e-6 is 40 roundings of single precision, over about 60 intervals.
  const auto transform = scaled(0.5e-3, {0.3, -0.2, 0.1});
  const auto wave = [](int i, int j, int k) {
    return std::sin(0.31 * i + 1) * std::sin(0.27 * j) * std::cos(0.23 * k);
  };
  const auto medium = make_voxel_medium(
      make_field(
          {0, 0, 0}, {48, 48, 48},
          [&](int i, int j, int k) { return float(1500 + 300 * wave(i, j, k)); }, transform, 300),
      make_field(
          {0, 0, 0}, {48, 48, 48},
          [&](int i, int j, int k) {
            const double w = wave(j, k, i);
            return w < 0 ? 0.0f : float(150 * w);
          },
          transform),
      VoxelInterpolation::trilinear,
      {SourceFunction::total(), SourceFunction::band(650e-9, 10e-9),
       SourceFunction::band(431e-9, 200e-9), SourceFunction::band(4e-6, 0.4e-6),
       SourceFunction::of(SpectralResponse::named("cie_x")),
       SourceFunction::of(SpectralResponse::named("nikon_d5100_blue"))});
  std::mt19937 random(77);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Vec3 anchor = transform.point({24, 24, 24});
  std::vector<Ray> rays;
  for (int r = 0; r < 512; ++r) {
    const Vec3 a = transform.point({48 * uniform(random), 48 * uniform(random), 0});
    const Vec3 b = transform.point({48 * uniform(random), 48 * uniform(random), 48});
    const Vec3 d = normalize(r % 2 ? b - a : a - b);
    rays.push_back({a - 0.5 * d, d});
  }
  const Seen exact = see<double>(*medium, rays, with(Isa::baseline), 0, 2, anchor);
  for (const Isa isa : supported_isas()) {
    const Seen single = see<float>(*medium, rays, with(isa), 0, 2, anchor);
    for (int c = 0; c < medium->channel_count(); ++c) {
      const double largest = *std::max_element(exact.radiance[c].begin(), exact.radiance[c].end());
      ASSERT_GT(largest, 0);
      for (std::size_t r = 0; r < rays.size(); ++r)
        EXPECT_TRUE(within(single.radiance[c][r], exact.radiance[c][r], 5e-6, largest))
            << name(isa) << " channel " << c;
    }
    for (std::size_t r = 0; r < rays.size(); ++r)
      EXPECT_TRUE(within(single.transmittance[r], exact.transmittance[r], 3e-6, 1));
  }
}

TEST(VoxelPrecision, ManyChannelsAreIndependent) {
  std::vector<SourceFunction> channels;
  for (int c = 0; c < 35; ++c)
    channels.push_back(c % 3 ? SourceFunction::band((400 + 10 * c) * 1e-9, 5e-9)
                             : SourceFunction::total());
  // Without cutting, every channel takes the same intervals: the same bits.
  const auto all = wall(0, channels);
  std::vector<Ray> rays;
  for (int r = 0; r < 16; ++r)
    rays.push_back({{-0.01, 1e-3 + 0.2e-3 * r, 3.3e-3}, normalize(Vec3{1, 0.02 * r, 0.05})});
  const Seen together = see<double>(*all, rays, with(Isa::baseline));
  for (const int c : {0, 15, 16, 34}) {
    const auto one = wall(0, {channels[c]});
    const Seen alone = see<double>(*one, rays, with(Isa::baseline));
    EXPECT_GT(alone.radiance[0][0], 0);
    EXPECT_EQ(together.radiance[c], alone.radiance[0]) << c;
  }
}

TEST(VoxelPrecision, NoInputMakesNonsense) {
  const auto medium = wall(1e-4, {SourceFunction::total(), SourceFunction::band(650e-9, 10e-9)});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const float odd[] = {0.0f, -0.0f, nan, infinity, -infinity, 1e-40f, 3e38f, -3e38f, 1.0f, 3e-3f};
  std::mt19937 random(5);
  for (const Isa isa : supported_isas())
    for (int trial = 0; trial < 400; ++trial) {
      alignas(64) float columns[8][16];
      for (auto& column : columns)
        for (float& value : column) value = odd[random() % std::size(odd)];
      RayBatch<float> batch;
      batch.size = 16;
      batch.x = columns[0];
      batch.y = columns[1];
      batch.z = columns[2];
      batch.dx = columns[3];
      batch.dy = columns[4];
      batch.dz = columns[5];
      batch.t_near = columns[6];
      batch.t_far = columns[7];
      float radiance[32], transmittance[16];
      MediumCounters counters;
      medium->integrate(batch, with(isa, trial % 2), {radiance, 16, transmittance}, counters);
      for (const float l : radiance) EXPECT_TRUE(l >= 0 && l <= 1.0001 * medium->source(0, 1900));
      for (const float t : transmittance) EXPECT_TRUE(t >= 0 && t <= 1);
    }
}

}  // namespace
}  // namespace plenoflame::test::voxel_precision_test
