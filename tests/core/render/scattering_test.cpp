#include <cmath>
#include <numeric>

#include "core/media_voxel/voxel_fixture.h"
#include "core/render/isothermal.h"
#include "plenoflame/media/layered_medium.h"
#include "plenoflame/media/voxel_medium.h"
#include "plenoflame/scene/spectral.h"
#include "render/transport/phase_function.h"
#include "render/transport/scatter_walk.h"
#include "sampling/directions.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"
#include "support/tally.h"

namespace plenoflame::scattering_test {
namespace {

using test::relative;
using test::within_standard_errors;

ScatteringSpec henyey_greenstein(double albedo, double g) {
  return {albedo, PhaseFunction::henyey_greenstein, g};
}
const ScatteringSpec kRayleigh{0.5, PhaseFunction::rayleigh, 0};

TEST(Scattering, PhaseFunctionsAreNormalisedAndDrawn) {
  for (const ScatteringSpec& spec :
       {henyey_greenstein(1, 0), henyey_greenstein(1, 1e-4), henyey_greenstein(1, 0.75),
        henyey_greenstein(1, -0.4), kRayleigh}) {
    // Simpson's rule over the cosine.
    const int n = 20000;
    double sum = 0, mean = 0, square = 0;
    for (int i = 0; i <= n; ++i) {
      const double c = -1 + 2.0 * i / n, w = i == 0 || i == n ? 1 : i % 2 ? 4 : 2;
      const double p = w * phase_function(spec, c) * 2 * 3.14159265358979323846 * 2 / n / 3;
      sum += p;
      mean += c * p;
      square += c * c * p;
    }
    EXPECT_TRUE(relative(sum, 1, 1e-9));
    const double g = spec.phase == PhaseFunction::rayleigh ? 0 : spec.asymmetry;
    EXPECT_TRUE(test::within(mean, g, 1e-9, 1));
    double drawn = 0, drawn_square = 0;
    for (int i = 0; i < n; ++i) {
      const double c = draw_cosine(spec, (i + 0.5) / n);
      drawn += c / n;
      drawn_square += c * c / n;
    }
    EXPECT_TRUE(test::within(drawn, mean, 1e-6, 1));
    EXPECT_TRUE(test::within(drawn_square, square, 1e-6, 1));
  }
}

// A slab with mu_a = 10/cm, mu_s = 90/cm, g = 0.75, 0.02 cm thick, lit at right angles: van de
// Hulst, Multiple Light Scattering (1980), table 35: diffuse reflection 0.09739, transmission
// 0.66096 in all.
TEST(Scattering, VanDeHulstSlab) {
  CameraSpec camera;
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = 0.05;
  camera.lens.diameter = 0.01;
  camera.sensor = {2, 2, 1e-3};
  camera.focus.object_distance = 1;
  camera.focus.conjugate = "sensor";
  // An ellipsoid so flat that it is a slab around its middle.
  CompiledScene scene = test::scene_of(
      camera,
      make_layered_medium({{{}, {1, 1, 1e-4}, 1, 1e4}}, {}, {SourceFunction::band(650e-9, 10e-9)}));
  scene.scatterers = {{scene.medium.get(), henyey_greenstein(0.9, 0.75)}};
  DeltaLight sun;
  sun.parallel = true;
  sun.direction = {0, 0, -1};
  sun.strength = {1};
  scene.lights.delta = {sun};
  const ScatterPlan plan(scene, {}, {});
  ScatterWalk walk(plan);
  MediumCounters counters;
  constexpr int kRays = 60000, kBatch = 500;
  const double pi = 3.14159265358979323846;
  for (const bool reflected : {true, false}) {
    test::Tally mean;
    for (int first = 0; first < kRays; first += kBatch) {
      std::vector<ScatterWalk::Start> starts;
      for (int i = 0; i < kBatch; ++i) {
        NoiseStream noise(reflected ? 5 : 6, static_cast<std::uint64_t>(first + i));
        // Light that leaves in a direction of Lambert's law is looked for against it.
        const Vec3 out =
            cosine_direction({0, 0, reflected ? 1.0 : -1.0}, noise.uniform(), noise.uniform());
        starts.push_back(
            {i, {{0, 0, 0}, -out}, static_cast<std::uint64_t>(first + i) * 2 + reflected});
      }
      std::vector<std::vector<double>> radiance(1, std::vector<double>(kBatch));
      walk.add(starts, radiance, counters);
      for (const double l : radiance[0]) mean.add(pi * l);
    }
    const double expected = reflected ? 0.09739 : 0.66096 - std::exp(-2.0);
    EXPECT_LT(mean.error(), 0.015 * expected);
    EXPECT_TRUE(within_standard_errors(mean.value(), expected, mean.error(), 4)) << reflected;
  }
  // A stretch that begins behind the slab. Fails if its line counts in front of its begin, too.
  std::vector<ScatterWalk::Start> beyond;
  for (int i = 0; i < kBatch; ++i)
    beyond.push_back({i, {{0, 0, 1}, {0, 0, 1}}, static_cast<std::uint64_t>(i), kInfinity, 0.5, 0});
  std::vector<std::vector<double>> radiance(1, std::vector<double>(kBatch));
  walk.add(beyond, radiance, counters);
  EXPECT_EQ(std::accumulate(radiance[0].begin(), radiance[0].end(), 0.0), 0);
}

/// A scene that shines on itself from everywhere like a body of 1700 K, with flames of 1700 K: its
/// picture is that of the surroundings alone.
void expect_invisible(const Scene& scene, const CompiledScene& with, const std::string& what) {
  ASSERT_EQ(with.scatterers.size(), 1u);
  test::expect_isothermal(scene, with, 256, 1700, what);
}

// Nothing tells a body from its surroundings of the same temperature, whatever it scatters.
TEST(Scattering, ClosedIsothermalSurroundings) {
  for (const ScatteringSpec& spec :
       {henyey_greenstein(0.2, 0), henyey_greenstein(0.9, 0.6), kRayleigh}) {
    Scene scene = test::bare_flame(6, 4, 2e-3);
    scene.channels = {{"red", ChannelKind::band, 650e-9, 10e-9},
                      {"blue", ChannelKind::band, 450e-9, 80e-9}};
    for (EllipsoidSpec& layer : scene.flames[0].layers) layer.temperature = 1700;
    scene.flames[0].scattering = spec;
    scene.flames[0].spectrum.kind = SpectrumKind::power;
    const CompiledScene with = [&] {
      CompiledScene compiled = compile(scene);
      compiled.lights.environment.clear();
      // The radiance of a black body in every node of the channels.
      for (int n = 0; n < compiled.node_count(); ++n)
        compiled.lights.environment.push_back(compiled.medium->source(n, 1700) / (1 - spec.albedo));
      return compiled;
    }();
    expect_invisible(scene, with, std::to_string(spec.albedo));
  }
}

// The same of a flame of voxels whose albedo is another in each of them. Fails when walks take a
// constant, or when the emission is not that of the absorption.
TEST(Scattering, ClosedIsothermalSurroundingsWithAGridOfAlbedos) {
  Scene scene = test::bare_flame(6, 4, 2e-3);
  scene.channels = {{"red", ChannelKind::band, 650e-9, 10e-9},
                    {"blue", ChannelKind::band, 450e-9, 80e-9}};
  FlameSpec& flame = scene.flames[0];
  flame.kind = FlameKind::vdb;
  flame.file = "grid.vdb";
  flame.layers.clear();
  flame.spectrum.kind = SpectrumKind::power;
  flame.scattering.asymmetry = 0.4;
  flame.scattering.grid = "omega";
  CompiledScene with = compile(scene, [](const FlameSpec& spec, const std::string&,
                                         const std::vector<SourceFunction>& channels,
                                         const Execution&) {
    const auto field = [](auto value, float background) {
      return test::make_field({0, 0, 0}, {24, 24, 40}, value,
                              test::scaled(1e-3, {0.988, -0.012, -0.02}), background);
    };
    VoxelMediumOptions options;
    options.absorption_factors = absorption_factors(spec.spectrum, channels);
    options.extras.albedo = field(
        [](int i, int j, int k) { return 0.15f * static_cast<float>((i + 2 * j + k) % 7); }, 0);
    return make_voxel_medium(
        field([](int, int, int) { return 1700.0f; }, 1700),
        field([](int i, int, int k) { return 20.0f + static_cast<float>((3 * i + k) % 40); }, 0),
        VoxelInterpolation::trilinear, channels, options);
  });
  for (int n = 0; n < with.node_count(); ++n)
    with.lights.environment.push_back(with.medium->source(n, 1700));
  expect_invisible(scene, with, "grid");
}

TEST(Scattering, DoesNotDependOnThreadsAndNotOnTheWindow) {
  Scene scene = test::bare_flame(70, 3, 0.2e-3);
  scene.flames[0].scattering = henyey_greenstein(0.5, 0.3);
  const CompiledScene compiled = compile(scene);
  RenderSettings settings;
  settings.samples = 4;
  const Image one = render(compiled, settings, test::one_thread()).light_field.channels[0].flux;
  const Image three = render(compiled, settings, test::threads(3)).light_field.channels[0].flux;
  EXPECT_EQ(one.pixels, three.pixels);
  settings.window = {30, 1, 5, 1};
  const Image part = render(compiled, settings, test::one_thread()).light_field.channels[0].flux;
  for (int c = 0; c < 5; ++c) EXPECT_EQ(part.at(c, 0), one.at(30 + c, 1));
}

}  // namespace
}  // namespace plenoflame::scattering_test
