#include "inverse/thermal_start.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "inverse/part_of_progress.h"
#include "plenoflame/base/error.h"
#include "plenoflame/inverse/measurement.h"

namespace plenoflame {
namespace {

/// Below this part of the brightest emission a ratio of two says nothing of the temperature.
constexpr double kBright = 0.02;
/// Where nothing is known an unknown begins at this part of the largest.
constexpr double kFaint = 1e-3;

/// What the first channel's linear reconstruction begins with, as its values.
std::vector<double> first_samples(const ThermalInput& input) {
  std::vector<double> values = input.start_emission;
  for (std::size_t j = 0; j < values.size() && !input.absorption.empty(); ++j)
    values[j] = input.absorption[j] > 0 ? values[j] / input.absorption[j] : 0;
  return values;
}

Reconstruction linear_stage(const ThermalInput& input, const ThermalSettings& settings,
                            std::size_t channel, const Execution& execution) {
  ReconstructionInput linear;
  linear.views = input.views;
  linear.measurements = input.channels[channel].measurements;
  linear.unknowns = input.unknowns;
  linear.absorption = input.absorption;
  for (double& value : linear.absorption) value *= input.channels[channel].absorption_ratio;
  linear.support = input.support;
  ReconstructionSettings how = settings.linear;
  how.rays.channel = input.channels[channel].channel;
  how.draws = how.probes = 0;
  how.strength = -1;
  if (channel == 0)
    linear.start = first_samples(input);
  else
    how.watch = nullptr;  // one field is shown
  if (how.penalty == ReconstructionPenalty::none || !is_penalised(how.solver)) {
    how.solver = ReconstructionSolver::fista;
    how.penalty = ReconstructionPenalty::gradient;
  }
  return reconstruct(linear, how, execution);
}

/// The start within the bounds of the variables.
ThermalStart bounded(ThermalStart start, const ThermalSettings& settings) {
  for (double& t : start.temperature)
    t = std::clamp(t, settings.lowest_temperature, settings.highest_temperature);
  if (start.absorption.empty()) return start;
  const double largest = *std::max_element(start.absorption.begin(), start.absorption.end());
  for (double& kappa : start.absorption)
    kappa = std::clamp(std::max(kappa, kFaint * largest), settings.lowest_absorption,
                       settings.highest_absorption);
  return start;
}

}  // namespace

ThermalStart thermal_start(const ThermalInput& input, const ThermalSettings& settings, double share,
                           const Execution& execution) {
  ThermalStart start;
  const std::size_t n = input.unknowns->size();
  if (!input.start_temperature.empty() && !settings.linear.support && !settings.linear.ray_noise) {
    // Nothing is wanted of a linear reconstruction.
    start.temperature = input.start_temperature;
    start.absorption = input.start_absorption;
    start.solved = input.support.empty() ? std::vector<char>(n, 1) : input.support;
    return bounded(std::move(start), settings);
  }
  Reconstruction first =
      linear_stage(input, settings, 0, part_of_progress(execution, 0, 0.5 * share));
  start.complete = first.complete;
  start.solved = first.solved;
  start.rays_error = first.rays_error;
  start.explained.push_back(first.explained);
  const double brightest = *std::max_element(first.values.begin(), first.values.end());
  const SourceFunction& source = input.channels[0].source;
  if (!input.start_temperature.empty()) {
    start.temperature = input.start_temperature;
    start.absorption = input.start_absorption;
  } else if (!start.complete) {
    // Nothing to begin with, but an emission.
  } else if (!input.absorption.empty()) {
    for (std::size_t j = 0; j < n; ++j)
      start.temperature.push_back(
          temperature_of(source, std::max(first.values[j], kFaint * brightest)));
  } else {
    Reconstruction second;
    try {
      second =
          linear_stage(input, settings, 1, part_of_progress(execution, 0.5 * share, 0.5 * share));
    } catch (const Cancelled&) {
      second.complete = false;
    }
    start.complete = second.complete;
    if (!start.complete) {
      start.reached = std::move(first);
      return start;
    }
    start.explained.push_back(second.explained);
    const double other = *std::max_element(second.values.begin(), second.values.end());
    start.temperature.assign(n, 0.0);
    double sum = 0, weight = 0;
    for (std::size_t j = 0; j < n; ++j) {
      if (!(first.values[j] > kBright * brightest) || !(second.values[j] > kBright * other))
        continue;
      start.temperature[j] =
          ratio_temperature(source, input.channels[1].source, input.channels[1].absorption_ratio,
                            first.values[j] / second.values[j], settings.lowest_temperature,
                            settings.highest_temperature);
      sum += first.values[j] * start.temperature[j];
      weight += first.values[j];
    }
    if (!(weight > 0)) throw InputError("nothing shines in both channels at the same places");
    for (double& t : start.temperature)
      if (!(t > 0)) t = sum / weight;
    start.absorption.assign(n, 0.0);
    for (std::size_t j = 0; j < n; ++j)
      start.absorption[j] = first.values[j] / source(start.temperature[j]);
  }
  if (!start.complete) {
    start.reached = std::move(first);
    return start;
  }
  return bounded(std::move(start), settings);
}

double ratio_temperature(const SourceFunction& first, const SourceFunction& second,
                         double absorption_ratio, double ratio, double lowest, double highest) {
  // The shorter wavelength gains on the longer one with temperature.
  const auto at = [&](double t) { return first(t) / (absorption_ratio * second(t)); };
  const bool rises = at(highest) > at(lowest);
  double low = lowest, high = highest;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    ((at(middle) < ratio) == rises ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace plenoflame
