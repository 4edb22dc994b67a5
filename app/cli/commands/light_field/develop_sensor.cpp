#include "commands/light_field/develop_sensor.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <utility>

#include "file_set.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/camera/sensor_levels.h"
#include "plenoflame/image/png_file.h"
#include "plenoflame/image/tiff_file.h"
#include "plenoflame/lightfield/sensor.h"
#include "plenoflame/lightfield/smoothed_error.h"
#include "plenoflame/sampling/sobol.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/spectral.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

/// The sensor without the kinds of noise that are switched off. Its levels stay, so that frames
/// with and without noise can be compared.
SensorSpec with_noise(SensorSpec sensor, const SensorOptions& options) {
  sensor = resolved_levels(sensor);
  const auto keeps = [&](const char* name) {
    return options.noise.empty() ||
           std::find(options.noise.begin(), options.noise.end(), name) != options.noise.end();
  };
  if (!keeps("shot")) sensor.shot_noise = false;
  if (!keeps("read")) sensor.read_noise = 0;
  if (!keeps("dark")) sensor.dark_current = 0;
  if (!keeps("defects")) sensor.hot_pixels = sensor.dead_pixels = 0;
  if (!options.noise_seed.empty()) {
    char* end = nullptr;
    sensor.noise_seed = std::strtoull(options.noise_seed.c_str(), &end, 10);
    if (*end != '\0' || options.noise_seed.front() == '-')
      throw UsageError("--noise-seed must be a whole number of at least 0, not '" +
                       options.noise_seed + "'");
  }
  return sensor;
}

std::vector<double> times_of(const SensorOptions& options, const SensorSpec& sensor) {
  if (options.exposures.empty()) return {sensor.exposure_time};
  std::vector<double> times;
  for (const std::string& text : options.exposures) {
    if (text == "auto") {
      times.push_back(0);
      continue;
    }
    times.push_back(quantity_option("--exposure", text, Dimension::time));
    if (!(times.back() > 0)) throw UsageError("--exposure must be a time above 0 s, or 'auto'");
  }
  return times;
}

/// Exposure of each channel by --channel-exposure: 0 is automatic. Channels that are not named are
/// exposed as the scene's sensor says.
std::vector<double> channel_times(const SensorOptions& options, const SensorSpec& sensor,
                                  const LightField& field) {
  std::vector<double> times(field.channels.size(), sensor.exposure_time);
  for (const std::string& text : options.each) {
    if (text == "auto") {
      std::fill(times.begin(), times.end(), 0.0);
      continue;
    }
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos)
      throw UsageError(
          "--channel-exposure must be CHANNEL=TIME, like \"650nm=4 ms\", or 'auto', not '" + text +
          "'");
    const LightFieldChannel& channel = find_channel(field, text.substr(0, sign));
    const std::string value = text.substr(sign + 1);
    double& time = times[static_cast<std::size_t>(&channel - field.channels.data())];
    time = value == "auto" ? 0 : quantity_option("--channel-exposure", value, Dimension::time);
    if (value != "auto" && !(time > 0))
      throw UsageError("--channel-exposure must be a time above 0 s, or 'auto'");
  }
  return times;
}

/// Results per pixel that hold for a frame as for what it is of.
void keep_truth(std::map<std::string, Image>& layers) {
  std::erase_if(layers, [](const auto& layer) { return !layer.first.starts_with("truth."); });
}

/// "frame.png" -> "frame-2ms-01.png".
std::string numbered(const std::string& path, const std::string& part) {
  const std::filesystem::path whole(path);
  return (whole.parent_path() / (whole.stem().string() + "-" + part + whole.extension().string()))
      .string();
}

std::string without_blanks(std::string text) {
  std::erase(text, ' ');
  return text;
}

std::string summary(const SensorFrame& frame, const SensorSpec& sensor, const std::string& what) {
  return what + ", exposure " + format_quantity(frame.exposure_time, Dimension::time) + ", " +
         readable_number(frame.gain) + " electrons per digital number, black level " +
         readable_number(frame.black_level) + ", " + std::to_string(sensor.bits) + " bits";
}

