// Wide channels in which the same wavelengths are shared: a sphere of soot of one temperature
// against sums over thousands of wavelengths, from rays to images of both estimators.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/media/ray_list.h"
#include "plenoflame/radiometry/spectral_nodes.h"
#include "plenoflame/radiometry/spectral_response.h"
#include "plenoflame/render/ground_truth.h"
#include "plenoflame/render/ray_paths.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"
#include "render/transport/channel_sum.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"

namespace plenoflame::test::shared_wavelengths_test {
namespace {

constexpr double kRadius = 0.04, kAbsorption = 20, kReference = 650e-9, kTemperature = 1700;
constexpr Vec3 kCentre{1, 0.001, 0};
constexpr std::array<const char*, 3> kResponses{"nikon_d5100_red", "nikon_d5100_green",
                                                "nikon_d5100_blue"};

/// Red first: `first` is the number of the response that the scene has as its first channel.
Scene sooty_scene(std::size_t first = 0) {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.camera.sensor = {24, 24, 0.5e-3};
  scene.flames[0].position = kCentre;
  scene.flames[0].layers = {{"soot", {}, {kRadius, kRadius, kRadius}, kTemperature, kAbsorption}};
  scene.flames[0].spectrum.kind = SpectrumKind::soot;
  scene.flames[0].spectrum.reference = kReference;
  scene.channels.clear();
  for (std::size_t c = 0; c < kResponses.size(); ++c) {
    ChannelSpec channel;
    channel.response = kResponses[(c + first) % kResponses.size()];
    channel.name = channel.response;
    channel.kind = ChannelKind::named;
    scene.channels.push_back(channel);
  }
  return scene;
}

CompiledScene compiled_scene(std::size_t first = 0) {
  CompiledScene compiled = compile(sooty_scene(first));
  EXPECT_FALSE(compiled.mix.empty());
  bool shares = false;  // otherwise there is nothing to see here
  for (int n = 0; n < compiled.mix.nodes(); ++n)
    shares = shares || (compiled.mix.weight(0, n) > 0 && compiled.mix.weight(1, n) > 0);
  EXPECT_TRUE(shares);
  return compiled;
}

/// Sum of what(wavelength, absorption) times response and Planck's function over the wavelengths.
double over_wavelengths(const char* response,
                        const std::function<double(double absorption)>& what) {
  const SpectralResponse curve = SpectralResponse::named(response);
  constexpr int kSteps = 2000;
  const double step = (curve.longest() - curve.shortest()) / kSteps;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double w = curve.shortest() + (i + 0.5) * step;
    const double planck = 1.1910429723971884e-16 / std::pow(w, 5) /
                          std::expm1(0.014387768775039337 / (w * kTemperature));
    sum += step * curve(w) * planck * what(kAbsorption * kReference / w);
  }
  return sum;
}

/// Length of a line within the sphere [m].
double chord(Vec3 place, Vec3 direction) {
  const Vec3 beside = place - kCentre - dot(place - kCentre, direction) * direction;
  return 2 * std::sqrt(std::max(0.0, kRadius * kRadius - dot(beside, beside)));
}

void expect_radiance_of_soot(const RayPaths& paths, bool runs_towards_camera) {
  int seen = 0;
  for (std::size_t i = 0; i < paths.rays.size(); ++i) {
    const RayPath& ray = paths.rays[i];
    if (ray.status.status != RayStatus::reached) continue;
    // The part in the scene: from the object point to the front lens, or from there on.
    const std::size_t first = runs_towards_camera ? ray.first : ray.first + ray.count - 2;
    const Vec3 place = paths.vertices[first].position,
               direction = normalize(paths.vertices[first + 1].position - place);
    const double length = chord(place, direction);
    if (length < 0.3 * kRadius) continue;  // grazing: the chord hangs on the last digits
    ++seen;
    for (std::size_t c = 0; c < kResponses.size(); ++c) {
      const double expected = over_wavelengths(
          kResponses[c], [&](double absorption) { return -std::expm1(-absorption * length); });
      EXPECT_TRUE(relative(paths.radiance_of(i, c), expected, kSpectralTolerance)) << i << " " << c;
    }
    // The thickness is that of a wavelength in the middle of the first channel.
    EXPECT_GT(ray.optical_thickness, kAbsorption * length * 650 / 700);
    EXPECT_LT(ray.optical_thickness, kAbsorption * length * 650 / 560);
  }
  EXPECT_GT(seen, 10);
}

TEST(SharedWavelengths, RaysOfPixels) {
  const CompiledScene scene = compiled_scene();
  RenderSettings settings;
  settings.samples = 16;
  settings.replicates = 2;
  RayPaths paths = empty_ray_paths(scene);
  add_pixel_rays(scene, settings, {{11, 12}, {14, 9}}, one_thread(), paths);
  expect_radiance_of_soot(paths, false);
}

TEST(SharedWavelengths, RaysOfObjectPoints) {
  const CompiledScene scene = compiled_scene();
  RayPaths paths = empty_ray_paths(scene);
  add_object_rays(scene, kCentre + Vec3{2 * kRadius, 0.003, 0}, 100, paths);
  expect_radiance_of_soot(paths, true);
}

TEST(SharedWavelengths, ChiefRays) {
  const CompiledScene scene = compiled_scene();
  RayPaths paths = empty_ray_paths(scene);
  add_chief_rays(scene, paths);
  expect_radiance_of_soot(paths, false);
}

// As a medium, by which tables of radiance are made.
TEST(SharedWavelengths, SumsOfChannelsAsAMedium) {
  const CompiledScene scene = compiled_scene();
  const ChannelSum sums(*scene.medium, scene.mix);
  ASSERT_EQ(sums.channel_count(), 3);
  RayList<double> rays(kCentre);
  std::vector<double> lengths;
  for (int i = 0; i < 150; ++i) {  // more than one block of columns
    const Vec3 place = kCentre + Vec3{-0.2, 1e-4 * i, 2e-4 * i}, direction{1, 0, 0};
    rays.add(place, direction);
    lengths.push_back(chord(place, direction));
  }
  const auto seen = rays.integrate(sums);
  std::array<double, 3> emission{};
  const double absorption = sums.coefficients(kCentre, emission.data());
  EXPECT_GT(absorption, kAbsorption * 650 / 700);
  EXPECT_LT(absorption, kAbsorption * 650 / 560);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < lengths.size(); i += 7) {
      const double expected =
          over_wavelengths(kResponses[c], [&](double k) { return -std::expm1(-k * lengths[i]); });
      EXPECT_TRUE(relative(seen.radiance[c][i], expected, kSpectralTolerance)) << c << " " << i;
    }
    const double whole = over_wavelengths(kResponses[c], [](double) { return 1.0; }),
                 emitted = over_wavelengths(kResponses[c], [](double k) { return k; });
    EXPECT_TRUE(
        relative(sums.source(static_cast<int>(c), kTemperature), whole, kSpectralTolerance));
    EXPECT_TRUE(relative(emission[c], emitted, kSpectralTolerance)) << c;
  }
}

