#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "core/inverse/glowing_grid.h"
#include "inverse/displaced_camera.h"
#include "plenoflame/inverse/flame_estimate.h"
#include "plenoflame/inverse/reconstruction.h"
#include "plenoflame/lightfield/smoothed_error.h"
#include "plenoflame/render/render.h"
#include "plenoflame/sampling/noise.h"
#include "support/length.h"
#include "support/small_scene.h"

/// Families of flames that are drawn at random, their pictures, and what a reconstruction says of
/// them beside what they are: errors against stated deviations.
namespace plenoflame::test {

enum class Family { candle, jet, blobs, turbulent };

inline constexpr Family kFamilies[] = {Family::candle, Family::jet, Family::blobs,
                                       Family::turbulent};

inline std::string name_of(Family family) {
  static const char* const names[] = {"candle", "lifted jet", "blobs", "turbulent"};
  return names[static_cast<int>(family)];
}

/// The flames are within this distance of the upright axis through (1 m, 0, 0), and of its middle.
inline constexpr double kFlameRadius = 4.5e-3, kFlameHalfHeight = 9e-3;

/// Light at a place in units of the flame's size: distance from the axis and height are below 1.
using Flame = std::function<double(Vec3)>;

/// [K] of the light that is 1 in the flame's units, where its absorption is known.
inline constexpr double kHottest = 1900;

inline double gone_at_the_ends(double height) {
  const double s = std::clamp((1 - std::fabs(height)) / 0.15, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

/// A bright sheet around a dark core that closes at the tip.
inline Flame candle_flame(NoiseStream& random) {
  const auto between = [&](double a, double b) { return a + (b - a) * random.uniform(); };
  const double radius = between(0.35, 0.55), width = between(0.18, 0.3), tip = between(0.5, 0.8),
               base = -between(0.6, 0.8), shape = between(0.3, 0.6), core = between(0, 0.4);
  return [=](Vec3 p) {
    const double r = std::hypot(p.x, p.y), s = std::clamp((p.z - base) / (tip - base), 0.0, 1.0);
    const double sheet = radius * std::pow(4 * s * (1 - s), shape) * (1.2 - 0.6 * s);
    const double ends = std::clamp(s / 0.2, 0.0, 1.0) * std::clamp((1 - s) / 0.25, 0.0, 1.0);
    return ends * (std::exp(-std::pow((r - sheet) / width, 2)) +
                   core / (1 + std::exp(std::clamp((r - sheet) / (0.4 * width), -50.0, 50.0))));
  };
}

/// Hollow where it begins, above the burner; wider and fuller upwards.
inline Flame jet_flame(NoiseStream& random) {
  const auto between = [&](double a, double b) { return a + (b - a) * random.uniform(); };
  const double lift = -between(0.3, 0.6), width = between(0.25, 0.35), growth = between(0.1, 0.25),
               hollow = between(0.3, 0.9), length = between(0.5, 0.9);
  return [=](Vec3 p) {
    const double r = std::hypot(p.x, p.y), z = p.z - lift, up = std::max(z, 0.0);
    const double wide = width + growth * up;
    const double begun = 1 / (1 + std::exp(-std::clamp(z / 0.08, -50.0, 50.0)));
    return begun * std::exp(-std::pow(up / (1.2 * length), 2)) * std::exp(-std::pow(r / wide, 2)) *
           (1 - hollow * std::exp(-up / (0.5 * length)) * std::exp(-std::pow(2 * r / wide, 2))) *
           gone_at_the_ends(p.z);
  };
}

/// @param round rings in place of balls
inline Flame blobs_flame(NoiseStream& random, bool round) {
  const auto between = [&](double a, double b) { return a + (b - a) * random.uniform(); };
  struct Blob {
    Vec3 centre;
    double size, light;
  };
  std::vector<Blob> blobs;
  for (int k = 0; k < 5; ++k)
    blobs.push_back({{round ? between(0, 0.55) : between(-0.45, 0.45),
                      round ? 0 : between(-0.45, 0.45), between(-0.55, 0.55)},
                     between(0.2, 0.35),
                     between(0.4, 1)});
  constexpr double kAspect = kFlameHalfHeight / kFlameRadius;
  return [=](Vec3 p) {
    if (round) p = {std::hypot(p.x, p.y), 0, p.z};
    double light = 0;
    for (const Blob& blob : blobs) {
      const Vec3 d = p - blob.centre;
      light += blob.light * std::exp(-(d.x * d.x + d.y * d.y + kAspect * kAspect * d.z * d.z) /
                                     (2 * blob.size * blob.size));
    }
    return light;
  };
}

/// The exponential of waves whose spectrum falls by the power of 5/3, in an envelope.
inline Flame turbulent_flame(NoiseStream& random, bool round) {
  const auto between = [&](double a, double b) { return a + (b - a) * random.uniform(); };
  struct Wave {
    Vec3 k;
    double phase, size;
  };
  constexpr int kWaves = 60;
  std::vector<Wave> waves;
  double squares = 0;
  for (int n = 0; n < kWaves; ++n) {
    const double k = std::exp(between(std::log(2.5), std::log(10.0)));
    const double z = between(-1, 1), turn = between(0, 2 * std::numbers::pi);
    const double across = std::sqrt(1 - z * z);
    const Vec3 direction = round ? Vec3{std::cos(turn), 0, std::sin(turn)}
                                 : Vec3{across * std::cos(turn), across * std::sin(turn), z};
    waves.push_back({k * direction, between(0, 2 * std::numbers::pi), std::pow(k, -1.0 / 3)});
    squares += 0.5 * std::pow(k, -2.0 / 3);
  }
  const double wide = between(0.4, 0.6), high = between(0.4, 0.6), middle = between(-0.2, 0.2);
  constexpr double kAspect = kFlameHalfHeight / kFlameRadius, kStrength = 0.6;
  return [=](Vec3 p) {
    const double r = std::hypot(p.x, p.y);
    if (round) p = {r, 0, p.z};
    double sum = 0;
    for (const Wave& wave : waves)
      sum += wave.size *
             std::cos(wave.k.x * p.x + wave.k.y * p.y + kAspect * wave.k.z * p.z + wave.phase);
    return std::exp(kStrength * sum / std::sqrt(squares) - std::pow(r / wide, 4) -
                    std::pow((p.z - middle) / high, 4));
  };
}

inline Flame draw_flame(Family family, bool round, std::uint64_t seed) {
  NoiseStream random(seed, static_cast<std::uint64_t>(family));
  switch (family) {
    case Family::candle:
      return candle_flame(random);
    case Family::jet:
      return jet_flame(random);
    case Family::blobs:
      return blobs_flame(random, round);
    case Family::turbulent:
      break;
  }
  return turbulent_flame(random, round);
}

struct FamilyTrial {
  Family family = Family::candle;
  bool rings = true;         ///< else voxels
  int cameras = 1;           ///< 1, 3 or 6
  double electrons = 20000;  ///< of the brightest pixel
  std::uint64_t seed = 1;
  /// [1/m] known and the same everywhere; above 0 temperatures follow.
  double absorption = 0;
  /// Wrong in the first camera of the model, or in the absorption that it takes for known, by so
  /// much.
  SuspectKind wrong = SuspectKind::exposure;
  double by = 0;
  double coarser = 1;  ///< the places by so much
  double wider = 1;    ///< the voxels' block than the flame, across
};

/// Errors of what is lit, above 5 % of the brightest.
struct Errors {
  double error = 0;         ///< 2-norm, relative
  double stated = 0;        ///< the same of the deviations
  double pulls = 0;         ///< RMS of (found - true) / stated
  double covered = 0;       ///< share within 1.96 stated deviations
  double covered_once = 0;  ///< share within one
};
struct FamilyOutcome {
  Errors emission, temperature;
  double chi_squared = 0;
  std::vector<Suspect> suspects;
  double grid_share = 0;
};

inline Errors errors_of(const std::vector<double>& found, const std::vector<double>& stated,
                        const std::vector<double>& truth, const std::vector<char>& lit) {
  Errors result;
  double away = 0, squares = 0, all = 0, count = 0;
  for (std::size_t j = 0; j < truth.size(); ++j) {
    if (!lit[j]) continue;
    const double error = found[j] - truth[j], pull = stated[j] > 0 ? error / stated[j] : 1e3;
    away += error * error;
    squares += stated[j] * stated[j];
    all += truth[j] * truth[j];
    result.pulls += pull * pull;
    result.covered += std::fabs(pull) < 1.96;
    result.covered_once += std::fabs(pull) < 1;
    ++count;
  }
  result.error = std::sqrt(away / all);
  result.stated = std::sqrt(squares / all);
  result.pulls = std::sqrt(result.pulls / count);
  result.covered /= count;
  result.covered_once /= count;
  return result;
}

/// A frame of a sensor: shot noise and read noise of 5 electrons.
/// @param electron [W] of one electron
inline Measurement frame_of(const LightFieldChannel& picture, double electron, std::uint64_t seed) {
  constexpr double kReadNoise = 5;
  const Image &flux = picture.flux, of_rays = smoothed_error(flux, picture.standard_error);
  Measurement m;
  m.window = {0, 0, flux.width, flux.height};
  m.flux = m.deviation = Image(flux.width, flux.height);
  m.electron = electron;
  for (std::size_t k = 0; k < flux.pixels.size(); ++k) {
    NoiseStream noise(seed, k);
    const double electrons = noise.poisson(static_cast<double>(flux.pixels[k]) / electron) +
                             kReadNoise * noise.gaussian();
    const double deviation = std::sqrt(std::max(electrons, 0.0) + kReadNoise * kReadNoise);
    m.flux.pixels[k] = static_cast<float>(electron * electrons);
    m.deviation.pixels[k] = static_cast<float>(
        std::hypot(electron * deviation, static_cast<double>(of_rays.pixels[k])));
  }
  return m;
}

/// Rings, or voxels, whose steps are some times smaller. @return the number of samples along each
/// axis of voxels that fill the flames' space
inline GlowingGrid fine_grid(const FamilyTrial& trial, const Flame& flame, double step_across,
                             double step_up) {
  GlowingGrid g;
  const auto samples = [](double length, double step) {
    return static_cast<int>(std::lround(length / step)) + 1;
  };
  g.count = {samples(2 * kFlameRadius, step_across), samples(2 * kFlameRadius, step_across),
             samples(2 * kFlameHalfHeight, step_up)};
  g.map.linear = {{{{step_across, 0, 0}, {0, step_across, 0}, {0, 0, step_up}}}};
  g.map.translation = {1 - kFlameRadius, -kFlameRadius, -kFlameHalfHeight};
  for (int i = 0; i < g.count[0]; ++i)
    for (int j = 0; j < g.count[1]; ++j)
      for (int k = 0; k < g.count[2]; ++k)
        g.emission.push_back(
            flame({-1 + i * step_across / kFlameRadius, -1 + j * step_across / kFlameRadius,
                   -1 + k * step_up / kFlameHalfHeight}));
  g.absorption.assign(g.emission.size(), trial.absorption);
  return g;
}

/// A trial's unknowns and the steps between their places.
struct FamilyGrid {
  std::unique_ptr<Unknowns> unknowns;
  double across = 0, up = 0;  ///< [m]
  double finer = 4;           ///< the grid of the pictures, by so much
};

inline FamilyGrid family_grid(const FamilyTrial& trial) {
  FamilyGrid result;
  result.finer = 4 * trial.coarser;
  if (trial.rings) {
    RingGrid grid;
    grid.rings = static_cast<int>(14 / trial.coarser);
    grid.heights = static_cast<int>(22 / trial.coarser);
    result.across = grid.radial_step = kFlameRadius / grid.rings;
    result.up = grid.height_step = 2 * kFlameHalfHeight / (grid.heights - 1);
    grid.base = {1, 0, -kFlameHalfHeight};
    result.unknowns = make_ring_unknowns(grid);
    return result;
  }
  const double half = trial.wider * kFlameRadius;
  const int voxels = static_cast<int>(14 * trial.wider / trial.coarser),
            heights = static_cast<int>(16 / trial.coarser);
  const double across = result.across = 2 * half / voxels,
               up = result.up = 2 * kFlameHalfHeight / heights;
  RegularLattice lattice;
  lattice.count = {voxels, voxels, heights};
  lattice.index_to_world.linear = {{{{across, 0, 0}, {0, across, 0}, {0, 0, up}}}};
  lattice.index_to_world.translation = {1 - half + 0.5 * across, -half + 0.5 * across,
                                        -kFlameHalfHeight + 0.5 * up};
  result.unknowns = make_voxel_unknowns(lattice);
  return result;
}

/// The cameras' scene without flames: one of some that stand around it.
inline Scene family_scene(int camera, int of) {
  const double turn = camera * std::numbers::pi / std::max(of, 2);
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.camera.sensor = {40, 60, 0.25e-3};
  scene.camera.position = {1 - std::cos(turn), -std::sin(turn), 0};
  scene.camera.look_direction = {std::cos(turn), std::sin(turn), 0};
  return scene;
}

inline std::vector<CompiledScene> family_scenes(const FamilyTrial& trial,
                                                const ChannelSpec& channel,
                                                const GlowingGrid& grid) {
  std::vector<CompiledScene> scenes;
  for (int n = 0; n < trial.cameras; ++n) {
    Scene scene = family_scene(n, trial.cameras);
    scene.flames = {glowing_flame(channel.wavelength)};
    scene.channels = {channel};
    scenes.push_back(compile(scene, glowing_loader(grid)));
  }
  return scenes;
}

/// A trial's unknowns, cameras and pictures. It stays where it is: the input points into it.
struct FamilyProblem {
  explicit FamilyProblem(const FamilyTrial& trial);
  FamilyProblem(const FamilyProblem&) = delete;
  FamilyProblem& operator=(const FamilyProblem&) = delete;

  SourceFunction source;
  Flame flame;  ///< [W/(m^3 sr)]
  std::unique_ptr<Unknowns> unknowns;
  std::vector<CompiledScene> scenes;
  std::optional<CompiledScene> displaced;  ///< the first one as the model has it
  ReconstructionInput input;
};

inline FamilyProblem::FamilyProblem(const FamilyTrial& trial) {
  const ChannelSpec channel{"650nm", ChannelKind::band, 650e-9, 10e-9};
  source = SourceFunction::band(channel.wavelength, channel.width);
  // [W/(m^3 sr)] of the light that is 1 in the flame's units.
  const double unit = trial.absorption > 0 ? trial.absorption * source(kHottest) : 1000;
  const Flame plain = draw_flame(trial.family, trial.rings, trial.seed);
  flame = [=](Vec3 p) { return unit * plain(p); };
  FamilyGrid grid = family_grid(trial);
  unknowns = std::move(grid.unknowns);
  scenes = family_scenes(trial, channel,
                         fine_grid(trial, flame, grid.across / grid.finer, grid.up / grid.finer));
  input.unknowns = unknowns.get();
  if (trial.absorption > 0) input.absorption.assign(unknowns->size(), trial.absorption);
  for (std::size_t v = 0; v < scenes.size(); ++v) {
    RenderSettings how;
    how.samples = 256;
    how.control_variate = false;  // it takes longer than such small pictures
    how.seed = 7000 + trial.seed;
    const RenderResult picture = render(scenes[v], how);
    const LightFieldChannel& light = picture.light_field.channels[0];
    const double brightest = static_cast<double>(std::ranges::max(light.flux.pixels));
    input.views.push_back({&scenes[v], {}});
    input.measurements.push_back(
        frame_of(light, brightest / trial.electrons, 100 * trial.seed + v));
  }
  displaced.emplace(displaced_scene(scenes[0], trial.wrong, -trial.by));
  input.views[0].scene = &*displaced;
  if (trial.wrong == SuspectKind::absorption)
    for (double& value : input.absorption) value /= 1 + trial.by;
  if (trial.wrong == SuspectKind::exposure)
    for (float& value : input.measurements[0].flux.pixels)
      value *= static_cast<float>(1 + trial.by);
}

/// The number of unknowns that are resolved, which deviations need, by few probes in short tests.
inline ReconstructionSettings usual_settings() {
  ReconstructionSettings settings;
  if (!in_full()) settings.probes = 4;
  return settings;
}

inline ReconstructionSettings family_settings(const FamilyTrial& trial,
                                              ReconstructionSettings settings = usual_settings()) {
  settings.rays.samples = static_cast<int>(64 * std::max(1.0, trial.coarser * trial.coarser));
  settings.rays.seed = 500 + trial.seed;
  return settings;
}

inline FamilyOutcome reconstruct_family(const FamilyTrial& trial,
                                        const ReconstructionSettings& settings = usual_settings()) {
  const FamilyProblem problem(trial);
  const auto& [source, flame, unknowns, scenes, displaced, input] = problem;
  const Reconstruction found = reconstruct(input, family_settings(trial, settings));

  const FlameEstimate estimate = estimate_flame(found, *unknowns, input.absorption, source);
  std::vector<double> emission, temperature;
  for (std::size_t j = 0; j < unknowns->size(); ++j) {
    const Vec3 p = unknowns->place(j);
    emission.push_back(
        flame({(p.x - 1) / kFlameRadius, p.y / kFlameRadius, p.z / kFlameHalfHeight}));
    if (trial.absorption > 0)
      temperature.push_back(temperature_of(source, emission.back() / trial.absorption));
  }
  const double brightest = std::ranges::max(emission);
  std::vector<char> lit;
  for (const double value : emission) lit.push_back(value > 0.05 * brightest);
  FamilyOutcome outcome;
  outcome.emission = errors_of(estimate.emission, estimate.emission_deviation, emission, lit);
  if (trial.absorption > 0)
    outcome.temperature =
        errors_of(estimate.temperature, estimate.temperature_deviation, temperature, lit);
  outcome.suspects = found.suspects;
  outcome.grid_share = found.grid_share;
  outcome.chi_squared = found.chi_squared;
  return outcome;
}

/// Means over trials, of squares where they are deviations.
struct Totals {
  double pulls = 0, covered = 0, covered_once = 0, error = 0, stated = 0;
  int count = 0;

  void add(const Errors& errors) {
    pulls += errors.pulls * errors.pulls;
    covered += errors.covered;
    covered_once += errors.covered_once;
    error += errors.error * errors.error;
    stated += errors.stated * errors.stated;
    ++count;
  }
  Errors mean() const {
    return {std::sqrt(error / count), std::sqrt(stated / count), std::sqrt(pulls / count),
            covered / count, covered_once / count};
  }
};

inline void print(const std::string& what, const Errors& errors) {
  std::printf("| %s | %.1f | %.1f | %.2f | %.0f | %.0f |\n", what.c_str(), 100 * errors.error,
              100 * errors.stated, errors.pulls, 100 * errors.covered_once, 100 * errors.covered);
}

inline void expect_true(const Totals& totals) {
  const Errors mean = totals.mean();
  EXPECT_GT(mean.pulls, 0.7);
  EXPECT_LT(mean.pulls, 1.4);
  EXPECT_GT(mean.covered, 0.88);
}

}  // namespace plenoflame::test
