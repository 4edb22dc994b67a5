#include "commands/light_field/pyrometry_compare.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "options.h"
#include "plenoflame/base/error.h"

namespace plenoflame::cli {
namespace {

/// The index of the channel of this name in a light field.
std::size_t place_of(const LightField& field, const std::string& channel, const std::string& path) {
  const LightFieldChannel& found = find_channel(field, channel, path);
  return static_cast<std::size_t>(&found - field.channels.data());
}

/// Against the truth, bin by bin: what a bin's pixels look at on average, weighted by the light of
/// the first channel.
struct TruthSums {
  double temperature = 0, weight = 0, measured = 0;
};

}  // namespace

void compare_with(const Image& truth, const TemperatureMap& map, const Image& light,
                  const std::optional<PixelBins>& bins, Report& report) {
  std::vector<TruthSums> sums(bins ? bins->count : truth.pixels.size());
  for (std::size_t i = 0; i < truth.pixels.size(); ++i) {
    const double weight = light.pixels[i];
    if (!(truth.pixels[i] > 0) || !(map.temperature.pixels[i] > 0) || !(weight > 0)) continue;
    TruthSums& sum = sums[bins ? static_cast<std::size_t>(bins->of_pixel[i]) : i];
    sum.temperature += weight * static_cast<double>(truth.pixels[i]);
    sum.weight += weight;
    sum.measured = static_cast<double>(map.temperature.pixels[i]);
  }
  double sum = 0, squares = 0, n = 0;
  for (const TruthSums& bin : sums) {
    if (!(bin.weight > 0)) continue;
    const double away = bin.measured - bin.temperature / bin.weight;
    sum += away;
    squares += away * away;
    n += 1;
  }
  if (n == 0) return;
  report.add("against the truth",
             readable(sum / n, Dimension::temperature) + " mean difference, " +
                 readable(std::sqrt(squares / n), Dimension::temperature) + " RMS",
             "mean_difference_K", sum / n);
  report.add_json("rms_difference_K", std::sqrt(squares / n));
}

void compare_with_reference(const std::string& path, const FoundTemperatures& input,
                            Report& report) {
  const Temperatures& found = input.temperatures;
  const TemperatureMap& map = found.map;
  const std::array<LightFieldChannel, 2>& light = found.light;
  const std::optional<PixelBins>& bins = found.bins;
  const LightField other = read_light_field(path);
  if (!(other.window == input.field.window) || other.sensor_width != input.field.sensor_width ||
      other.sensor_height != input.field.sensor_height)
    throw InputError("--reference: " + path + " does not hold the same pixels");
  LightFieldChannel clear[2];
  for (std::size_t c = 0; c < 2; ++c) {
    const std::string& name = input.field.channels[found.channels[c]].name;
    clear[c] = light_in_proportion(other, input.scene, place_of(other, name, path));
    for (std::size_t i = 0; i < clear[c].flux.pixels.size(); ++i)
      if (!std::isfinite(light[0].flux.pixels[i]) || !std::isfinite(light[1].flux.pixels[i]))
        clear[c].flux.pixels[i] = std::numeric_limits<float>::quiet_NaN();
  }
  PyrometrySettings every;
  every.threshold = 1e-9;  // all that has light
  every.least_signal_to_noise = 0;
  const TemperatureMap expected =
      two_colour_map(clear[0], clear[1], *found.ratio, every, bins ? &*bins : nullptr);
  std::vector<char> seen(bins ? bins->count : 0, 0);
  double sum = 0, squares = 0, variances = 0, n = 0;
  for (std::size_t i = 0; i < map.temperature.pixels.size(); ++i) {
    const double measured = map.temperature.pixels[i], right = expected.temperature.pixels[i];
    if (!(measured > 0) || !(right > 0)) continue;
    // All pixels of a bin have its temperature.
    if (bins && seen[static_cast<std::size_t>(bins->of_pixel[i])]++ != 0) continue;
    sum += measured - right;
    squares += (measured - right) * (measured - right);
    const double error = map.standard_error.empty() ? 0 : map.standard_error.pixels[i];
    variances += error * error;
    n += 1;
  }
  if (n == 0) return;
  const double rms = std::sqrt(squares / n);
  std::string text = readable(sum / n, Dimension::temperature) + " mean difference, " +
                     readable(rms, Dimension::temperature) + " RMS";
  if (variances > 0) {
    text += ", " + readable_number(std::sqrt(squares / variances)) + " times the expected";
    report.add_json("reference_rms_over_expected", std::sqrt(squares / variances));
  }
  report.add("against the reference", text, "reference_mean_difference_K", sum / n);
  report.add_json("reference_rms_difference_K", rms);
}

}  // namespace plenoflame::cli
