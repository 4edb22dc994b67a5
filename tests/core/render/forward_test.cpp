#include <gtest/gtest.h>

#include <stop_token>
#include <vector>

#include "plenoflame/base/constants.h"
#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::forward_test {
namespace {

RenderSettings forward_settings(int samples, int replicates = 8) {
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  settings.samples = samples;
  settings.replicates = replicates;
  return settings;
}

CompiledScene array_scene() {
  return compile(small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real)));
}

// The power that a point sends into an ideal lens' pupil: emission times solid angle, and the
// measurement of radiance on the sensor makes cos^4 / cos^4 of it (docs/theory/forward.md). On the
// axis both integrals over the pupil are elementary: of cos dA / d^2 cos_s^4 / cos^4 over rings.
TEST(Forward, PointOnTheAxis) {
  MainLensSpec lens;
  lens.model = LensModel::ideal;
  lens.focal_length = 0.1;
  lens.diameter = 0.08;
  Scene scene = small_scene(lens, {});
  const double radius = 1e-5, kappa = 1e-3, distance = 0.3, temperature = 1500;
  scene.camera.focus.object_distance = distance;
  scene.flames[0].position = {distance, 0, 0};
  scene.flames[0].layers = {{"point", {}, {radius, radius, radius}, temperature, kappa}};
  const RenderResult result = render(compile(scene), forward_settings(100000));
  const double image = 1 / (1 / lens.focal_length - 1 / distance);
  // dOmega cos_s^4 / cos_o^4 = 2 pi h dh cos_o^3 / d^2 * cos_s^4 / cos_o^4, by Simpson's rule.
  const auto ring = [&](double h) {
    const double cos_o = distance / std::hypot(distance, h), cos_s = image / std::hypot(image, h);
    return 2 * constants::pi * h * std::pow(cos_s, 4) / (cos_o * distance * distance);
  };
  double integral = 0;
  const int n = 2000;
  for (int i = 0; i <= n; ++i)
    integral += (i == 0 || i == n ? 1 : i % 2 ? 4 : 2) * ring(0.04 * i / n);
  integral *= 0.04 / n / 3;
  const double volume = 4.0 / 3 * constants::pi * radius * radius * radius;
  const double expected = volume * kappa * constants::stefan_boltzmann * std::pow(temperature, 4) /
                          constants::pi * integral;
  double flux = 0, variance = 0;
  const LightFieldChannel& channel = result.light_field.channels[0];
  for (std::size_t i = 0; i < channel.flux.pixels.size(); ++i) {
    flux += static_cast<double>(channel.flux.pixels[i]);
    variance += std::pow(static_cast<double>(channel.standard_error.pixels[i]), 2);
  }
  EXPECT_LT(std::sqrt(variance), 0.005 * expected);
  EXPECT_TRUE(within_standard_errors(flux, expected, std::sqrt(variance), 4));
}

TEST(Forward, SameImageForAnyNumberOfThreads) {
  const CompiledScene scene = array_scene();
  Execution execution;
  execution.threads = 1;
  const RenderResult one = render(scene, forward_settings(200001), execution);
  for (const int threads : {2, 7}) {
    execution.threads = threads;
    const RenderResult many = render(scene, forward_settings(200001), execution);
    EXPECT_EQ(one.light_field.channels[0].flux.pixels, many.light_field.channels[0].flux.pixels);
    EXPECT_EQ(one.light_field.channels[0].standard_error.pixels,
              many.light_field.channels[0].standard_error.pixels);
    EXPECT_EQ(one.statistics.rays, many.statistics.rays);
  }
  RenderSettings other = forward_settings(200001);
  other.seed = 2;
  EXPECT_NE(one.light_field.channels[0].flux.pixels,
            render(scene, other).light_field.channels[0].flux.pixels);
}

TEST(Forward, WindowShowsTheSamePixels) {
  const CompiledScene scene = array_scene();
  RenderSettings settings = forward_settings(100000);
  const RenderResult whole = render(scene, settings);
  settings.window = {25, 20, 13, 17};
  const RenderResult part = render(scene, settings);
  float largest = 0;
  for (int row = 0; row < 17; ++row)
    for (int column = 0; column < 13; ++column) {
      const float value = part.light_field.channels[0].flux.at(column, row);
      EXPECT_EQ(value, whole.light_field.channels[0].flux.at(column + 25, row + 20));
      largest = std::max(largest, value);
    }
  EXPECT_GT(largest, 0.0f);
}

TEST(Forward, StoppedRunIsASmallerRun) {
  const CompiledScene scene = array_scene();
  Execution execution;
  execution.threads = 2;
  std::stop_source stop;
  execution.stop = stop.get_token();
  execution.progress = [&](const Progress& progress) {
    EXPECT_GT(progress.rays, 0);
    stop.request_stop();
  };
  const RenderResult stopped = render(scene, forward_settings(4000000), execution);
  EXPECT_FALSE(stopped.statistics.complete);
  EXPECT_FALSE(stopped.light_field.complete);
  EXPECT_LT(stopped.light_field.samples, 4000000);
  const RenderResult smaller =
      render(scene, forward_settings(static_cast<int>(stopped.light_field.samples)));
  EXPECT_TRUE(smaller.statistics.complete);
  EXPECT_EQ(smaller.light_field.channels[0].flux.pixels,
            stopped.light_field.channels[0].flux.pixels);
}

TEST(Forward, SaysWhatItDid) {
  const RenderResult result = render(array_scene(), forward_settings(50000));
  EXPECT_EQ(result.light_field.estimator, "forward");
  EXPECT_EQ(result.light_field.samples, 50000);
  EXPECT_EQ(result.statistics.rays, 50000);
  EXPECT_GT(result.statistics.rays_reached, 0);
  EXPECT_LT(result.statistics.rays_reached, 50000);
}

// Each estimate of what a target takes is above the one before, as long as the picture gains
// pixels: the share that is shown goes by them all the same.
TEST(Forward, ProgressToATarget) {
  RenderSettings settings = forward_settings(100000000, 4);
  settings.target_error = 0.05;
  std::vector<Progress> reports;
  Execution execution;
  execution.threads = 1;
  execution.progress = [&](const Progress& progress) { reports.push_back(progress); };
  const RenderResult result = render(array_scene(), settings, execution);
  ASSERT_TRUE(result.statistics.target_reached);
  const double all = result.statistics.rays;
  int in_the_middle = 0;
  for (std::size_t i = 1; i < reports.size(); ++i) {
    EXPECT_GE(reports[i].fraction, reports[i - 1].fraction);
    const double done = reports[i].rays / all;
    if (done < 0.2 || done > 0.9) continue;
    ++in_the_middle;
    EXPECT_GT(reports[i].fraction, 0.5 * done);
    EXPECT_LT(reports[i].fraction, 2 * done);
  }
  EXPECT_GT(in_the_middle, 0);
  EXPECT_EQ(reports.back().fraction, 1);
}

}  // namespace
}  // namespace plenoflame::test::forward_test
