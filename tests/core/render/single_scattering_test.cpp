// Light that is scattered once, against closed forms and quadrature. With an albedo of 1e-4 what is
// scattered twice is below the errors.
#include <gtest/gtest.h>

#include <numbers>

#include "core/render/scattered_light.h"
#include "support/approx.h"

namespace plenoflame::test::single_scattering_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kAlbedo = 1e-4;

/// The phase functions again, as printed (Henyey and Greenstein, Astrophys. J. 93 (1941) 70;
/// Chandrasekhar, Radiative Transfer, section 17) [1/sr].
double printed_phase(const ScatteringSpec& spec, double cosine) {
  if (spec.phase == PhaseFunction::rayleigh) return 0.75 * (1 + std::pow(cosine, 2)) / (4 * kPi);
  const double g = spec.asymmetry;
  return (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5) / (4 * kPi);
}

LightSpec lamp_at(Vec3 position) {
  LightSpec lamp;
  lamp.position = position;
  lamp.power = 4 * kPi * 1000;  // 1000 W/sr
  return lamp;
}
LightSpec sun_along(Vec3 direction) {
  LightSpec sun;
  sun.kind = LightKind::parallel;
  sun.direction = direction;
  sun.irradiance = 1000;
  return sun;
}

const ScatteringSpec kSpecs[] = {henyey_greenstein(kAlbedo, 0), henyey_greenstein(kAlbedo, 0.7),
                                 henyey_greenstein(kAlbedo, -0.4), rayleigh(kAlbedo)};

// A slab under parallel light, seen from above: L = omega E p mu0 / (mu + mu0)
// (1 - e^(-tau (1/mu + 1/mu0))), E across the light (Chandrasekhar, section 24.2; Hansen and
// Travis, Space Sci. Rev. 16 (1974) 527, eq. 2.28).
TEST(SingleScattering, SlabUnderParallelLight) {
  constexpr double kTau = 1.3;
  for (const ScatteringSpec& spec : kSpecs)
    for (const double side : {-0.7, 0.0, 1.9}) {
      const Vec3 way = normalize({side, 0.4, -1});   // of the light
      const Vec3 seen = normalize({-0.5, 0.2, -1});  // of the ray, away from the camera
      const CompiledScene scene =
          smoke({1000, 1000, 0.5}, kTau, spec, {}, {sun_along(way)});  // 1 m thick
      const double mu0 = -way.z, mu = -seen.z;
      const double expected = kAlbedo * 1000 * printed_phase(spec, dot(seen, -way)) * mu0 /
                              (mu + mu0) * -std::expm1(-kTau * (1 / mu + 1 / mu0));
      const Tally mean =
          radiance_along(scene, std::vector<Ray>(40000, Ray{-2 / mu * seen, seen}), 3);
      EXPECT_LT(mean.error(), 0.01 * expected);
      EXPECT_TRUE(within_standard_errors(mean.value(), expected, mean.error(), 4))
          << side << " g " << spec.asymmetry;
    }
}

// Two kinds of smoke in one slab, which scatter forwards and backwards, and soot that only absorbs:
// the ray sees the sum of what each scatters.
TEST(SingleScattering, SeveralFlamesInOnePlace) {
  const double taus[] = {0.5, 0.3, 0.6};
  const ScatteringSpec specs[] = {
      henyey_greenstein(kAlbedo, 0.7), henyey_greenstein(2 * kAlbedo, -0.6), {}};
  const Vec3 way = normalize({1.2, 0.4, -1}), seen = normalize({-0.5, 0.2, -1});
  CompiledScene scene = smoke({1000, 1000, 0.5}, 1, {}, {}, {sun_along(way)});
  scene.scatterers.clear();
  std::vector<std::shared_ptr<const Medium>> media;
  double strength = 0, tau = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    media.push_back(
        make_layered_medium({{{}, {1000, 1000, 0.5}, 1, taus[i]}}, {}, {SourceFunction::total()}));
    if (specs[i].albedo > 0) scene.scatterers.push_back({media.back().get(), specs[i]});
    strength += taus[i] * specs[i].albedo * printed_phase(specs[i], dot(seen, -way));
    tau += taus[i];
  }
  scene.medium = make_composite_medium(media);
  const double mu0 = -way.z, mu = -seen.z;
  const double expected =
      1000 * strength / tau * mu0 / (mu + mu0) * -std::expm1(-tau * (1 / mu + 1 / mu0));
  const Tally mean = radiance_along(scene, std::vector<Ray>(6000, Ray{-2 / mu * seen, seen}), 9);
  EXPECT_LT(mean.error(), 0.03 * expected);  // media that overlap take their time
  EXPECT_TRUE(within_standard_errors(mean.value(), expected, mean.error(), 4));
}

