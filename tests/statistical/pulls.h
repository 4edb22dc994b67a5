#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "plenoflame/inverse/reconstruction.h"
#include "plenoflame/lightfield/smoothed_error.h"
#include "plenoflame/render/render.h"
#include "plenoflame/sampling/noise.h"

/// Stated deviations of a reconstruction against its errors, over pictures that the renderer makes
/// anew each time: other rays of the pictures, other noise, and other rays of the reconstruction.
namespace plenoflame::test {

struct PullExperiment {
  std::vector<const CompiledScene*> cameras;
  const Unknowns* unknowns = nullptr;
  std::vector<double> absorption;  ///< [1/m]; empty: the emission is solved for
  std::vector<double> truth;       ///< of what is solved for, at the unknowns
  ReconstructionSettings settings;
  int samples = 64;            ///< of the pictures
  double full_well = 20000;    ///< [electrons] of the brightest pixel
  double read_noise = 8;       ///< [electrons]
  double model_error = 0;      ///< of the brightest pixel, as --noise
  int runs = 8;                ///< an even number
  double bright = 0.1;         ///< unknowns above this part of the brightest are looked at
  double small_bias = 1 / 3.;  ///< in stated deviations
};

/// Pulls are (found - truth) / stated deviation. The bias is told by half of the runs and the pulls
/// by the other half: what chance adds to the one is no part of the other.
struct Pulls {
  double scatter = 0;       ///< RMS of (found - mean of the runs) / stated, over bright unknowns
  double unbiased = 0;      ///< RMS of the pulls where the bias is small
  double all = 0;           ///< RMS of the pulls of all bright unknowns
  double typical_bias = 0;  ///< median, in stated deviations
  double chi_squared = 0;   ///< per row, mean of the runs
  double error = 0;         ///< |found - truth| / |truth| by volume, of the first run
  std::size_t bright = 0, small = 0;  ///< unknowns
};

/// A frame of the sensor, of an exposure that is the same in every run.
/// @param electron [W] of one electron
inline Measurement frame_of(const LightFieldChannel& picture, const PullExperiment& how,
                            double electron, std::uint64_t seed) {
  const Image &flux = picture.flux, of_rays = smoothed_error(flux, picture.standard_error);
  Measurement m;
  m.window = {0, 0, flux.width, flux.height};
  m.flux = m.deviation = Image(flux.width, flux.height);
  m.electron = electron;
  double largest = 0;
  for (std::size_t k = 0; k < flux.pixels.size(); ++k) {
    NoiseStream noise(seed, k);
    const double electrons = noise.poisson(static_cast<double>(flux.pixels[k]) / electron) +
                             how.read_noise * noise.gaussian();
    largest = std::max(largest, electrons);
    const double deviation = std::sqrt(std::max(electrons, 0.0) + how.read_noise * how.read_noise);
    m.flux.pixels[k] = static_cast<float>(electron * electrons);
    m.deviation.pixels[k] = static_cast<float>(
        std::hypot(electron * deviation, static_cast<double>(of_rays.pixels[k])));
  }
  m.model_error = how.model_error * electron * largest;
  return m;
}

inline Pulls measure_pulls(PullExperiment how) {
  const std::size_t n = how.unknowns->size();
  std::vector<double> electron(how.cameras.size(), 0.0), stated;
  std::vector<std::vector<double>> found;
  Pulls pulls;
  const int draws = how.settings.draws;
  how.settings.probes = 0;
  for (int run = 0; run < how.runs; ++run) {
    const auto seed = static_cast<std::uint64_t>(run);
    ReconstructionInput input;
    input.unknowns = how.unknowns;
    input.absorption = how.absorption;
    for (std::size_t v = 0; v < how.cameras.size(); ++v) {
      RenderSettings render_settings;
      render_settings.samples = how.samples;
      render_settings.seed = 7000 + seed;
      const RenderResult picture = render(*how.cameras[v], render_settings);
      const LightFieldChannel& channel = picture.light_field.channels[0];
      const Image& flux = channel.flux;
      if (run == 0)
        electron[v] =
            static_cast<double>(*std::max_element(flux.pixels.begin(), flux.pixels.end())) /
            how.full_well;
      input.views.push_back({how.cameras[v], {}});
      input.measurements.push_back(frame_of(channel, how, electron[v], 100 * seed + v));
    }
    how.settings.rays.seed = 500 + seed;
    how.settings.draws = run == 0 ? draws : 0;
    const Reconstruction result = reconstruct(input, how.settings);
    if (run == 0) stated = result.deviation;
    how.settings.strength = result.strength;  // the first run's
    pulls.chi_squared += result.chi_squared / how.runs;
    found.push_back(result.values);
  }
  double away = 0, squares = 0;
  const double brightest = *std::max_element(how.truth.begin(), how.truth.end());
  std::vector<double> biases;
  double scatter = 0, unbiased = 0, all = 0;
  for (std::size_t j = 0; j < n; ++j) {
    away += how.unknowns->volume(j) * std::pow(found[0][j] - how.truth[j], 2);
    squares += how.unknowns->volume(j) * std::pow(how.truth[j], 2);
    if (!(how.truth[j] > how.bright * brightest) || !(stated[j] > 0)) continue;
    ++pulls.bright;
    double mean = 0, mean_of_even = 0;
    for (int run = 0; run < how.runs; ++run) {
      mean += found[static_cast<std::size_t>(run)][j] / how.runs;
      if (run % 2 == 0) mean_of_even += 2 * found[static_cast<std::size_t>(run)][j] / how.runs;
    }
    const double bias = std::fabs(mean_of_even - how.truth[j]) / stated[j];
    biases.push_back(bias);
    const bool is_small = bias < how.small_bias;
    pulls.small += is_small;
    for (int run = 0; run < how.runs; ++run) {
      const double value = found[static_cast<std::size_t>(run)][j];
      scatter += std::pow((value - mean) / stated[j], 2) / (how.runs - 1);
      if (run % 2 == 0) continue;
      const double pull = 2 * std::pow((value - how.truth[j]) / stated[j], 2) / how.runs;
      all += pull;
      if (is_small) unbiased += pull;
    }
  }
  std::nth_element(biases.begin(), biases.begin() + static_cast<std::ptrdiff_t>(biases.size() / 2),
                   biases.end());
  pulls.typical_bias = biases[biases.size() / 2];
  pulls.scatter = std::sqrt(scatter / static_cast<double>(pulls.bright));
  pulls.unbiased = std::sqrt(unbiased / static_cast<double>(pulls.small));
  pulls.all = std::sqrt(all / static_cast<double>(pulls.bright));
  pulls.error = std::sqrt(away / squares);
  return pulls;
}

}  // namespace plenoflame::test
