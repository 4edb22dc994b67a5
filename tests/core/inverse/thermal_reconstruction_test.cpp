// Temperatures and absorptions back from fluxes of known ones. Tests of deviations, bounds and
// stops take those of the model that is solved (input()): they are about its algebra. How near the
// truth results are is told of a flame on rings of a quarter of the width along other rays
// (finer_input()), whose error counts as noise.
#include "plenoflame/inverse/thermal_reconstruction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stop_token>

#include "plenoflame/base/error.h"
#include "plenoflame/inverse/thermal_model.h"
#include "plenoflame/sampling/noise.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::thermal_reconstruction_test {
namespace {

/// A round flame in front of one camera of two channels; rings are 0.5 mm wide.
struct RoundFlame {
  static constexpr int kRings = 8, kHeights = 8;
  std::vector<CompiledScene> scenes;
  std::unique_ptr<Unknowns> unknowns, finer;  ///< the finer ones fill the same space
  /// [K] and logarithms of 1/m at the finer unknowns; both fade where the others do.
  std::vector<double> temperature, absorption, finer_values;
  ThermalSettings settings;

  explicit RoundFlame(double thickest) {
    Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
    scene.camera.sensor = {40, 60, 0.25e-3};
    scene.channels = {{"650nm", ChannelKind::band, 650e-9, 10e-9},
                      {"850nm", ChannelKind::band, 850e-9, 10e-9}};
    scenes.push_back(compile(scene));
    RingGrid grid;
    grid.base = {1, 0, -6e-3};
    grid.radial_step = 0.5e-3;
    grid.height_step = 1.7e-3;
    grid.rings = kRings;
    grid.heights = kHeights;
    unknowns = make_ring_unknowns(grid);
    const auto temperature_at = [](Vec3 p) {
      const double r = std::hypot(p.x - 1, p.y) / 4e-3, z = p.z / 6e-3;
      return 1500 + 250 * std::exp(-6 * (r - 0.5) * (r - 0.5)) + 60 * z;
    };
    const auto absorption_at = [thickest](Vec3 p) {
      const double r = std::hypot(p.x - 1, p.y) / 4e-3;
      return thickest * (0.35 + 0.65 * std::exp(-5 * (r - 0.6) * (r - 0.6)));
    };
    for (std::size_t j = 0; j < unknowns->size(); ++j) {
      temperature.push_back(temperature_at(unknowns->place(j)));
      absorption.push_back(absorption_at(unknowns->place(j)));
    }
    const double step = grid.radial_step;
    grid.radial_step /= 4;
    grid.height_step /= 4;
    grid.rings *= 4;
    grid.heights = 4 * (grid.heights - 1) + 1;
    finer = make_ring_unknowns(grid);
    const std::size_t n = finer->size();
    finer_values.resize(2 * n);
    for (std::size_t j = 0; j < n; ++j) {
      const Vec3 p = finer->place(j);
      const double edge = std::min(1.0, kRings - std::hypot(p.x - 1, p.y) / step);
      finer_values[j] = edge * temperature_at(p);
      finer_values[n + j] = std::log(edge * absorption_at(p));
    }
    settings.linear.rays.samples = 16;
    settings.linear.iterations = 200;
    settings.linear.draws = 0;
    settings.linear.probes = 0;
    settings.linear.ray_noise = false;  // the pictures are made of the same rays
    settings.linear.support = false;
  }

  /// Fluxes of the model that is solved, along its rays.
  ThermalInput input(double noise, std::uint64_t seed = 3) const {
    std::vector<double> x = temperature;
    for (const double kappa : absorption) x.push_back(std::log(kappa));
    return measured(*unknowns, x, settings.linear.rays, noise, seed);
  }
  /// Fluxes of the finer flame.
  ThermalInput finer_input(double noise) const {
    return measured(*finer, finer_values, settings.linear.rays, noise, 3);
  }
  ThermalInput measured(const Unknowns& shining, const std::vector<double>& x,
                        const CameraRaySettings& all, double noise, std::uint64_t seed) const {
    ThermalInput in;
    in.unknowns = unknowns.get();
    in.views = {{&scenes[0], {}}};
    const SensorSpec& sensor = scenes[0].scene.camera.sensor;
    for (std::size_t c = 0; c < 2; ++c) {
      ThermalPictures pictures;
      pictures.channel = static_cast<int>(c);
      pictures.source = channel_source(scenes[0].scene, c);
      pictures.absorption_ratio = c == 0 ? 1 : 650.0 / 850;
      // Each channel has rays of its own.
      CameraRaySettings how = all;
      how.seed += c;
      const CameraRays rays = draw_camera_rays(in.views, shining.bounds(), how);
      ThermalModel model;
      model.unknowns = &shining;
      model.channels = {{&rays, pictures.source, pictures.absorption_ratio}};
      const std::vector<double> b = thermal_fluxes(model, x);
      double largest = 0;
      for (const double value : b) largest = std::max(largest, value);
      Measurement m;
      m.window = {0, 0, sensor.columns, sensor.rows};
      m.flux = Image(sensor.columns, sensor.rows);
      m.deviation = Image(sensor.columns, sensor.rows, static_cast<float>(noise * largest));
      for (std::size_t i = 0; i < b.size(); ++i)
        m.flux.at(rays.rows[i].column, rays.rows[i].row) =
            static_cast<float>(b[i] + noise * largest * NoiseStream(seed + c, i).gaussian());
      pictures.measurements.push_back(std::move(m));
      in.channels.push_back(std::move(pictures));
    }
    return in;
  }

