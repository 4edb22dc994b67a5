#include "plenoflame/lightfield/sensor.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "plenoflame/camera/sensor_levels.h"
#include "plenoflame/lightfield/develop.h"
#include "plenoflame/sampling/noise.h"
#include "plenoflame/sampling/sobol.h"

namespace plenoflame {
namespace {

constexpr std::uint64_t kDefectSeed = 0x646566656374u;  ///< apart from the frames' noise

void check(const std::vector<SensorChannel>& channels, PixelWindow window,
           const SensorSpec& sensor) {
  const bool mosaic = sensor.mosaic != MosaicPattern::none;
  if (channels.size() != (mosaic ? 3u : 1u))
    throw InputError(mosaic ? "a sensor with a mosaic needs three channels, red, green and blue"
                            : "a sensor without a mosaic records one channel");
  for (const SensorChannel& channel : channels) {
    if (channel.flux->width != window.width || channel.flux->height != window.height)
      throw InputError("the channels of a frame must have the size of its window");
    if (!(channel.wavelength > 0))
      throw InputError(
          "a channel of all wavelengths has no photon energy, so no number of electrons follows "
          "from it; render a band, a line or a response");
  }
  if (!(sensor.full_well > 0)) throw InputError("the full well must be above 0 electrons");
  if (sensor.bits < 1 || sensor.bits > 16)
    throw InputError(fmt::format("a sensor has 1 to 16 bits, not {}", sensor.bits));
  if (!(sensor.quantum_efficiency > 0) || !(sensor.fill_factor > 0))
    throw InputError("quantum efficiency and fill factor must be above 0");
  if (!(sensor.black_level >= 0) || !(sensor.black_level < std::ldexp(1.0, sensor.bits) - 1))
    throw InputError("the black level must lie below the largest digital number");
}

enum class Defect { none, hot, dead };

Defect defect_of(const SensorSpec& sensor, std::uint64_t pixel) {
  if (!(sensor.hot_pixels + sensor.dead_pixels > 0)) return Defect::none;
  const double u = NoiseStream(mix64(sensor.noise_seed ^ kDefectSeed), pixel).uniform();
  if (u < sensor.dead_pixels) return Defect::dead;
  return u < sensor.dead_pixels + sensor.hot_pixels ? Defect::hot : Defect::none;
}

/// A number of one channel, or else of all.
double number_of(const LightField& field, const std::string& key, const std::string& channel) {
  auto found = field.numbers.find(key + "." + channel);
  if (found == field.numbers.end()) found = field.numbers.find(key);
  return found == field.numbers.end() ? 0 : found->second;
}

}  // namespace

double channel_exposure(const LightField& electrons, const std::string& channel) {
  return number_of(electrons, "sensor.exposure_time", channel);
}

double channel_dark_electrons(const LightField& electrons, const std::string& channel) {
  return number_of(electrons, "sensor.dark_electrons", channel);
}

double electrons_per_joule(const SensorSpec& sensor, double wavelength) {
  return sensor.quantum_efficiency * sensor.fill_factor * wavelength /
         (constants::planck * constants::light_speed);
}

int mosaic_colour(MosaicPattern pattern, int column, int row) {
  const bool right = column % 2 != 0, low = row % 2 != 0;
  switch (pattern) {
    case MosaicPattern::none:
      return 0;
    case MosaicPattern::rggb:
      return right == low ? (right ? 2 : 0) : 1;
    case MosaicPattern::bggr:
      return right == low ? (right ? 0 : 2) : 1;
    case MosaicPattern::grbg:
      return right == low ? 1 : (right ? 0 : 2);
    case MosaicPattern::gbrg:
      return right == low ? 1 : (right ? 2 : 0);
  }
  return 0;
}

double automatic_exposure(const std::vector<SensorChannel>& channels, const SensorSpec& sensor) {
  double fastest = 0;
  for (const SensorChannel& channel : channels)
    fastest = std::max(fastest, automatic_saturation(*channel.flux) *
                                    electrons_per_joule(sensor, channel.wavelength));
  // A converter of few bits is full before the well.
  const SensorSpec levels = resolved_levels(sensor);
  const double most = std::min(
      sensor.full_well, levels.gain * (std::ldexp(1.0, sensor.bits) - 1 - levels.black_level));
  return fastest > 0 ? kAutomaticFill * most / fastest : 0;
}

SensorFrame expose(const std::vector<SensorChannel>& channels, PixelWindow window, int sensor_width,
                   const SensorSpec& sensor, const FrameSettings& settings,
                   const Execution& execution) {
  check(channels, window, sensor);
  SensorFrame frame;
  frame.window = window;
  frame.exposure_time =
      settings.exposure_time > 0 ? settings.exposure_time : automatic_exposure(channels, sensor);
  const double largest = std::ldexp(1.0, sensor.bits) - 1;
  const SensorSpec levels = resolved_levels(sensor);
  frame.gain = levels.gain;
  frame.black_level = levels.black_level;
  frame.electrons = Image(window.width, window.height);
  frame.numbers.resize(frame.electrons.pixels.size());
  const double time = frame.exposure_time;
  // Dark frames are other frames than those with light: their noise must not cancel.
  const std::uint64_t key =
      mix64(mix64(mix64(sensor.noise_seed) + settings.number) + (settings.light ? 0u : 1u));
  std::atomic<std::size_t> saturated = 0;
  std::atomic<bool> good = true;
  const auto row_of = [&](std::size_t line, int) {
    const int row = static_cast<int>(line);
    std::size_t full = 0;
    for (int column = 0; column < window.width; ++column) {
      const int x = window.x + column, y = window.y + row;
      const auto& channel = channels[static_cast<std::size_t>(mosaic_colour(sensor.mosaic, x, y))];
      const double flux = channel.flux->at(column, row);
      if (!std::isfinite(flux)) good = false;
      const std::uint64_t pixel =
          static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(sensor_width) +
          static_cast<std::uint64_t>(x);
      const Defect defect = defect_of(sensor, pixel);
      double mean = (defect == Defect::hot ? sensor.hot_current : sensor.dark_current) * time;
      if (settings.light)
        mean += std::max(flux, 0.0) * time * electrons_per_joule(sensor, channel.wavelength);
      if (defect == Defect::dead) mean = 0;
      NoiseStream noise(key, pixel);
      double electrons = sensor.shot_noise ? noise.poisson(mean) : mean;
      const bool well_is_full = electrons >= sensor.full_well;
      electrons = std::min(electrons, sensor.full_well);
      if (sensor.read_noise > 0) electrons += sensor.read_noise * noise.gaussian();
      const double number = std::floor(electrons / frame.gain + frame.black_level + 0.5);
      frame.electrons.at(column, row) = static_cast<float>(electrons);
      frame.numbers[line * static_cast<std::size_t>(window.width) +
                    static_cast<std::size_t>(column)] =
          static_cast<std::uint16_t>(std::clamp(number, 0.0, largest));
      full += well_is_full || number >= largest ? 1 : 0;
    }
    saturated += full;
  };
  if (!parallel_for(execution, static_cast<std::size_t>(window.height), row_of)) throw Cancelled();
  if (!good) throw InputError("the light field holds a value that is not finite");
  frame.saturated = saturated;
  return frame;
}

std::vector<DemosaicedColour> demosaic(const Image& raw, MosaicPattern pattern,
                                       PixelWindow window) {
  if (pattern == MosaicPattern::none)
    throw InputError("there is nothing to demosaic: the sensor has no mosaic");
  const Image none(raw.width, raw.height);
  std::vector<DemosaicedColour> colours(3, {none, none});
  for (int row = 0; row < raw.height; ++row)
    for (int column = 0; column < raw.width; ++column) {
      double sum[3] = {};
      int count[3] = {};
      for (int y = std::max(0, row - 1); y <= std::min(raw.height - 1, row + 1); ++y)
        for (int x = std::max(0, column - 1); x <= std::min(raw.width - 1, column + 1); ++x) {
          const int colour = mosaic_colour(pattern, window.x + x, window.y + y);
          sum[colour] += static_cast<double>(raw.at(x, y));
          ++count[colour];
        }
      const int own = mosaic_colour(pattern, window.x + column, window.y + row);
      sum[own] = static_cast<double>(raw.at(column, row));
      count[own] = 1;
      for (int c = 0; c < 3; ++c) {
        DemosaicedColour& colour = colours[static_cast<std::size_t>(c)];
        colour.values.at(column, row) = static_cast<float>(count[c] > 0 ? sum[c] / count[c] : 0);
        colour.counts.at(column, row) = static_cast<float>(count[c]);
      }
    }
  return colours;
}

}  // namespace plenoflame