/// Way from a point inside a ball of radius 1 to its surface.
double way_out(Vec3 point, Vec3 direction) {
  const double b = dot(point, direction);
  return -b + std::sqrt(b * b + 1 - dot(point, point));
}

// A ball of smoke with a lamp at its side, and with one inside of it.
TEST(SingleScattering, BallWithALampAtItsSide) {
  constexpr double kExtinction = 0.8;
  const Ray ray{{-4, 0.1, 0.2}, {1, 0, 0}};
  for (const ScatteringSpec& spec : kSpecs)
    for (const Vec3 lamp : {Vec3{0.3, 2, 0.5}, Vec3{-0.2, 0.5, -0.3}}) {
      const CompiledScene scene = smoke({1, 1, 1}, kExtinction, spec, {}, {lamp_at(lamp)});
      // Midpoints along the chord.
      const double half = std::sqrt(1 - 0.05);
      constexpr int kSteps = 20000;
      double expected = 0;
      for (int i = 0; i < kSteps; ++i) {
        const double x = half * (2 * (i + 0.5) / kSteps - 1);
        const Vec3 place{x, 0.1, 0.2};
        const double distance = length(lamp - place);
        const Vec3 way = (1 / distance) * (lamp - place);
        const double passed = std::min(distance, way_out(place, way)) + x + half;
        expected += 2 * half / kSteps * kAlbedo * kExtinction *
                    printed_phase(spec, dot(way, ray.direction)) * 1000 / (distance * distance) *
                    std::exp(-kExtinction * passed);
      }
      const Tally mean = radiance_along(scene, std::vector<Ray>(60000, ray), 4);
      EXPECT_LT(mean.error(), 0.01 * expected);
      EXPECT_TRUE(within_standard_errors(mean.value(), expected, mean.error(), 4))
          << lamp.y << " g " << spec.asymmetry;
    }
}

// A screen between lamp and ball shades the part of the ray on one side of an edge.
TEST(SingleScattering, BallInTheShadeOfAScreen) {
  constexpr double kExtinction = 0.8, kEdge = 0.25, kScreen = 1.3;
  const ScatteringSpec spec = henyey_greenstein(kAlbedo, 0.5);
  const Vec3 lamp{0.3, 2, 0.2};
  SolidSurfaceSpec screen = shaped(SolidShape::box, 1);  // from x = kEdge on
  screen.size = {2, 1e-3, 4};
  screen.position = {kEdge + 1, kScreen, -2};
  screen.material.kind = MaterialKind::black;
  const CompiledScene scene = smoke({1, 1, 1}, kExtinction, spec, {screen}, {lamp_at(lamp)});
  const double half = std::sqrt(1 - 0.05);
  constexpr int kSteps = 20000;
  double expected = 0, shaded = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = half * (2 * (i + 0.5) / kSteps - 1);
    const Vec3 place{x, 0.1, 0.2};
    const double distance = length(lamp - place);
    const Vec3 way = (1 / distance) * (lamp - place);
    const double passed = way_out(place, way) + x + half;
    const double light = 2 * half / kSteps * kAlbedo * kExtinction * printed_phase(spec, way.x) *
                         1000 / (distance * distance) * std::exp(-kExtinction * passed);
    const double crossing = x + way.x / way.y * (kScreen - 0.1);
    (crossing > kEdge ? shaded : expected) += light;
  }
  EXPECT_GT(shaded, 0.2 * expected);
  const Tally mean =
      radiance_along(scene, std::vector<Ray>(60000, Ray{{-4, 0.1, 0.2}, {1, 0, 0}}), 6);
  EXPECT_LT(mean.error(), 0.01 * expected);
  EXPECT_TRUE(within_standard_errors(mean.value(), expected, mean.error(), 4));
}