  /// RMS over what shines, relative.
  double error(const std::vector<double>& found, const std::vector<double>& truth) const {
    double sum = 0, count = 0;
    for (std::size_t j = 0; j < truth.size(); ++j) {
      // The innermost ring and the ends are hardly seen.
      const std::size_t ring = j / kHeights, height = j % kHeights;
      if (ring < 1 || ring > 6 || height < 1 || height > 6) continue;
      sum += std::pow(found[j] / truth[j] - 1, 2);
      ++count;
    }
    return std::sqrt(sum / count);
  }
};

// Temperatures at their bound do not move with the noise, and neither does their light.
TEST(ThermalReconstruction, WhatIsHeldAtABoundHasNoDeviation) {
  RoundFlame flame(100);
  ThermalInput input = flame.input(0.002);
  input.channels.resize(1);
  input.absorption = flame.absorption;
  flame.settings.linear.draws = 4;
  flame.settings.linear.strength = 1e-3;
  flame.settings.highest_temperature = 1650;
  const FlameEstimate found = reconstruct_thermal(input, flame.settings).estimate;
  std::size_t held = 0;
  for (std::size_t j = 0; j < found.temperature.size(); ++j) {
    const bool at_bound = found.temperature[j] >= 1650 * (1 - 1e-12);
    held += at_bound;
    EXPECT_EQ(found.temperature_deviation[j] > 0, !at_bound) << j;
    EXPECT_EQ(found.emission_deviation[j] > 0, !at_bound) << j;
  }
  EXPECT_GT(held, 5u);
  EXPECT_LT(held, found.temperature.size());
}

// Known absorption, thick enough that the far side is half hidden: one channel tells temperatures.
// Fails when the absorption of the wrong side counts.
TEST(ThermalReconstruction, TemperaturesOfKnownAbsorption) {
  RoundFlame flame(100);
  ThermalInput input = flame.finer_input(0.005);
  input.channels.resize(1);
  input.absorption = flame.absorption;
  const ThermalReconstruction found = reconstruct_thermal(input, flame.settings);
  EXPECT_LT(flame.error(found.estimate.temperature, flame.temperature), 0.015);
  // These rings cannot bend as the finer ones do: the best of all strengths leaves 1.1.
  EXPECT_TRUE(relative(found.figures.chi_squared, 1.1, 0.1));
  EXPECT_EQ(found.estimate.absorption, flame.absorption);
  EXPECT_TRUE(found.estimate.absorption_deviation.empty());
  EXPECT_EQ(found.figures.residual.size(), 1u);
  EXPECT_GT(found.figures.strength, 0);
  EXPECT_FALSE(found.figures.strength_at_end);
}

// Two channels tell both, thin and thick; what the two have in common is the emission, which is
// known better than either. One temperature everywhere would err by 4 %. Fluxes of the model come
// back nearer to the truth than those of the finer flame. Fails when the second channel's
// absorption is that of the first.
TEST(ThermalReconstruction, TemperatureAndAbsorptionOfTwoChannels) {
  for (const double thickest : {20.0, 150.0}) {
    RoundFlame flame(thickest);
    for (const bool finer : {false, true}) {
      const ThermalReconstruction found =
          reconstruct_thermal(finer ? flame.finer_input(0.01) : flame.input(0.001), flame.settings);
      EXPECT_LT(flame.error(found.estimate.temperature, flame.temperature), finer ? 0.025 : 0.02)
          << thickest;
      EXPECT_LT(flame.error(found.estimate.absorption, flame.absorption), 0.2) << thickest;
      EXPECT_TRUE(relative(found.figures.chi_squared, 1, 0.1)) << thickest;
      EXPECT_EQ(found.figures.explained.size(), 2u);
    }
  }
}

// The scatter of repeated measurements is a part of the deviations, in squares; the rest is what
// the penalty may take away.
TEST(ThermalReconstruction, DeviationsHoldTheScatterOfRepeatedMeasurements) {
  RoundFlame flame(60);
  flame.settings.linear.strength = 1e-6;
  flame.settings.linear.draws = flame.settings.linear.probes = 30;
  const ThermalReconstruction stated = reconstruct_thermal(flame.input(0.0005), flame.settings);
  flame.settings.linear.draws = flame.settings.linear.probes = 0;
  const std::size_t n = flame.unknowns->size();
  std::vector<double> sum(n), squares(n), sum_k(n), squares_k(n);
  constexpr int kRuns = 10;
  for (int run = 0; run < kRuns; ++run) {
    ThermalInput input = flame.input(0.0005, 100 + 2 * static_cast<std::uint64_t>(run));
    input.start_temperature = stated.estimate.temperature;
    input.start_absorption = stated.estimate.absorption;
    const ThermalReconstruction again = reconstruct_thermal(input, flame.settings);
    for (std::size_t j = 0; j < n; ++j) {
      const double t = again.estimate.temperature[j], k = again.estimate.absorption[j];
      sum[j] += t;
      squares[j] += t * t;
      sum_k[j] += k;
      squares_k[j] += k * k;
    }
  }
  // These pictures have no detail between the places: its part of the deviations is taken out.
  const FlameEstimate& estimate = stated.estimate;
  const SourceFunction source = flame.input(0.0005).channels[0].source;
  std::vector<double> light;
  for (const double t : estimate.temperature) light.push_back(source(t));
  const std::vector<double> between = errors_of_chords(*flame.unknowns, light, estimate.absorption);
  double own = 0, found = 0, own_k = 0, found_k = 0;
  for (std::size_t j = 0; j < n; ++j) {
    own -= std::pow(temperature_deviation(estimate.temperature[j], between[j], source), 2);
    own_k -= std::pow(estimate.absorption[j] * std::min(between[j] / light[j], 1.0), 2);
    own += std::pow(stated.estimate.temperature_deviation[j], 2);
    found += (squares[j] - sum[j] * sum[j] / kRuns) / (kRuns - 1);
    own_k += std::pow(stated.estimate.absorption_deviation[j], 2);
    found_k += (squares_k[j] - sum_k[j] * sum_k[j] / kRuns) / (kRuns - 1);
  }
  EXPECT_LT(found, own);
  EXPECT_GT(found, 0.2 * own);
  EXPECT_LT(found_k, own_k);
  EXPECT_GT(found_k, 0.2 * own_k);
  for (const double r : stated.resolved_temperature) EXPECT_TRUE(r >= 0 && r <= 1);
  EXPECT_GT(stated.figures.resolved_unknowns, 20);
  EXPECT_LT(stated.figures.resolved_unknowns, 2.0 * static_cast<double>(n));
}

// Around the flame there is a wide glow below the noise: of cold places where the absorption is
// known, else of thin ones. Its pixels are dark, and the deviations hold its light.
TEST(ThermalReconstruction, DeviationsOfDarkPlacesHoldTheirLight) {
  for (const bool known : {true, false}) {
    SCOPED_TRACE(known);
    RoundFlame flame(60);
    RingGrid wide;
    wide.base = {1, 0, -6e-3};
    wide.radial_step = 0.5e-3;
    wide.height_step = 1.7e-3;
    wide.rings = 14;
    wide.heights = RoundFlame::kHeights;
    flame.unknowns = make_ring_unknowns(wide);
    const std::size_t lit = flame.temperature.size(), all = flame.unknowns->size();
    flame.temperature.resize(all, known ? 1330 : 1500);
    flame.absorption.resize(all, known ? 20 : 3);
    flame.settings.linear.support = true;
    flame.settings.linear.draws = 2;
    flame.settings.linear.strength = 1e-3;
    ThermalInput input = flame.input(0.01);
    if (known) {
      input.channels.resize(1);
      input.absorption = flame.absorption;
    }
    const ThermalReconstruction found = reconstruct_thermal(input, flame.settings);
    const FlameEstimate& estimate = found.estimate;
    double dark = 0, emission = 0, other = 0;
    for (std::size_t j = lit; j < all; ++j) {
      if (found.figures.solved[j]) continue;
      ++dark;
      const double true_light =
          flame.absorption[j] * input.channels[0].source(flame.temperature[j]);
      emission += std::pow((true_light - estimate.emission[j]) / estimate.emission_deviation[j], 2);
      other += known ? std::pow((flame.temperature[j] - estimate.temperature[j]) /
                                    estimate.temperature_deviation[j],
                                2)
                     : std::pow((flame.absorption[j] - estimate.absorption[j]) /
                                    estimate.absorption_deviation[j],
                                2);
    }
    EXPECT_GT(dark, 5);
    EXPECT_LT(emission, dark);
    EXPECT_GT(emission, 0.05 * 0.05 * dark);
    EXPECT_LT(other, dark);
  }
}

/// Stops when a part of the work is done.
ThermalReconstruction stopped_at(const ThermalInput& input, const ThermalSettings& settings,
                                 double fraction) {
  std::stop_source stop;
  Execution execution;
  execution.stop = stop.get_token();
  double last = 0;
  execution.progress = [&](const Progress& progress) {
    EXPECT_GE(progress.fraction, last);
    last = progress.fraction;
    if (progress.fraction >= fraction) stop.request_stop();
  };
  return reconstruct_thermal(input, settings, execution);
}

// A stop keeps what was reached: of the first linear reconstruction the emission, with a known
// absorption the temperatures, too; later on temperatures and absorptions.
TEST(ThermalReconstruction, AStopKeepsWhatWasReached) {
  RoundFlame flame(60);
  flame.settings.linear.probes = 4;
  const ThermalInput input = flame.input(0.001);
  const ThermalReconstruction early = stopped_at(input, flame.settings, 0.021);
  EXPECT_FALSE(early.figures.complete);
  EXPECT_TRUE(early.estimate.temperature.empty());
  ASSERT_EQ(early.estimate.emission.size(), flame.unknowns->size());
  EXPECT_GT(*std::max_element(early.estimate.emission.begin(), early.estimate.emission.end()), 0);
  EXPECT_LT(early.figures.strength, 0);  // none was chosen

  ThermalInput known = input;
  known.channels.resize(1);
  known.absorption = flame.absorption;
  const ThermalReconstruction hot = stopped_at(known, flame.settings, 0.021);
  EXPECT_FALSE(hot.figures.complete);
  EXPECT_GT(*std::max_element(hot.estimate.temperature.begin(), hot.estimate.temperature.end()),
            300);

  const ThermalReconstruction late = stopped_at(input, flame.settings, 0.41);
  EXPECT_FALSE(late.figures.complete);
  EXPECT_EQ(late.figures.reason, StopReason::stopped);
  EXPECT_LT(flame.error(late.estimate.temperature, flame.temperature), 0.2);
  EXPECT_GT(late.figures.chi_squared, 0);
  EXPECT_LT(late.figures.resolved_unknowns, 0);
  EXPECT_LT(late.figures.strength, 0);  // the search had not ended
  // The emission is a start.
  ThermalInput again = input;
  again.start_emission = early.estimate.emission;
  flame.settings.linear.strength = 1e-3;
  flame.settings.linear.probes = 0;
  EXPECT_TRUE(reconstruct_thermal(again, flame.settings).figures.complete);
}

TEST(ThermalReconstruction, RatiosOfTwoChannelsAreTemperatures) {
  const SourceFunction red = SourceFunction::band(650e-9, 10e-9),
                       infrared = SourceFunction::band(850e-9, 10e-9);
  for (const double t : {900.0, 1500.0, 2400.0}) {
    EXPECT_TRUE(relative(
        ratio_temperature(red, infrared, 0.7, red(t) / (0.7 * infrared(t)), 300, 4000), t, 1e-9));
    EXPECT_TRUE(relative(
        ratio_temperature(infrared, red, 1.4, infrared(t) / (1.4 * red(t)), 300, 4000), t, 1e-9));
  }
  // Beyond the bounds: the nearer one.
  EXPECT_TRUE(relative(ratio_temperature(red, infrared, 1, 1e9, 300, 4000), 4000, 1e-9));
}

TEST(ThermalReconstruction, RefusesWhatCannotBeKnown) {
  RoundFlame flame(20);
  ThermalInput input = flame.input(0.01);
  input.channels.resize(1);
  EXPECT_THROW(reconstruct_thermal(input, flame.settings), UsageError);
  input.absorption = {1, 2};
  EXPECT_THROW(reconstruct_thermal(input, flame.settings), InputError);
  input = flame.input(0.01);
  input.start_temperature = flame.temperature;
  EXPECT_THROW(reconstruct_thermal(input, flame.settings), UsageError);
  input.views.clear();
  EXPECT_THROW(reconstruct_thermal(input, flame.settings), UsageError);
}

}  // namespace
}  // namespace plenoflame::test::thermal_reconstruction_test
