// Media that scatter between surfaces: conservation of energy, and a forward walk of the test's
// own.
#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "core/render/dim_pixels.h"
#include "core/render/isothermal.h"
#include "core/render/scattered_light.h"
#include "sampling/directions.h"
#include "support/approx.h"
#include "support/flame_scenes.h"
#include "support/small_scene.h"

namespace plenoflame::test::smoke_and_walls_test {
namespace {

constexpr double kPi = std::numbers::pi;

/// Reflects as its surfaces do, and emits the rest of a black body's radiance: grey walls.
class GreyWalls : public SurfaceScene {
 public:
  GreyWalls(const std::vector<SolidSurfaceSpec>& specs, std::vector<double> black)
      : inner_(scene_of(specs)) {
    for (const SolidSurfaceSpec& spec : specs) {
      emission_.push_back(black);
      for (double& e : emission_.back()) e *= 1 - spec.material.reflectivity;
    }
  }
  bool intersect(const Ray& ray, double t_near, double t_far, SurfacePart from,
                 SurfaceHit& hit) const override {
    return inner_->intersect(ray, t_near, t_far, from, hit);
  }
  bool occluded(const Ray& ray, double t_near, double t_far, SurfacePart from) const override {
    return inner_->occluded(ray, t_near, t_far, from);
  }
  int surface_count() const override { return inner_->surface_count(); }
  const double* emission(int surface, bool) const override {
    return emission_[static_cast<std::size_t>(surface)].data();
  }
  double area(int surface) const override { return inner_->area(surface); }
  SurfacePoint point_on(int surface, double choice, double u, double v) const override {
    return inner_->point_on(surface, choice, u, v);
  }
  Box bounds() const override { return inner_->bounds(); }
  bool has_endless_plane() const override { return inner_->has_endless_plane(); }
  double feature_size() const override { return inner_->feature_size(); }
  int inside_of(Vec3 point) const override { return inner_->inside_of(point); }
  std::vector<PatternPoint> pattern_points() const override { return {}; }
  std::string description() const override { return "grey walls"; }