// A ball of hot gas beside one of smoke: the emission along whole lines through it, found by its
// points and by the directions that walks take. A screen between the two hides all of it.
TEST(SingleScattering, BallBesideABallOfHotGas) {
  constexpr double kExtinction = 0.8, kRadius = 0.6, kAbsorption = 2;
  const Ray ray{{-4, 0.1, 0.2}, {1, 0, 0}};
  const double source = SourceFunction::total()(1500);
  for (const ScatteringSpec& spec : kSpecs) {
    CompiledScene scene = smoke({1, 1, 1}, kExtinction, spec, {}, {});
    const Vec3 centre{0, 0, 1.7};
    const std::vector<std::shared_ptr<const Medium>> media{
        scene.medium,
        make_layered_medium({{centre, {kRadius, kRadius, kRadius}, 1500, kAbsorption}}, {},
                            {SourceFunction::total()})};
    scene.medium = make_composite_medium(media);
    const double half = std::sqrt(1 - 0.05);
    constexpr int kSteps = 200, kRings = 100, kSectors = 60;
    double expected = 0;
    for (int i = 0; i < kSteps; ++i) {
      const Vec3 place{half * (2 * (i + 0.5) / kSteps - 1), 0.1, 0.2};
      const Vec3 to_hot = centre - place;
      const double distance = length(to_hot), limit = std::asin(kRadius / distance);
      const Vec3 axis = (1 / distance) * to_hot, x = normalize(cross(axis, Vec3{0, 1, 0})),
                 y = cross(axis, x);
      for (int r = 0; r < kRings; ++r)
        for (int s = 0; s < kSectors; ++s) {
          const double angle = limit * (r + 0.5) / kRings, turn = 2 * kPi * (s + 0.5) / kSectors;
          const Vec3 way = std::cos(angle) * axis + std::sin(angle) * std::cos(turn) * x +
                           std::sin(angle) * std::sin(turn) * y;
          const double miss = distance * std::sin(angle);
          const double chord = 2 * std::sqrt(kRadius * kRadius - miss * miss);
          const double passed = way_out(place, way) + place.x + half;
          expected += 2 * half / kSteps * limit / kRings * std::sin(angle) * 2 * kPi / kSectors *
                      kAlbedo * kExtinction * printed_phase(spec, dot(way, ray.direction)) *
                      source * -std::expm1(-kAbsorption * chord) * std::exp(-kExtinction * passed);
        }
    }
    const std::vector<Ray> rays(40000, ray);
    const Tally mean = radiance_along(scene, rays, 10);
    EXPECT_LT(mean.error(), 0.01 * expected);
    EXPECT_TRUE(within_standard_errors(mean.value(), expected, mean.error(), 4))
        << "g " << spec.asymmetry;
    SolidSurfaceSpec screen = shaped(SolidShape::plane, 1);
    screen.extent = {kInfinity, kInfinity};
    screen.position = {0, 0, 1.05};
    screen.material.kind = MaterialKind::black;
    scene.surfaces = scene_of({screen});
    scene.scene.surfaces = {screen};
    EXPECT_LT(radiance_along(scene, std::vector<Ray>(4000, ray), 11).value(), 1e-6 * expected);
  }
}

// A glowing disc over the ball, of which a screen hides half: its points and the directions that
// walks take find it, and count it once.
TEST(SingleScattering, BallUnderAGlowingDisc) {
  constexpr double kExtinction = 0.8, kRadius = 1.2, kHeight = 1.5;
  const Ray ray{{-4, 0.1, 0.2}, {1, 0, 0}};
  SolidSurfaceSpec disc = shaped(SolidShape::disc, kRadius);
  disc.position = {0, 0, kHeight};
  disc.rotation = {kPi, 0, 0};
  disc.material.kind = MaterialKind::emitter;
  disc.material.radiance = 50;
  disc.material.sides = MaterialSides::front;
  // Right below the disc: what is at y < 0 of it cannot be seen, up to the slit's parallax of 1e-6.
  SolidSurfaceSpec screen = shaped(SolidShape::plane, 1);
  screen.position = {0, -5, kHeight - 1e-6};
  screen.extent = {10, 10};
  screen.material.kind = MaterialKind::black;
  for (const ScatteringSpec& spec : kSpecs) {
    const CompiledScene scene = smoke({1, 1, 1}, kExtinction, spec, {disc, screen}, {});
    const double half = std::sqrt(1 - 0.05);
    constexpr int kSteps = 100, kRings = 60, kSectors = 120;
    double expected = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double x = half * (2 * (i + 0.5) / kSteps - 1);
      const Vec3 place{x, 0.1, 0.2};
      for (int r = 0; r < kRings; ++r)
        for (int s = 0; s < kSectors; ++s) {
          const double radius = kRadius * (r + 0.5) / kRings, angle = kPi * (s + 0.5) / kSectors;
          const Vec3 point{radius * std::cos(angle), radius * std::sin(angle), kHeight};
          const double distance = length(point - place);
          const Vec3 way = (1 / distance) * (point - place);
          const double passed = way_out(place, way) + x + half;
          expected += 2 * half / kSteps * kRadius / kRings * radius * kPi / kSectors * kAlbedo *
                      kExtinction * printed_phase(spec, dot(way, ray.direction)) * 50 * way.z /
                      (distance * distance) * std::exp(-kExtinction * passed);
        }
    }
    const Tally mean = radiance_along(scene, std::vector<Ray>(200000, ray), 5);
    EXPECT_LT(mean.error(), 0.01 * expected);
    EXPECT_TRUE(within_standard_errors(mean.value(), expected, mean.error(), 4))
        << "g " << spec.asymmetry;
  }
}

}  // namespace
}  // namespace plenoflame::test::single_scattering_test