void write_numbers(const std::string& path, const SensorFrame& frame, const SensorSpec& sensor,
                   const std::string& what, const std::string& version) {
  const std::string text = summary(frame, sensor, what);
  if (!path.ends_with(".png")) {
    write_tiff(path, frame.window.width, frame.window.height, frame.numbers, text);
    return;
  }
  PngImage picture;
  picture.width = frame.window.width;
  picture.height = frame.window.height;
  picture.bits = 16;
  picture.transfer = Transfer::linear;
  picture.samples = frame.numbers;
  picture.texts = {{"Software", "Plenoflame " + version}, {"Comment", text}};
  write_png(path, picture);
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

class Developer {
 public:
  Developer(const LightField& field, const Scene& scene, const SensorSpec& sensor,
            const Execution& execution, std::vector<double> times)
      : field_(field), sensor_(sensor), execution_(execution), times_(std::move(times)) {
    if (!times_.empty() && mosaic())
      throw UsageError(
          "--channel-exposure: the sensor has a mosaic, whose colours are exposed together");
    const std::vector<double> wavelengths = channel_wavelengths(scene);
    if (wavelengths.size() != field.channels.size())
      throw InputError("the light field does not have the channels of its scene");
    for (std::size_t c = 0; c < wavelengths.size(); ++c)
      channels_.push_back({&field.channels[c].flux, wavelengths[c]});
  }

  bool mosaic() const { return sensor_.mosaic != MosaicPattern::none; }

  SensorFrame frame(std::size_t channel, const FrameSettings& settings) const {
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
  Image error_of_rays(std::size_t channel, const FrameSettings& settings,
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
  LightField electrons(const FrameSettings& settings, SensorFrame& last) const {
    LightField out = field_;
    out.unit = "e-";
    keep_truth(out.layers);
    out.channels.clear();
    if (mosaic()) {
      last = frame(0, settings);
      std::vector<DemosaicedColour> colours =
          demosaic(last.electrons, sensor_.mosaic, field_.window);
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
        out.channels.push_back(
            {field_.channels[c].name, last.electrons,
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
  double automatic(std::size_t channel) const {
    const double time = automatic_exposure({channels_.at(channel)}, sensor_);
    if (!(time > 0))
      throw InputError("channel " + field_.channels[channel].name +
                       " is dark, or of all wavelengths, so it has no automatic exposure; give a "
                       "time with --channel-exposure");
    return time;
  }

  /// One exposure for all channels, so that they can be compared.
  double automatic() const {
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
      throw InputError(
          "no pixel has light, so there is no automatic exposure; give a time with --exposure");
    return shortest;
  }

 private:
  const LightField& field_;
  SensorSpec sensor_;
  Execution execution_;
  std::vector<double> times_;  ///< of each channel; empty: one for all
  std::vector<SensorChannel> channels_;
};

}  // namespace

std::vector<double> channel_wavelengths(const Scene& scene) {
  std::vector<double> wavelengths;
  for (const ChannelSpec& channel : scene.channels) {
    // A response to photons is normalised at the centroid of the curve itself.
    ChannelSpec plain = channel;
    plain.photons = false;
    const auto response =
        channel.photons ? spectral_response(plain) : camera_response(scene, channel);
    wavelengths.push_back(response ? response->centroid() : 0);
  }
  return wavelengths;
}

int develop_sensor(const DevelopArguments& settings, const std::string& output,
                   const LightField& light_field, const Scene& scene) {
  const SensorOptions& options = settings.sensor;
  if (light_field.unit == "e-")
    throw InputError("the light field holds electrons already; develop the light field in W");
  const SensorSpec sensor = with_noise(scene.camera.sensor, options);
  if (!options.each.empty() && !options.exposures.empty())
    throw UsageError("--exposure and --channel-exposure exclude each other");
  const std::vector<double> times =
      options.each.empty() ? times_of(options, sensor) : std::vector<double>{1.0};
  Execution execution;
  execution.threads = options.threads;
  const Developer developer(
      light_field, scene, sensor, execution,
      options.each.empty() ? std::vector<double>{} : channel_times(options, sensor, light_field));
  const std::string& name = find_channel(light_field, settings.channel).name;
  std::size_t index = 0;
  while (light_field.channels[index].name != name) ++index;
  Report report;
  nlohmann::json list = nlohmann::json::array();
  std::vector<std::string> written;
  FileSet files;
  for (std::size_t t = 0; t < times.size(); ++t)
    for (int f = 0; f < options.frames; ++f) {
      const double time = times[t];
      FrameSettings of_frame;
      of_frame.exposure_time = time > 0 ? time : developer.automatic();
      of_frame.light = !options.dark;
      of_frame.number = static_cast<std::uint64_t>(f) << 32 | t;
      std::string path = output;
      if (times.size() > 1)
        path = numbered(path, without_blanks(readable(of_frame.exposure_time, Dimension::time)));
      if (options.frames > 1) path = numbered(path, std::to_string(f + 1));
      // Numbered names are new names: neither the input nor each other may be overwritten.
      check_not_overwritten("--output", path, settings.input);
      if (std::find(written.begin(), written.end(), path) != written.end())
        throw UsageError("--exposure: two times have the same name, '" + path + "'");
      written.push_back(path);
      SensorFrame frame;
      nlohmann::json times_of_channels = nlohmann::json::object();
      if (path.ends_with(".exr")) {
        const LightField electrons = developer.electrons(of_frame, frame);
        for (const LightFieldChannel& each : electrons.channels)
          times_of_channels[each.name] = channel_exposure(electrons, each.name);
        files.write(path, [&](const std::string& file) { write_light_field(file, electrons); });
      } else {
        frame = developer.frame(index, of_frame);
        const std::string what = developer.mosaic() ? "mosaic" : "channel " + name;
        files.write(path, [&](const std::string& file) {
          write_numbers(file, frame, sensor, options.dark ? "dark frame" : what,
                        light_field.version);
        });
      }
      double sum = 0;
      for (const float e : frame.electrons.pixels) sum += static_cast<double>(e);
      const double mean = sum / static_cast<double>(frame.electrons.pixels.size());
      const double share =
          static_cast<double>(frame.saturated) / static_cast<double>(frame.electrons.pixels.size());
      const bool several = !options.each.empty() && path.ends_with(".exr");
      report.add_text("frame", path + ": " +
                                   (several ? "each channel its own time"
                                            : readable(frame.exposure_time, Dimension::time)) +
                                   ", mean " + readable_number(mean) + " electrons, " +
                                   readable_percent(share) + " saturated");
      list.push_back({{"file", path},
                      {"exposure_time_s", frame.exposure_time},
                      {"gain", frame.gain},
                      {"black_level", frame.black_level},
                      {"mean_electrons", mean},
                      {"saturated_share", share}});
      if (!options.each.empty() && !times_of_channels.empty())
        list.back()["exposure_times_s"] = times_of_channels;
    }
  files.commit();
  report.add_json("frames", list);
  report.print(settings.json);
  return kSuccess;
}

}  // namespace plenoflame::cli
