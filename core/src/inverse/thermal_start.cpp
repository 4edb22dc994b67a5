#include "inverse/thermal_start.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/inverse/measurement.h"
#include "plenoflame/scene/pupil_transmission.h"

namespace plenoflame {
namespace {

/// Below this part of the brightest emission a ratio of two says nothing of the temperature.
constexpr double kBright = 0.02;
/// An unknown without any information begins at this part of the largest.
constexpr double kFaint = 1e-3;

/// The values that the first channel's linear reconstruction begins with.
std::vector<double> first_samples(const ThermalInput& input) {
  std::vector<double> values = input.start_emission;
  for (std::size_t j = 0; j < values.size() && !input.absorption.empty(); ++j)
    values[j] = input.absorption[j] > 0 ? values[j] / input.absorption[j] : 0;
  return values;
}

/// Light of one colour: that of a channel, or what filters of one kind let through of it.
struct Colour {
  std::size_t channel = 0;
  SourceFunction source;
  double absorption_ratio = 1;
  std::vector<std::vector<char>> parts = {};  ///< as ReconstructionInput's
};

Colour colour_of(const ThermalInput& input, std::size_t channel) {
  return {channel, input.channels[channel].source, input.channels[channel].absorption_ratio};
}

/// The first channel behind all filters that are like one of them.
Colour behind_filter(const ThermalInput& input, const ThermalPart& filter) {
  Colour colour = colour_of(input, 0);
  colour.source = filter.source;
  colour.absorption_ratio *= filter.absorption_ratio;
  for (const std::vector<ThermalPart>& view : input.channels[0].parts) {
    std::vector<char>& counts = colour.parts.emplace_back();
    for (const ThermalPart& part : view) counts.push_back(part.source == filter.source);
    if (view.empty()) counts.push_back(0);
  }
  return colour;
}

/// The filters of the shortest and of the longest wavelength that the first channel's pictures see
/// light through; nullptr: there are none.
std::pair<const ThermalPart*, const ThermalPart*> outermost_filters(const ThermalInput& input) {
  std::pair<const ThermalPart*, const ThermalPart*> found{nullptr, nullptr};
  for (std::size_t v = 0; v < input.channels[0].parts.size(); ++v) {
    const std::vector<ThermalPart>& parts = input.channels[0].parts[v];
    if (parts.empty()) continue;
    const std::vector<double> shares = pupil_transmission(
        input.views[v].scene->scene, static_cast<std::size_t>(input.channels[0].channel));
    for (std::size_t p = 0; p < input.views[v].scene->camera.pupil_filters().filters().size();
         ++p) {
      if (!(shares[p] > 0)) continue;
      const double wavelength = parts[p].source.wavelength();
      if (!found.first || wavelength < found.first->source.wavelength()) found.first = &parts[p];
      if (!found.second || wavelength > found.second->source.wavelength()) found.second = &parts[p];
    }
  }
  return found;
}

/// The colours whose ratio of emissions is a temperature.
std::pair<Colour, Colour> two_colours(const ThermalInput& input) {
  if (input.channels.size() > 1) return {colour_of(input, 0), colour_of(input, 1)};
  const auto [blue, red] = outermost_filters(input);
  return {behind_filter(input, *blue), behind_filter(input, *red)};
}

/// The light that two reconstructions, each of some of the rows, explain together.
std::vector<Image> mean_of(const std::vector<Image>& first, const std::vector<Image>& second,
                           const Reconstruction& own, const Reconstruction& other) {
  std::vector<Image> result = first;
  for (std::size_t v = 0; v < result.size(); ++v)
    for (std::size_t k = 0; k < result[v].pixels.size(); ++k) {
      const bool seen = own.residual[v].pixels[k] != 0, seen_too = other.residual[v].pixels[k] != 0;
      if (seen && !seen_too) continue;
      result[v].pixels[k] = seen_too && !seen ? second[v].pixels[k]
                                              : 0.5F * (first[v].pixels[k] + second[v].pixels[k]);
    }
  return result;
}

Reconstruction linear_stage(const ThermalInput& input, const ThermalSettings& settings,
                            const Colour& colour, bool first, const Execution& execution) {
  const std::size_t channel = colour.channel;
  ReconstructionInput linear;
  linear.views = input.views;
  linear.measurements = input.channels[channel].measurements;
  linear.unknowns = input.unknowns;
  linear.absorption = input.absorption;
  linear.parts = colour.parts;
  for (double& value : linear.absorption) value *= colour.absorption_ratio;
  linear.support = input.support;
  ReconstructionSettings how = settings.linear;
  how.rays = rays_of_channel(how.rays, channel, input.channels[channel].channel);
  how.draws = how.probes = 0;
  how.test_model = how.grid_noise = false;
  how.strength = -1;
  if (first)
    linear.start = first_samples(input);
  else
    how.watch = nullptr;  // one field is shown
  how.solver = ReconstructionSolver::fista;
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

bool has_two_colours(const ThermalInput& input) {
  const auto [blue, red] = outermost_filters(input);
  return blue && blue->source.wavelength() < red->source.wavelength();
}

ThermalStart thermal_start(const ThermalInput& input, const ThermalSettings& settings, double share,
                           const Execution& execution) {
  ThermalStart start;
  const std::size_t n = input.unknowns->size();
  if (!input.start_temperature.empty() && !settings.linear.support && !settings.linear.ray_noise) {
    // No linear reconstruction is needed.
    start.temperature = input.start_temperature;
    start.absorption = input.start_absorption;
    start.solved = input.support.empty() ? std::vector<char>(n, 1) : input.support;
    return bounded(std::move(start), settings);
  }
  const bool by_filters = input.absorption.empty() && input.channels.size() == 1;
  const auto [one, other] = input.absorption.empty()
                                ? two_colours(input)
                                : std::pair{colour_of(input, 0), colour_of(input, 0)};
  Reconstruction first =
      linear_stage(input, settings, one, true, part_of_progress(execution, 0, 0.5 * share));
  start.complete = first.complete;
  start.solved = first.solved;
  start.hidden = first.hidden;
  start.rays_error = first.rays_error;
  start.unseen = first.unseen;
  start.strength = first.strength;
  start.light_outside = first.light_outside;
  start.explained.push_back(first.explained);
  const double brightest = *std::max_element(first.values.begin(), first.values.end());
  const SourceFunction& source = one.source;
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
      second = linear_stage(input, settings, other, false,
                            part_of_progress(execution, 0.5 * share, 0.5 * share));
    } catch (const Cancelled&) {
      second.complete = false;
    }
    start.complete = second.complete;
    if (!start.complete) {
      start.reached = std::move(first);
      return start;
    }
    if (by_filters)
      start.explained[0] = mean_of(first.explained, second.explained, first, second);
    else
      start.explained.push_back(second.explained);
    const double other_brightest = *std::max_element(second.values.begin(), second.values.end());
    start.temperature.assign(n, 0.0);
    double sum = 0, weight = 0;
    for (std::size_t j = 0; j < n; ++j) {
      if (!(first.values[j] > kBright * brightest) ||
          !(second.values[j] > kBright * other_brightest))
        continue;
      start.temperature[j] =
          ratio_temperature(source, other.source, other.absorption_ratio / one.absorption_ratio,
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
      start.absorption[j] = first.values[j] / (one.absorption_ratio * source(start.temperature[j]));
  }
  if (!start.complete) {
    start.reached = std::move(first);
    return start;
  }
  if (input.absorption.empty())
    for (std::size_t j = 0; j < n; ++j)
      start.hidden[j] *= input.channels[0].source(start.temperature[j]) /
                         (one.absorption_ratio * source(start.temperature[j]));
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