/// Flux of all pixels [W], and the variance that the light field states for it [W^2].
std::array<double, 2> total(const LightFieldChannel& channel) {
  std::array<double, 2> sum{};
  for (std::size_t i = 0; i < channel.flux.pixels.size(); ++i) {
    sum[0] += static_cast<double>(channel.flux.pixels[i]);
    sum[1] += std::pow(static_cast<double>(channel.standard_error.pixels[i]), 2);
  }
  return sum;
}

/// Weight times radiance of all rays of all pixels.
std::array<double, 3> flux_of_rays(const CompiledScene& scene, const RenderSettings& settings) {
  std::vector<Pixel> pixels;
  for (int row = 0; row < 24; ++row)
    for (int column = 0; column < 24; ++column) pixels.push_back({column, row});
  RayPaths paths = empty_ray_paths(scene);
  add_pixel_rays(scene, settings, pixels, one_thread(), paths);
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < paths.rays.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) sum[c] += paths.rays[i].weight * paths.radiance_of(i, c);
  return sum;
}

TEST(SharedWavelengths, ImagesOfBothEstimators) {
  const CompiledScene scene = compiled_scene();
  RenderSettings settings;
  settings.samples = 64;
  settings.replicates = 4;
  settings.precision = Precision::double_precision;
  const std::array<double, 3> expected = flux_of_rays(scene, settings);
  const LightField exact = render(scene, settings, one_thread()).light_field;
  settings.precision = Precision::single_precision;  // with a table of radiance, of channels
  const LightField backward = render(scene, settings, one_thread()).light_field;
  settings.estimator = Estimator::forward;
  settings.samples = 200000;
  settings.replicates = 16;
  const LightField forward = render(scene, settings, one_thread()).light_field;
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_TRUE(relative(total(exact.channels[c])[0], expected[c], 1e-6)) << c;
    const auto [b, b_variance] = total(backward.channels[c]);
    EXPECT_TRUE(relative(b, expected[c], 1e-3)) << c;
    const auto [f, f_variance] = total(forward.channels[c]);
    EXPECT_LT(std::sqrt(f_variance), 0.01 * f);
    EXPECT_TRUE(within_standard_errors(f, expected[c], std::sqrt(f_variance + b_variance), 4)) << c;
  }
}

