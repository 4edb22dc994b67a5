#include "plenoflame/radiometry/spectral_nodes.h"

#include <cmath>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::spectral_nodes_test {
namespace {

using test::relative;

// E(m) of published indices, mpmath; Dalzell and Sarofim's own values and those of the fit.
TEST(SootIndex, AbsorptionFunctions) {
  EXPECT_TRUE(relative(soot_absorption_function({1.57, -0.56}), 0.259539086636, 1e-11));
  EXPECT_TRUE(relative(soot_absorption_function({1.57, -0.46}), 0.21476095212, 1e-10));
  EXPECT_TRUE(relative(soot_absorption_function({1.75, -1.03}), 0.372817549335, 1e-11));
  const auto e = [](double nm) {
    return soot_absorption_function(soot_refractive_index(SootIndex::chang, 1e-9 * nm));
  };
  // To the three digits to which they are tabulated.
  const double table[][2] = {{450, .261}, {532, .241}, {610, .230},
                             {650, .226}, {700, .223}, {850, .218}};
  for (const auto& row : table) EXPECT_TRUE(relative(e(row[0]), row[1], 3e-3)) << row[0];
  EXPECT_EQ(soot_refractive_index(SootIndex::dalzell, 650e-9), std::complex<double>(1.57, -0.44));
  EXPECT_TRUE(relative(soot_refractive_index(SootIndex::dalzell, 600e-9).real(), 1.565, 1e-14));
  EXPECT_THROW(soot_refractive_index(SootIndex::dalzell, 900e-9), InputError);
  EXPECT_THROW(soot_refractive_index(SootIndex::chang, 300e-9), InputError);
}

// 7.54 1/m and 10.73 1/m per ppm at 650 nm, 9.21 1/m at 532 nm.
TEST(AbsorptionSpectrum, SootPerVolumeFraction) {
  const auto per_ppm = [](double wavelength, double e) {
    return 1e-6 *
           AbsorptionSpectrum::soot(wavelength, SootIndex::constant, e).per_volume_fraction();
  };
  EXPECT_TRUE(relative(per_ppm(650e-9, 0.26), 7.54, 1e-3));
  EXPECT_TRUE(relative(per_ppm(650e-9, 0.37), 10.73, 1e-3));
  EXPECT_TRUE(relative(per_ppm(532e-9, 0.26), 9.21, 1e-3));
}

TEST(AbsorptionSpectrum, Factors) {
  EXPECT_EQ(AbsorptionSpectrum().factor(500e-9), 1);
  const auto power = AbsorptionSpectrum::power(650e-9, 1.39);
  EXPECT_TRUE(relative(power.factor(450e-9), std::pow(650.0 / 450, 1.39), 1e-14));
  const auto soot = AbsorptionSpectrum::soot(650e-9, SootIndex::constant, 0.3);
  EXPECT_TRUE(relative(soot.factor(450e-9), 650.0 / 450, 1e-14));
  const auto table = AbsorptionSpectrum::table(650e-9, {{500e-9, 3}, {600e-9, 1}, {700e-9, 2}});
  EXPECT_TRUE(relative(table.factor(550e-9), 2 / 1.5, 1e-13));
  EXPECT_TRUE(relative(table.factor(900e-9), 2 / 1.5, 1e-13));
  EXPECT_EQ(table.per_volume_fraction(), 0);
  EXPECT_THROW(AbsorptionSpectrum::table(500e-9, {{500e-9, 0}, {600e-9, 1}}), InputError);
}

double path(const ChannelNodes& nodes, const AbsorptionSpectrum& spectrum, double temperature,
            double depth) {
  double sum = 0;
  for (const SourceFunction& node : nodes.nodes)
    sum += node(temperature) * -std::expm1(-depth * spectrum.factor(node.wavelength()));
  return sum;
}

// The light that leaves a homogeneous path of soot, mpmath: a curve, and all wavelengths.
TEST(ChannelNodes, StandForTheirChannel) {
  const auto soot = AbsorptionSpectrum::soot(650e-9, SootIndex::constant, 0.26);
  const ChannelNodes curve = channel_nodes(
      SpectralResponse::curve({{400e-9, 0}, {450e-9, 0.5}, {600e-9, 0.25}, {700e-9, 1}}), {soot});
  EXPECT_LE(curve.error, kSpectralTolerance);
  EXPECT_LE(curve.nodes.size(), 4u);
  const double expected[][3] = {{0.5, 1200, 0.3427561956226781},
                                {0.5, 1800, 150.0424831049015},
                                {3, 1200, 0.8407598448446091},
                                {3, 1800, 361.9287270768072}};
  for (const auto& row : expected)
    EXPECT_TRUE(relative(path(curve, soot, row[1], row[0]), row[2], curve.error)) << row[1];
  double share = 0;
  for (const SourceFunction& node : curve.nodes) share += node.share();
  EXPECT_TRUE(relative(share, 1, 1e-13));

  const ChannelNodes all = channel_nodes(std::nullopt, {soot});
  EXPECT_LE(all.error, kSpectralTolerance);
  EXPECT_TRUE(relative(path(all, soot, 1200, 0.5), 3642.623132270309, all.error));
  EXPECT_TRUE(relative(path(all, soot, 2000, 0.5), 44917.52958756914, all.error));
}

// Two lines in a wide band, as a table with steep sides: a single Gauss rule misses them. mpmath.
TEST(ChannelNodes, SteepTables) {
  const auto lines = AbsorptionSpectrum::table(552e-9, {{400e-9, 0.02},
                                                        {548e-9, 0.02},
                                                        {550e-9, 1},
                                                        {556e-9, 0.9},
                                                        {558e-9, 0.02},
                                                        {620e-9, 0.05},
                                                        {624e-9, 0.6},
                                                        {700e-9, 0.6}});
  const ChannelNodes wide = channel_nodes(SpectralResponse::band(550e-9, 300e-9), {lines});
  EXPECT_LE(wide.error, kSpectralTolerance);
  const double expected[][3] = {{0.5, 1200, 0.2885404328257162},
                                {8, 1200, 1.113422451434822},
                                {0.5, 1800, 119.2306435891223},
                                {8, 1800, 476.9121952259897}};
  for (const auto& row : expected)
    EXPECT_TRUE(relative(path(wide, lines, row[1], row[0]), row[2], 2 * kSpectralTolerance))
        << row[0] << " " << row[1];
}

// The light that a wall emits through a colour that several wavelengths stand for, far below the
// temperatures for which these were chosen: 3 to 5 um, mpmath.
TEST(ChannelNodes, ColdWallsEmitTheirWholeBand) {
  const auto soot = AbsorptionSpectrum::soot(650e-9, SootIndex::constant, 0.26);
  const auto band = SpectralResponse::band(4e-6, 2e-6);
  const ChannelNodes nodes = channel_nodes(band, {soot});
  ASSERT_GT(nodes.nodes.size(), 1u);
  const auto emitters = SourceFunction::sharing(SourceFunction::of(band), nodes.nodes);
  ASSERT_EQ(emitters.size(), nodes.nodes.size());
  for (const auto& [temperature, expected] :
       {std::pair{300.0, 1.865956208161689}, std::pair{500.0, 167.527778396007}}) {
    double sum = 0, of_nodes = 0;
    for (std::size_t i = 0; i < emitters.size(); ++i) {
      sum += emitters[i](temperature);
      of_nodes += nodes.nodes[i](temperature);
      EXPECT_EQ(emitters[i].wavelength(), nodes.nodes[i].wavelength());
      EXPECT_FALSE(emitters[i].is_total());
    }
    EXPECT_TRUE(relative(sum, expected, 1e-12)) << temperature;
    if (temperature < 400) {
      EXPECT_FALSE(relative(of_nodes, expected, 1e-3));
    }
  }
  // So cold that every node underflows: still the whole.
  double sum = 0;
  for (const SourceFunction& emitter : emitters) sum += emitter(3);
  EXPECT_EQ(sum, SourceFunction::of(band)(3));
}

TEST(ChannelNodes, NarrowAndGreyChannelsNeedOne) {
  const auto soot = AbsorptionSpectrum::power(650e-9, 1);
  EXPECT_EQ(channel_nodes(SpectralResponse::band(650e-9, 10e-9), {soot}).nodes.size(), 1u);
  const ChannelNodes grey = channel_nodes(SpectralResponse::named("cie_y"), {{}});
  ASSERT_EQ(grey.nodes.size(), 1u);
  EXPECT_EQ(grey.error, 0);
  EXPECT_TRUE(channel_nodes(std::nullopt, {{}}).nodes[0].is_total());
}

double planck(double wavelength, double temperature) {
  return 1.1910429723971884e-16 / std::pow(wavelength, 5) /
         std::expm1(0.014387768775039337 / (wavelength * temperature));
}

std::vector<SpectralResponse> camera_rgb() {
  return {SpectralResponse::named("nikon_d5100_red"), SpectralResponse::named("nikon_d5100_green"),
          SpectralResponse::named("nikon_d5100_blue")};
}

// Paths of soot, seen in three wide responses, against sums over four thousand wavelengths, between
// and beyond the temperatures and depths that the search goes by.
TEST(SharedNodes, StandForAllTheirChannels) {
  const auto soot = AbsorptionSpectrum::soot(650e-9, SootIndex::constant, 0.26);
  const std::vector<SpectralResponse> rgb = camera_rgb();
  std::size_t own = 0;
  for (const SpectralResponse& response : rgb) own += channel_nodes(response, {soot}).nodes.size();
  const auto shared = shared_nodes(rgb, {soot}, static_cast<int>(own) - 1);
  ASSERT_TRUE(shared);
  EXPECT_LT(shared->nodes.size(), 0.7 * static_cast<double>(own));
  EXPECT_LE(shared->error, kSpectralTolerance);
  ASSERT_EQ(shared->mix.nodes(), static_cast<int>(shared->nodes.size()));
  constexpr int kSteps = 4000;
  for (int c = 0; c < 3; ++c) {
    for (const double temperature : {1100.0, 1500.0, 1850.0, 2500.0})
      for (const double depth : {0.02, 0.7, 2.0, 8.0}) {
        double expected = 0, seen = 0;
        for (int i = 0; i < kSteps; ++i) {
          const double w = 400e-9 + 320e-9 * (i + 0.5) / kSteps;
          expected += 320e-9 / kSteps * rgb[static_cast<std::size_t>(c)](w) *
                      planck(w, temperature) * -std::expm1(-depth * 650e-9 / w);
        }
        for (int n = 0; n < shared->mix.nodes(); ++n) {
          const SourceFunction& node = shared->nodes[static_cast<std::size_t>(n)];
          seen += shared->mix.weight(c, n) * node(temperature) *
                  -std::expm1(-depth * soot.factor(node.wavelength()));
        }
        EXPECT_TRUE(relative(seen, expected, kSpectralTolerance)) << c << " " << temperature;
      }
    // A node far too cold for the rule is inexact, but light all the same.
    for (int n = 0; n < shared->mix.nodes(); ++n) EXPECT_GE(shared->mix.weight(c, n), 0) << c << n;
  }
  // The node that stands for the first channel alone is in the middle of it.
  for (int n = 1; n < shared->mix.nodes(); ++n)
    EXPECT_GE(shared->mix.weight(0, 0) * shared->nodes[0](1700),
              shared->mix.weight(0, n) * shared->nodes[static_cast<std::size_t>(n)](1700));
}

TEST(SharedNodes, NoneWhereTheyAreNotFewer) {
  const auto soot = AbsorptionSpectrum::soot(650e-9, SootIndex::constant, 0.26);
  EXPECT_FALSE(shared_nodes(camera_rgb(), {soot}, 5));
  EXPECT_FALSE(
      shared_nodes({SpectralResponse::band(450e-9, 10e-9), SpectralResponse::band(550e-9, 10e-9),
                    SpectralResponse::band(650e-9, 10e-9)},
                   {soot}, 2));
}

}  // namespace
}  // namespace plenoflame::spectral_nodes_test
