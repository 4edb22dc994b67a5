// From a scene's emission lines to what its channels see, and the ground truth of it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>

#include "core/media_voxel/voxel_fixture.h"
#include "plenoflame/media/voxel_medium.h"
#include "plenoflame/optics/glass.h"
#include "plenoflame/render/ground_truth.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/spectral.h"
#include "support/approx.h"

namespace plenoflame::test::line_emission_test {
namespace {

constexpr double kDepth = 24e-3, kEmission = 50, kAbsorption = 40;

/// A block of 24 mm depth and 40 mm sides around (1 m, 0, 0), cold, with every line of the flame
/// [W/(m^3 sr)].
MediumLoader block(double absorption = kAbsorption) {
  return [absorption](const FlameSpec& flame, const std::string&,
                      const std::vector<SourceFunction>& channels, const Execution&) {
    const AffineTransform map = scaled(1e-3, {1 - 11.5e-3, -19.5e-3, -19.5e-3});
    const auto field = [&](double value, float background) {
      return make_field(
          {0, 0, 0}, {24, 40, 40}, [=](int, int, int) { return static_cast<float>(value); }, map,
          background);
    };
    VoxelMediumOptions options;
    options.absorption_factors = absorption_factors(flame.spectrum, channels);
    options.extras.lines.assign(flame.lines.size(), field(kEmission, 0));
    options.extras.line_weights = line_weights(flame, channels);
    return make_voxel_medium(field(300, 300), field(absorption, 0), VoxelInterpolation::constant,
                             channels, options);
  };
}

Scene scene_of(std::vector<LineSpec> lines) {
  Scene scene;
  scene.camera.lens.model = LensModel::ideal;
  scene.camera.lens.focal_length = 0.1;
  scene.camera.lens.diameter = 0.02;
  scene.camera.sensor = {9, 9, 20e-6};
  scene.camera.focus.object_distance = 1;
  scene.camera.focus.conjugate = "sensor";
  FlameSpec flame;
  flame.kind = FlameKind::vdb;
  flame.file = "block.vdb";
  flame.lines = std::move(lines);
  scene.flames = {flame};
  scene.channels = {{"near", ChannelKind::band, 500e-9, 20e-9},
                    {"far", ChannelKind::band, 650e-9, 20e-9},
                    {"slope", ChannelKind::curve, 0, 0, "", "", "400 nm 0, 600 nm 1"},
                    {"all"}};
  return scene;
}

/// Radiance of each channel along the axis.
std::vector<double> seen(const CompiledScene& scene) {
  const Seen nodes =
      see<double>(*scene.medium, {{{0, 0, 0}, {1, 0, 0}}}, with(Isa::baseline), 0, 10);
  std::vector<double> sums(scene.scene.channels.size());
  for (std::size_t n = 0; n < nodes.radiance.size(); ++n)
    sums[scene.mix.empty() ? n
                           : static_cast<std::size_t>(scene.mix.channel_of(static_cast<int>(n)))] +=
        nodes.radiance[n][0];
  return sums;
}

double out_of(double absorption) {
  return kEmission * -std::expm1(-absorption * kDepth) / absorption;
}

// Grey: every channel sees its response at the line, all wavelengths see all of it. Fails when the
// response is taken at the channel's centroid.
TEST(LineEmission, ChannelsWeighTheLine) {
  const CompiledScene scene = compile(scene_of({{LineKind::custom, 505e-9, 0, {"g"}}}), block());
  EXPECT_TRUE(scene.mix.empty());  // no wavelength more
  const std::vector<double> sums = seen(scene);
  const double full = out_of(kAbsorption), heat = 1e-9;
  EXPECT_TRUE(relative(sums[0], full, 1e-7));
  EXPECT_LT(sums[1], heat * full);
  EXPECT_TRUE(relative(sums[2], full * 105 / 200, 1e-7));
  // A body of 300 K in front of 147 W/(m^2 sr) of its own.
  const double cold = -std::expm1(-kAbsorption * kDepth) * SourceFunction::total()(300);
  EXPECT_TRUE(relative(sums[3], full + cold, 1e-7));
}

// Soot-like absorption: the line's light is absorbed as at its own wavelength in every channel.
// Fails when it travels with the channel's centroid.
TEST(LineEmission, AbsorbedAtItsOwnWavelength) {
  Scene plain = scene_of({{LineKind::custom, 505e-9, 0, {"g"}}, {LineKind::na_d, 0, 0, {"n"}}});
  plain.flames[0].spectrum = {SpectrumKind::power, 600e-9, 1.3};
  plain.channels.pop_back();
  const CompiledScene scene = compile(plain, block());
  const std::vector<double> sums = seen(scene);
  const auto line = [](double wavelength) {
    return out_of(kAbsorption * std::pow(600e-9 / wavelength, 1.3));
  };
  // Mean of both sodium lines.
  const double sodium = (2 * 589.1583e-9 + 589.7558e-9) / 3;
  EXPECT_TRUE(relative(sums[0], line(505e-9), 1e-7));
  EXPECT_TRUE(relative(sums[2], line(505e-9) * 0.525 + line(sodium) * (sodium / 200e-9 - 2), 1e-7));
}

// Behind a filter, and as a quantum efficiency, in the units that `develop` counts electrons in.
TEST(LineEmission, FilterAndPhotons) {
  Scene filtered = scene_of({{LineKind::custom, 505e-9, 0, {"g"}}});
  filtered.camera.transmission.filter = "400 nm 1, 600 nm 0";
  filtered.channels.resize(1);
  EXPECT_TRUE(relative(seen(compile(filtered, block()))[0], out_of(kAbsorption) * 0.475, 1e-7));
  Scene counted = scene_of({{LineKind::custom, 505e-9, 0, {"g"}}});
  counted.channels = {{"q", ChannelKind::curve, 0, 0, "", "", "400 nm 0.2, 700 nm 0.8", true}};
  // Flux times centroid / (hc) are the electrons: R lambda_line / (hc).
  const double centroid = (0.2 * 550 * 300 + 0.002 * 300 * 300 / 2 * 600) / (0.5 * 300);
  EXPECT_TRUE(relative(seen(compile(counted, block()))[0],
                       out_of(kAbsorption) * (0.2 + 0.002 * 105) * 505 / centroid, 1e-6));
}

// A camera that disperses has one for each wavelength, of which the line is one; the flame is
// loaded once for all of them. Fails when parts load it anew, or take another channel's.
TEST(LineEmission, DispersiveScenesLoadAFlameOnce) {
  Scene scene = scene_of({{LineKind::custom, 505e-9, 0, {"g"}}});
  scene.camera.lens = {};
  scene.camera.lens.surfaces = {{0.1, 0.005, 1.5, 0.02, true}, {-0.1, 0, 1, 0.02, false}};
  scene.camera.lens.surfaces[0].glass = "N-SF11";
  scene.flames[0].spectrum = {SpectrumKind::power, 600e-9, 1.3};
  scene.channels = {{"near", ChannelKind::band, 505e-9, 2e-9},
                    {"far", ChannelKind::band, 650e-9, 2e-9}};
  int loads = 0;
  const MediumLoader loader = block();
  const CompiledScene compiled =
      compile(scene, [&](const FlameSpec& flame, const std::string& folder,
                         const std::vector<SourceFunction>& channels, const Execution& execution) {
        ++loads;
        return loader(flame, folder, channels, execution);
      });
  EXPECT_EQ(loads, 1);
  ASSERT_EQ(compiled.paths().size(), 3u);
  ASSERT_EQ(compiled.mix.nodes(), 3);
  for (int n = 0; n < 3; ++n) EXPECT_EQ(compiled.mix.channel_of(n), n == 2 ? 1 : 0);
  const std::vector<Ray> axis{{{0, 0, 0}, {1, 0, 0}}};
  const Seen whole = see<double>(*compiled.medium, axis, with(Isa::baseline), 0, 10);
  for (std::size_t n = 0; n < 3; ++n) {
    const CompiledScene& part = compiled.paths()[n];
    ASSERT_EQ(part.medium->channel_count(), 1);
    const Seen alone = see<double>(*part.medium, axis, with(Isa::baseline), 0, 10);
    EXPECT_TRUE(relative(alone.radiance[0][0], whole.radiance[n][0], 1e-14)) << n;
  }
  // The line's camera has the index at the line.
  EXPECT_TRUE(relative(compiled.paths()[1].camera.spec().lens.surfaces[0].index,
                       Glass("N-SF11").index(505e-9), 1e-12));
}

// The picture of an evenly glowing block, without absorption: eps L in every pixel that looks
// through both of its faces, and where it is along the axis.
TEST(LineEmission, RenderedAndItsTruth) {
  Scene scene = scene_of({{LineKind::custom, 505e-9, 0, {"g"}}});
  scene.channels.resize(1);
  const CompiledScene compiled = compile(scene, block(0));
  RenderSettings settings;
  settings.samples = 64;
  LightField field = render(compiled, settings).light_field;
  const double thin = kEmission * kDepth;
  add_ground_truth(compiled, field, {});
  EXPECT_EQ(field.layers.at(truth::kOpticalDepth).at(4, 4), 0);
  EXPECT_TRUE(relative(field.layers.at(truth::kDistance).at(4, 4), 1, 1e-5));
  EXPECT_TRUE(relative(field.layers.at(truth::kFirstHit).at(4, 4), 1 - 12e-3, 1e-5));
  EXPECT_TRUE(relative(field.layers.at(truth::kLastHit).at(4, 4), 1 + 12e-3, 1e-5));
  // On the axis a pixel gets L A pi sin^2 of an ideal lens' cone, to the second order in the
  // f-number's inverse; the ray's length in the block differs by as little.
  const double image = 1 / (1 / 0.1 - 1 / 1.0), half = 0.01 / image;
  const double expected = thin * 20e-6 * 20e-6 * 3.14159265358979 * half * half;
  EXPECT_TRUE(relative(field.channels[0].flux.at(4, 4), expected, 0.02));
}

}  // namespace
}  // namespace plenoflame::test::line_emission_test