// The depth that the light comes from, by the first channel's own wavelengths: blue sees less deep
// than red.
TEST(SharedWavelengths, DepthOfTheFirstChannel) {
  std::array<double, 3> depths{};
  for (const std::size_t first : {std::size_t{0}, std::size_t{2}}) {
    const CompiledScene scene = compiled_scene(first);
    RenderSettings settings;
    settings.samples = 2;
    LightField field = render(scene, settings, one_thread()).light_field;
    add_ground_truth(scene, field, one_thread());
    const auto layer = [&](const char* name) -> const Image& {
      return std::find_if(field.layers.begin(), field.layers.end(),
                          [&](const auto& named) { return named.first == name; })
          ->second;
    };
    // The pixel whose ray goes through the middle.
    double near = 0, length = 0, distance = 0, depth = 0;
    for (int row = 0; row < 24; ++row)
      for (int column = 0; column < 24; ++column) {
        const auto enters = static_cast<double>(layer(truth::kFirstHit).at(column, row));
        const auto leaves = static_cast<double>(layer(truth::kLastHit).at(column, row));
        if (leaves - enters <= length) continue;
        near = enters;
        length = leaves - enters;
        distance = static_cast<double>(layer(truth::kDistance).at(column, row));
        depth = static_cast<double>(layer(truth::kOpticalDepth).at(column, row));
      }
    ASSERT_GT(length, kRadius);
    const auto light = [&](double absorption) { return -std::expm1(-absorption * length); };
    // Integral of s k e^(-k s) from 0 to the length.
    const auto moment = [&](double absorption) {
      return light(absorption) / absorption - length * std::exp(-absorption * length);
    };
    const double expected =
        over_wavelengths(kResponses[first], moment) / over_wavelengths(kResponses[first], light);
    const double mean = over_wavelengths(kResponses[first], [](double k) { return k; }) /
                        over_wavelengths(kResponses[first], [](double) { return 1.0; });
    EXPECT_TRUE(relative(depth, mean * length, 2e-3)) << first;
    depths[first] = distance - near;
    EXPECT_TRUE(relative(depths[first], expected, 2e-3)) << first;
  }
  EXPECT_LT(depths[2], 0.95 * depths[0]);
}

}  // namespace
}  // namespace plenoflame::test::shared_wavelengths_test
