// Walks in media whose extinction differs from node to node: each node must get what it would get
// if it were the only one, and with about as little noise.
#include <gtest/gtest.h>

#include <cmath>

#include "core/render/scattered_light.h"
#include "sampling/directions.h"
#include "support/approx.h"

namespace plenoflame::test::coloured_smoke_test {
namespace {

constexpr double kPi = 3.14159265358979323846;

constexpr double kReflected = 0.09739, kTransmitted = 0.66096;

/// The slab of scattering_test (van de Hulst, Multiple Light Scattering, 1980, table 35: mu_a =
/// 10/cm, mu_s = 90/cm, g = 0.75, 0.02 cm thick) where the factors of its media are together 1,
/// under parallel light. An ellipsoid so flat is a slab around its middle.
CompiledScene slab(const std::vector<std::vector<double>>& factors) {
  CompiledScene scene = lit_scene({}, {});
  scene.surfaces = nullptr;
  scene.scene.channels.resize(3);
  std::vector<std::shared_ptr<const Medium>> media;
  for (const std::vector<double>& of_one : factors) {
    media.push_back(make_layered_medium(
        {{{}, {1, 1, 1e-4}, 1, 1e4}}, {},
        {SourceFunction::band(450e-9, 10e-9), SourceFunction::band(550e-9, 10e-9),
         SourceFunction::band(650e-9, 10e-9)},
        of_one));
    scene.scatterers.push_back({media.back().get(), henyey_greenstein(0.9, 0.75)});
  }
  scene.medium = media.size() == 1 ? media.front() : make_composite_medium(media);
  DeltaLight sun;
  sun.parallel = true;
  sun.direction = {0, 0, -1};
  sun.strength = {1, 1, 1};
  scene.lights.delta = {sun};
  return scene;
}

/// Rays of Lambert's law out of the middle of the slab's face.
std::vector<Ray> out_of_slab(bool front, std::size_t count) {
  std::vector<Ray> rays;
  Random random(front ? 11 : 12);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 out = cosine_direction({0, 0, front ? 1.0 : -1.0}, random(), random());
    rays.push_back({{0, 0, 0}, -out});
  }
  return rays;
}

void expect_slab(const Tally& tally, double expected, double most) {
  EXPECT_LT(kPi * tally.error(), most * expected);
  EXPECT_TRUE(within_standard_errors(kPi * tally.value(), expected, kPi * tally.error(), 4));
}

// At one node, beside nodes with an eighth and with eight times of its extinction, in every order.
TEST(ColouredSmoke, VanDeHulstSlabAtEveryNode) {
  for (std::size_t node = 0; node < 3; ++node) {
    std::vector<double> factors{8, 8, 8};
    factors[node] = 1;
    factors[(node + 1) % 3] = 0.125;
    const CompiledScene scene = slab({factors});
    constexpr std::size_t kRays = 80000;
    expect_slab(scattered_along(scene, out_of_slab(true, kRays), 3 + node)[node], kReflected,
                0.016);
    expect_slab(scattered_along(scene, out_of_slab(false, kRays), 6 + node)[node],
                kTransmitted - std::exp(-2.0), 0.016);
  }
}

// The same slab at the second node of two media in one place, of which each node has others'
// shares.
TEST(ColouredSmoke, VanDeHulstSlabOfTwoMedia) {
  const CompiledScene scene = slab({{0, 0.25, 4}, {2, 0.75, 0.5}});
  expect_slab(scattered_along(scene, out_of_slab(true, 2500), 9)[1], kReflected, 0.1);
}

/// Smoke and a flame that scatters as well, before a grey wall, under a lamp and a sky.
/// @param which nodes of the four @param flame where it is
CompiledScene two_clouds(const std::vector<std::size_t>& which, Vec3 flame) {
  constexpr double kSmoke[] = {1, 12, 0.05, 3}, kSoot[] = {4, 0.3, 1, 0};
  SolidSurfaceSpec wall;
  wall.shape = SolidShape::plane;
  wall.extent = {4, 4};
  wall.position = {0, 0, -1.5};
  wall.material.reflectivity = 0.6;
  LightSpec lamp;
  lamp.position = {2, 0.5, 1.5};
  lamp.power = 4e-4;
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 1e-5;
  CompiledScene scene = lit_scene({wall}, {lamp, sky}, 2);
  std::vector<SourceFunction> bands, dimmed;
  std::vector<double> smoke, soot;
  for (const std::size_t node : which) {
    bands.push_back(SourceFunction::band((500 + 50 * static_cast<double>(node)) * 1e-9, 5e-9));
    dimmed.push_back(bands.back().scaled(0.5));
    smoke.push_back(kSmoke[node]);
    soot.push_back(kSoot[node]);
  }
  const std::shared_ptr<const Medium> cold =
      make_layered_medium({{{0, 0, 0}, {1, 0.8, 0.6}, 1, 1}}, {}, bands, smoke);
  const std::shared_ptr<const Medium> hot =
      make_layered_medium({{flame, {0.5, 0.5, 0.5}, 1100, 0.8}}, {}, dimmed, soot);
  scene.medium = make_composite_medium({cold, hot});
  scene.scatterers = {{cold.get(), henyey_greenstein(0.9, 0.5)}, {hot.get(), rayleigh(0.5)}};
  scene.lights = compile_lights(scene.scene.lights,
                                std::vector<SourceFunction>(which.size(), SourceFunction::total()));
  scene.scene.channels.resize(which.size());
  return scene;
}

/// Rays from above into the clouds and to the wall beside them.
std::vector<Ray> from_above(std::size_t count) {
  std::vector<Ray> rays;
  Random random(21);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = 2.2 * random() - 1.1, y = 2 * random() - 0.9;
    rays.push_back({{x, y, 3}, normalize({0.1 * random(), 0.1 * random(), -1})});
  }
  return rays;
}

/// Each node must be as the grey medium that it would be alone, a walk without weights of nodes.
void expect_as_alone(Vec3 flame, std::size_t count, double most) {
  const std::vector<Ray> rays = from_above(count);
  const std::vector<Tally> together = nodes_along(two_clouds({0, 1, 2, 3}, flame), rays, 5);
  for (std::size_t node = 0; node < 4; ++node) {
    const Tally alone = nodes_along(two_clouds({node}, flame), rays, 50 + node)[0];
    EXPECT_LT(alone.error(), most * alone.value());
    // Over four nodes the mean square of what one walk finds is at most four times as large.
    EXPECT_LT(together[node].error(), 2.5 * alone.error()) << node;
    EXPECT_TRUE(within_standard_errors(together[node].value(), alone.value(),
                                       std::hypot(together[node].error(), alone.error()), 4))
        << node;
  }
}

TEST(ColouredSmoke, EachNodeAsIfAlone) {
  expect_as_alone({0.3, 1.5, 0.3}, 40000, 0.02);
}

// In one place, where each node has a scatterer that it would choose. Slow: see composite_medium.
TEST(ColouredSmoke, EachNodeAsIfAloneInOverlappingClouds) {
  expect_as_alone({0.3, 0.4, 0.3}, 1000, 0.08);
}

}  // namespace
}  // namespace plenoflame::test::coloured_smoke_test
