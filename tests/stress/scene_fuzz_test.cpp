// Scenes, lenses and arrays at random: whatever can be compiled renders without NaN, infinity or
// negative flux, by both estimators; what cannot says so.
#include <cmath>
#include <random>
#include <string>

#include "plenoflame/base/error.h"
#include "plenoflame/render/render.h"
#include "stress/stress_table.h"
#include "support/cameras.h"
#include "support/small_scene.h"

namespace plenoflame::scene_fuzz_test {
namespace {

using test::StressCase;

class SceneGenerator {
 public:
  explicit SceneGenerator(std::uint64_t seed) : random_(seed) {}

  Scene operator()() {
    const bool array = chance(0.7);
    Scene scene = test::small_scene(
        chance(0.3) ? test::ideal_singlet() : test::singlet(),
        array ? test::large_array(chance(0.5) ? Lattice::hexagonal : Lattice::square,
                                  chance(0.3) ? LensModel::ideal : LensModel::real)
              : ArraySpec{});
    scene.camera.sensor = {1 + below(12), 1 + below(12), 1e-3 * logarithmic(0.01, 1)};
    if (chance(0.5)) surfaces(scene.camera.lens);
    if (array && chance(0.6)) microlenses(scene.camera.array);
    if (chance(0.3)) scene.camera.focus.object_distance = logarithmic(0.01, 1e4);
    if (chance(0.2)) scene.camera.focus.mode = FocusMode::best;
    if (chance(0.2)) {
      scene.camera.focus.mode = FocusMode::distance;
      scene.camera.focus.lens_distance = logarithmic(1e-3, 10);
    }
    FlameSpec& flame = scene.flames[0];
    for (EllipsoidSpec& layer : flame.layers) {
      layer.temperature = logarithmic(1, 1e5);
      layer.absorption = chance(0.1) ? 0 : logarithmic(1e-12, 1e12);
      const double size = logarithmic(0.1, 10);
      layer.semi_axes = {size * layer.semi_axes.x, logarithmic(0.01, 100) * layer.semi_axes.y,
                         size * layer.semi_axes.z};
    }
    flame.position = {logarithmic(0.05, 100), uniform(-0.05, 0.05), uniform(-0.05, 0.05)};
    flame.rotation = {uniform(-3, 3), uniform(-3, 3), uniform(-3, 3)};
    scale(scene, chance(0.3) ? logarithmic(1e-3, 1e3) : 1);
    return scene;
  }

  bool chance(double p) { return uniform(0, 1) < p; }

 private:
  int below(int n) { return static_cast<int>(uniform(0, n)); }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double logarithmic(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }

  void surfaces(MainLensSpec& lens) {
    lens.surfaces.clear();
    const int count = 1 + below(5), stop = below(count + 1);
    const double diameter = logarithmic(1e-3, 0.2);
    double index = 1;
    for (int k = 0; k < count; ++k) {
      if (k == stop)
        lens.surfaces.push_back({kInfinity, 0.1 * diameter, index, 0.8 * diameter, true});
      index = k + 1 == count ? 1 : chance(0.3) ? 1 : 1 + logarithmic(1e-9, 2);
      const double radius =
          chance(0.2) ? kInfinity : (chance(0.5) ? 1 : -1) * diameter * logarithmic(0.5, 1e4);
      lens.surfaces.push_back(
          {radius, k + 1 == count ? 0 : diameter * logarithmic(1e-3, 1), index, diameter, false});
    }
    if (stop == count) lens.surfaces.push_back({kInfinity, 0, 1, 0.8 * diameter, true});
  }

  void microlenses(ArraySpec& array) {
    array.pitch = logarithmic(1e-5, 5e-3);
    array.diameter = array.pitch * uniform(0.3, 1);
    array.thickness = array.pitch * logarithmic(0.05, 5);
    array.sensor_distance = array.pitch * logarithmic(0.5, 30);
    array.measured_from = ArrayReference::vertex;
    array.rotation = uniform(-3, 3);
    array.offset = {array.pitch * uniform(-1, 1), array.pitch * uniform(-1, 1)};
    for (MicrolensSpec& type : array.types) {
      type.radius_front =
          chance(0.2) ? kInfinity : (chance(0.8) ? 1 : -1) * array.pitch * logarithmic(0.5, 100);
      type.radius_back =
          chance(0.2) ? kInfinity : (chance(0.8) ? 1 : -1) * array.pitch * logarithmic(0.5, 100);
      type.index = 1 + logarithmic(1e-9, 2);
      type.focal_length = array.pitch * logarithmic(1, 100);
    }
  }

  static void scale(Scene& scene, double s) {
    CameraSpec& camera = scene.camera;
    for (SurfaceSpec& surface : camera.lens.surfaces) {
      surface.radius *= s;
      surface.thickness *= s;
      surface.diameter *= s;
    }
    ArraySpec& array = camera.array;
    for (double* length : {&array.pitch, &array.diameter, &array.thickness, &array.sensor_distance,
                           &array.offset.x, &array.offset.y, &camera.sensor.pixel_pitch,
                           &camera.focus.object_distance, &camera.focus.lens_distance})
      *length *= s;
    for (MicrolensSpec& type : array.types) {
      type.radius_front *= s;
      type.radius_back *= s;
      type.focal_length *= s;
    }
    for (FlameSpec& flame : scene.flames) {
      flame.position = s * flame.position;
      for (EllipsoidSpec& layer : flame.layers) {
        layer.centre = s * layer.centre;
        layer.semi_axes = s * layer.semi_axes;
      }
    }
  }

  std::mt19937_64 random_;
};

double bad_pixels(const LightField& field) {
  double count = 0;
  for (const LightFieldChannel& channel : field.channels) {
    for (const float p : channel.flux.pixels) count += std::isfinite(p) && p >= 0 ? 0 : 1;
    for (const float p : channel.standard_error.pixels) count += std::isfinite(p) && p >= 0 ? 0 : 1;
  }
  return count;
}

TEST(SceneFuzz, NoNaNNoInfinityNoNegativeFlux) {
  StressCase bad("Random scenes",
                 "pixels that are NaN, infinite or negative, by both estimators, random lenses, "
                 "arrays, flames [count]",
                 "none", 0);
  constexpr int kScenes = 150;
  int rendered = 0, refused = 0, lit = 0;
  for (int seed = 1; seed <= kScenes; ++seed) {
    SceneGenerator generate(static_cast<std::uint64_t>(seed));
    const Scene scene = generate();
    SCOPED_TRACE("seed " + std::to_string(seed));
    try {
      const CompiledScene compiled = compile(scene, load_core_medium, test::one_thread());
      for (const Estimator estimator : {Estimator::backward, Estimator::forward}) {
        RenderSettings settings;
        settings.estimator = estimator;
        settings.samples = estimator == Estimator::forward ? 2000 : 4;
        settings.seed = static_cast<std::uint64_t>(seed);
        const RenderResult result = render(compiled, settings, test::one_thread());
        bad.add(bad_pixels(result.light_field), "seed " + std::to_string(seed));
        EXPECT_TRUE(std::isfinite(result.statistics.flux));
        lit += result.statistics.flux > 0;
      }
      ++rendered;
    } catch (const Error& error) {
      EXPECT_FALSE(std::string(error.what()).empty());
      ++refused;
    }
  }
  // The generator must not degenerate into scenes that are refused or dark.
  EXPECT_GT(rendered, kScenes / 5) << refused << " refused";
  EXPECT_GT(lit, kScenes / 10);
}

}  // namespace
}  // namespace plenoflame::scene_fuzz_test
