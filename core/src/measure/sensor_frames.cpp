#include "plenoflame/measure/sensor_frames.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"
#include "plenoflame/camera/sensor_levels.h"
#include "plenoflame/lightfield/smoothed_error.h"
#include "plenoflame/sampling/sobol.h"
#include "plenoflame/scene/spectral.h"

namespace plenoflame {
namespace {

/// Results per pixel that hold for a frame as for what it is of.
void keep_truth(std::map<std::string, Image>& layers) {
  std::erase_if(layers, [](const auto& layer) { return !layer.first.starts_with("truth."); });
}

/// The standard error of each pixel by its own electrons, and by the rays of the picture that was
/// exposed.
/// @param rays [electrons] error of that picture; empty: it tells none
/// @param counts of how many recorded pixels each is the mean; nullptr: of one
Image error_of(const Image& electrons, const SensorSpec& sensor, const Image& rays,
               const Image* counts = nullptr) {
  Image error(electrons.width, electrons.height);
  for (std::size_t i = 0; i < error.pixels.size(); ++i) {
    const double shot =
        sensor.shot_noise ? std::max(0.0, static_cast<double>(electrons.pixels[i])) : 0.0;
    const double count = counts ? std::max(1.0, static_cast<double>(counts->pixels[i])) : 1.0;
    const double of_rays = rays.empty() ? 0.0 : static_cast<double>(rays.pixels[i]);
    error.pixels[i] = static_cast<float>(
        std::sqrt((shot + sensor.read_noise * sensor.read_noise) / count + of_rays * of_rays));
  }
  return error;
}

}  // namespace

SensorSpec with_noise(const SensorSpec& sensor, const SensorNoise& noise) {
  SensorSpec result = resolved_levels(sensor);
  if (!noise.shot) result.shot_noise = false;
  if (!noise.read) result.read_noise = 0;
  if (!noise.dark) result.dark_current = 0;
  if (!noise.defects) result.hot_pixels = result.dead_pixels = 0;
  if (noise.seed) result.noise_seed = *noise.seed;
  return result;
}

SensorFrames::SensorFrames(const LightField& field, const Scene& scene, const SensorNoise& noise,
                           const Execution& execution)
    : field_(field), sensor_(with_noise(scene.camera.sensor, noise)), execution_(execution) {
  if (field.unit == "e-")
    throw InputError("the light field holds electrons already; develop the light field in W");
  const std::vector<double> wavelengths = channel_wavelengths(scene);
  if (wavelengths.size() != field.channels.size())
    throw InputError("the light field does not have the channels of its scene");
  for (std::size_t c = 0; c < wavelengths.size(); ++c)
    channels_.push_back({&field.channels[c].flux, wavelengths[c]});
}

void SensorFrames::expose_each(std::vector<double> times) {
  if (mosaic())
    throw mended_by(UsageError("the sensor has a mosaic, whose colours are exposed together"),
                    {"channel-exposure"});
  times_ = std::move(times);
}

SensorFrame SensorFrames::frame(std::size_t channel, const FrameSettings& settings) const {
  std::vector<SensorChannel> seen{channels_.at(channel)};
  if (mosaic()) {
    if (channels_.size() < 3)
      throw InputError("a mosaic needs a light field with three channels, red, green and blue");
    seen.assign(channels_.begin(), channels_.begin() + 3);
  }
  // Channels are frames of their own, with noise of their own.
  FrameSettings own = settings;
  if (!times_.empty())
    own.exposure_time = times_[channel] > 0 ? times_[channel] : automatic(channel);
  own.number = mix64(settings.number) + (mosaic() ? 0 : channel);
  return expose(seen, field_.window, field_.sensor_width, sensor_, own, execution_);
}

/// [electrons] The part that the finite number of rays has in the error of a frame with noise.
/// Frames without shot noise are the rendering itself, and their errors that of the reading.
Image SensorFrames::error_of_rays(std::size_t channel, const FrameSettings& settings,
                                  const SensorFrame& exposed) const {
  const LightFieldChannel& own = field_.channels[channel];
  if (!settings.light || !sensor_.shot_noise || own.standard_error.empty() || field_.unit != "W")
    return {};
  Image error = smoothed_error(own.flux, own.standard_error);
  const double electrons =
      exposed.exposure_time * electrons_per_joule(sensor_, channels_[channel].wavelength);
  for (float& value : error.pixels)
    value = static_cast<float>(electrons * static_cast<double>(value));
  return error;
}

/// Electrons of all channels. @param frames receives what was exposed
LightField SensorFrames::electrons(const FrameSettings& settings, SensorFrame& last) const {
  LightField out = field_;
  out.unit = "e-";
  keep_truth(out.layers);
  out.channels.clear();
  if (mosaic()) {
    last = frame(0, settings);
    std::vector<DemosaicedColour> colours = demosaic(last.electrons, sensor_.mosaic, field_.window);
    for (std::size_t c = 0; c < 3; ++c) {
      Image error = error_of(colours[c].values, sensor_, error_of_rays(c, settings, last),
                             &colours[c].counts);
      out.channels.push_back(
          {field_.channels[c].name, std::move(colours[c].values), std::move(error)});
    }
    out.layers["sensor.raw"] = last.electrons;
  } else {
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const std::size_t saturated = last.saturated;
      last = frame(c, settings);
      last.saturated = std::max(last.saturated, saturated);  // of the worst channel
      if (!times_.empty()) {
        const std::string& name = field_.channels[c].name;
        out.numbers["sensor.exposure_time." + name] = last.exposure_time;
        out.numbers["sensor.dark_electrons." + name] = sensor_.dark_current * last.exposure_time;
      }
      out.channels.push_back({field_.channels[c].name, last.electrons,
                              error_of(last.electrons, sensor_, error_of_rays(c, settings, last))});
    }
  }
  if (times_.empty()) {
    out.numbers["sensor.exposure_time"] = last.exposure_time;
    out.numbers["sensor.dark_electrons"] = sensor_.dark_current * last.exposure_time;
  }
  out.numbers["sensor.gain"] = last.gain;
  out.numbers["sensor.black_level"] = last.black_level;
  // A full well that the amplifier's noise made a little less of is full all the same.
  out.numbers["sensor.saturated_from"] =
      std::max(0.5 * sensor_.full_well, sensor_.full_well - 5 * sensor_.read_noise);
  return out;
}

/// The exposure of one channel by itself.
double SensorFrames::automatic(std::size_t channel) const {
  const double time = automatic_exposure({channels_.at(channel)}, sensor_);
  if (!(time > 0))
    throw mended_by(InputError("channel " + field_.channels[channel].name +
                               " is dark, or of all wavelengths, so it has no automatic exposure; "
                               "give a time"),
                    {"channel-exposure"});
  return time;
}

/// One exposure for all channels, so that they can be compared.
double SensorFrames::automatic() const {
  double shortest = 0;
  for (const SensorChannel& channel : channels_) {
    const double time = automatic_exposure({channel}, sensor_);
    if (time > 0 && (shortest == 0 || time < shortest)) shortest = time;
  }
  bool any = false;
  for (const SensorChannel& channel : channels_) any = any || channel.wavelength > 0;
  if (!any)
    throw InputError(
        "a channel of all wavelengths has no photon energy, so no number of electrons follows "
        "from it; render a band, a line or a response");
  if (!(shortest > 0))
    throw mended_by(
        InputError("no pixel has light, so there is no automatic exposure; give a time"),
        {"exposure"});
  return shortest;
}

}  // namespace plenoflame