 private:
  std::unique_ptr<SurfaceScene> inner_;
  std::vector<std::vector<double>> emission_;
};

// In a closed box of one temperature there is nothing but the radiance of a black body, whatever
// its walls reflect and what is in it scatters: camera, flames, a ball and walls are inside.
TEST(SmokeAndWalls, ClosedIsothermalBox) {
  for (const double reflectivity : {0.0, 0.5, 0.9})
    for (const ScatteringSpec& spec : {henyey_greenstein(0.3, 0.6), rayleigh(0.9)}) {
      Scene scene = bare_flame(6, 4, 2e-3);
      scene.channels = {{"red", ChannelKind::band, 650e-9, 10e-9},
                        {"blue", ChannelKind::band, 450e-9, 80e-9}};
      scene.flames[0].spectrum.kind = SpectrumKind::power;
      scene.flames.push_back(scene.flames[0]);  // a second one overlaps it
      scene.flames[1].position.x += 0.02;
      scene.flames[1].spectrum.exponent = 0.5;
      for (FlameSpec& flame : scene.flames)
        for (EllipsoidSpec& layer : flame.layers) layer.temperature = 1700;
      scene.flames[0].scattering = spec;
      scene.flames[1].scattering = henyey_greenstein(0.5, -0.2);
      CompiledScene with = compile(scene);
      with.scene.render.reflections = 150;  // 0.9^150 is 1e-7
      ASSERT_EQ(with.scatterers.size(), 2u);
      std::vector<double> black;
      for (int n = 0; n < with.node_count(); ++n)
        black.push_back(with.scatterers[0].medium->source(n, 1700) / (1 - spec.albedo));
      SolidSurfaceSpec box = shaped(SolidShape::box, 1), ball = shaped(SolidShape::sphere, 0.01);
      box.size = {4, 4, 4};
      box.position = {0, 0, -2};
      ball.position = {1, 0.01, 0};
      box.material.reflectivity = reflectivity;
      ball.material.reflectivity = 0.7;
      with.surfaces = std::make_unique<GreyWalls>(std::vector{box, ball}, black);
      expect_isothermal(
          scene, with, 320, 1700,
          "walls " + std::to_string(reflectivity) + ", albedo " + std::to_string(spec.albedo));
    }
}

/// Share of parallel light that comes back from a slab over a wall: packets are followed from the
/// light on, absorbed as they are.
Tally reflected_forward(double tau, const ScatteringSpec& spec, double wall, int reflections,
                        Vec3 way) {
  Random random(99);
  Tally tally;
  for (int i = 0; i < 400000; ++i) {
    double depth = 0;
    Vec3 d = way;
    double back = 0;
    int left = reflections;
    for (;;) {
      depth -= d.z * -std::log(random());
      if (depth < 0) {
        back = 1;
        break;
      }
      if (depth > tau) {
        if (random() > wall || left-- == 0) break;
        depth = tau;
        // A point of the unit sphere on top of the normal is distributed by the cosine.
        d = normalize(Vec3{0, 0, 1.0001} + random.direction());
        continue;
      }
      if (random() > spec.albedo) break;
      const double g = spec.asymmetry;
      const double s = (1 - g * g) / (1 - g + 2 * g * random());
      const double cosine = (1 + g * g - s * s) / (2 * g);
      // A direction across d, by chance.
      Vec3 across = random.direction();
      across = normalize(across - dot(across, d) * d);
      d = normalize(cosine * d + std::sqrt(1 - cosine * cosine) * across);
    }
    tally.add(back);
  }
  return tally;
}

/// The same, looked for against the light: pi times the mean radiance over directions by the
/// cosine.
Tally reflected_backward(double tau, const ScatteringSpec& spec, double wall, int reflections,
                         Vec3 way, int count = 100000) {
  SolidSurfaceSpec floor = shaped(SolidShape::plane, 1);
  floor.extent = {kInfinity, kInfinity};
  floor.material.reflectivity = wall;
  LightSpec sun;
  sun.kind = LightKind::parallel;
  sun.direction = way;
  sun.irradiance = 1 / -way.z;
  // As much smoke below the floor as above it.
  const CompiledScene scene = smoke({1e4, 1e4, 0.5}, 2 * tau, spec, {floor}, {sun}, reflections);
  std::vector<Ray> rays;
  Random random(7);
  for (int i = 0; i < count; ++i) {
    const Vec3 out = cosine_direction({0, 0, 1}, random(), random());
    rays.push_back({(1 / out.z) * out, -out});
  }
  Tally mean = radiance_along(scene, rays, 8);
  mean.sum *= kPi;
  mean.squares *= kPi * kPi;
  return mean;
}

// All light comes back, since neither the smoke nor the wall absorbs any.
TEST(SmokeAndWalls, AWhiteWallBehindWhiteSmokeSendsAllBack) {
  for (const ScatteringSpec& spec : {henyey_greenstein(1, 0.5), rayleigh(1)})
    for (const double tau : {0.3, 2.0}) {
      const Tally back = reflected_backward(tau, spec, 1, 1000, normalize({0.8, 0, -1}), 30000);
      EXPECT_LT(back.error(), 0.01);
      EXPECT_TRUE(within_standard_errors(back.value(), 1, back.error(), 4)) << tau;
    }
}

TEST(SmokeAndWalls, AWallBehindSmokeAsFollowedFromTheLight) {
  const struct {
    double wall;
    int reflections;
    ScatteringSpec spec;
  } cases[] = {{0.0, 1000, henyey_greenstein(0.8, 0.6)},
               {0.6, 1000, henyey_greenstein(0.95, -0.3)},
               {0.9, 1, henyey_greenstein(0.95, 0.6)},
               {0.9, 0, henyey_greenstein(0.95, 0.6)}};
  const Vec3 way = normalize({0.5, 0.3, -1});
  for (const auto& c : cases) {
    const Tally forward = reflected_forward(1.5, c.spec, c.wall, c.reflections, way);
    const Tally backward = reflected_backward(1.5, c.spec, c.wall, c.reflections, way);
    const double error = std::hypot(forward.error(), backward.error());
    EXPECT_LT(error, 0.015 * forward.value());
    EXPECT_TRUE(within_standard_errors(backward.value(), forward.value(), error, 4))
        << c.wall << " " << c.reflections;
  }
}

/// A flame, a lamp, a sky, a hot ball and a wall.
Scene busy_scene() {
  Scene scene = small_scene(ideal_singlet(), {});
  scene.camera.sensor = {12, 12, 1e-3};
  SolidSurfaceSpec wall = shaped(SolidShape::plane, 1), ball = shaped(SolidShape::sphere, 2e-3);
  wall.position = {1.02, 0, 0};
  wall.extent = {0.06, 0.06};
  wall.rotation = {0, -kPi / 2, 0};
  ball.position = {0.985, 8e-3, -4e-3};
  ball.material.kind = MaterialKind::blackbody;
  ball.material.temperature = 1500;
  LightSpec lamp;
  lamp.position = {0.7, 0.2, 0.25};
  lamp.power = 2e4;
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 3000;
  scene.surfaces = {wall, ball};
  scene.lights = {lamp, sky};
  scene.render.reflections = 2;
  return scene;
}

// Walks of a flame that scatters nothing to speak of see what the surfaces' own estimator sees.
TEST(SmokeAndWalls, HardlyAnyScatteringIsNone) {
  for (const bool flame_light : {true, false}) {
    Scene scene = busy_scene();
    scene.render.flame_light = flame_light;
    RenderSettings settings;
    settings.samples = 512;
    settings.replicates = 16;
    const LightField none = render(compile(scene), settings, one_thread()).light_field;
    scene.flames[0].scattering = henyey_greenstein(1e-9, 0.3);
    const LightField some = render(compile(scene), settings, one_thread()).light_field;
    double sum = 0, all = 0, variance = 0, chi_square = 0;
    const LightFieldChannel &a = some.channels[0], &b = none.channels[0];
    for (std::size_t i = 0; i < a.flux.pixels.size(); ++i) {
      const double f = static_cast<double>(a.flux.pixels[i]),
                   g = static_cast<double>(b.flux.pixels[i]);
      const double square = std::pow(static_cast<double>(a.standard_error.pixels[i]), 2) +
                            std::pow(static_cast<double>(b.standard_error.pixels[i]), 2);
      sum += f;
      all += g;
      variance += square;
      chi_square += (f - g) * (f - g) / square;
    }
    EXPECT_LT(std::sqrt(variance), 0.005 * all);
    EXPECT_TRUE(within_standard_errors(sum, all, std::sqrt(variance), 4)) << flame_light;
    const auto count = static_cast<double>(a.flux.pixels.size());
    EXPECT_LT(chi_square / count, 15.0 / 13 * (1 + 4 * std::sqrt(2 / count)));
  }
}

// Nothing is seen of a flame inside of a closed box, and nothing of what it scatters; nor, from
// inside of one around the camera, of what is outside.
TEST(SmokeAndWalls, SmokeBehindAWallIsHidden) {
  Scene scene = busy_scene();
  scene.flames[0].scattering = henyey_greenstein(0.9, 0.3);
  SolidSurfaceSpec screen = shaped(SolidShape::box, 1);
  screen.size = {0.06, 0.06, 0.06};
  screen.position = {1, 0, -0.03};
  screen.material.kind = MaterialKind::black;
  scene.surfaces = {screen};
  LightSpec lamp;
  lamp.position = {1, 0, 0.02};  // inside, too
  lamp.power = 1e5;
  scene.lights = {lamp};
  RenderSettings settings;
  settings.samples = 64;
  EXPECT_EQ(render(compile(scene), settings, one_thread()).statistics.flux, 0);
  settings.estimator = Estimator::forward;
  settings.samples = 20000;
  EXPECT_EQ(render(compile(scene), settings, one_thread()).statistics.flux, 0);
  scene.surfaces.clear();
  EXPECT_GT(render(compile(scene), settings, one_thread()).statistics.flux, 0);
}

TEST(SmokeAndWalls, DoNotDependOnThreadsAndNotOnTheWindow) {
  Scene scene = busy_scene();
  scene.flames[0].scattering = henyey_greenstein(0.5, 0.3);
  const CompiledScene compiled = compile(scene);
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  settings.samples = 300000;
  const Image forward = render(compiled, settings, one_thread()).light_field.channels[0].flux;
  EXPECT_EQ(forward.pixels,
            render(compiled, settings, threads(3)).light_field.channels[0].flux.pixels);
  settings.estimator = Estimator::backward;
  settings.samples = 8;
  const Image one = render(compiled, settings, one_thread()).light_field.channels[0].flux;
  const Image three = render(compiled, settings, threads(3)).light_field.channels[0].flux;
  EXPECT_EQ(one.pixels, three.pixels);
  settings.window = {5, 4, 5, 2};
  const Image part = render(compiled, settings, one_thread()).light_field.channels[0].flux;
  for (int row = 0; row < 2; ++row)
    for (int c = 0; c < 5; ++c) EXPECT_EQ(part.at(c, row), one.at(5 + c, 4 + row));
}

// Pixels that get a point now and then keep the numbers of walks and of light from surfaces apart.
TEST(SmokeAndWalls, PixelsLeftToChance) {
  Scene scene = paper_flame(48, 48, 0.001);
  scene.flames[0].scattering = henyey_greenstein(0.6, 0.5);
  CompiledScene with = compile(scene);
  SolidSurfaceSpec wall = shaped(SolidShape::box, 1);
  wall.size = {0.01, 0.4, 0.4};
  wall.position = {1.05, 0, 0};
  wall.material.reflectivity = 0.8;
  with.surfaces = scene_of(std::vector{wall});
  with.scene.render.reflections = 1;
  expect_dim_pixels_right(with, {2, 8, 100, 1 << 11});
}

}  // namespace
}  // namespace plenoflame::test::smoke_and_walls_test
