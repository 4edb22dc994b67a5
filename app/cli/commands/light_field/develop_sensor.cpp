#include "commands/light_field/develop_sensor.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "file_set.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/image/png_file.h"
#include "plenoflame/image/tiff_file.h"
#include "plenoflame/measure/sensor_frames.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

SensorNoise noise_of(const SensorOptions& options) {
  const auto keeps = [&](const char* name) {
    return options.noise.empty() ||
           std::find(options.noise.begin(), options.noise.end(), name) != options.noise.end();
  };
  SensorNoise noise{keeps("shot"), keeps("read"), keeps("dark"), keeps("defects"), {}};
  if (!options.noise_seed.empty())
    noise.seed = whole_number_option<std::uint64_t>("--noise-seed", options.noise_seed, 0);
  return noise;
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

}  // namespace

int develop_sensor(const DevelopArguments& settings, const std::string& output,
                   const LightField& light_field, const Scene& scene) {
  const SensorOptions& options = settings.sensor;
  if (!options.each.empty() && !options.exposures.empty())
    throw UsageError("--exposure and --channel-exposure exclude each other");
  const std::vector<double> times =
      options.each.empty() ? times_of(options, scene.camera.sensor) : std::vector<double>{1.0};
  Execution execution;
  execution.threads = options.threads;
  SensorFrames frames(light_field, scene, noise_of(options), execution);
  if (!options.each.empty())
    frames.expose_each(channel_times(options, scene.camera.sensor, light_field));
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
      of_frame.exposure_time = time > 0 ? time : frames.automatic();
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
        const LightField electrons = frames.electrons(of_frame, frame);
        for (const LightFieldChannel& each : electrons.channels)
          times_of_channels[each.name] = channel_exposure(electrons, each.name);
        files.write(path, [&](const std::string& file) { write_light_field(file, electrons); });
      } else {
        frame = frames.frame(index, of_frame);
        const std::string what = frames.mosaic() ? "mosaic" : "channel " + name;
        files.write(path, [&](const std::string& file) {
          write_numbers(file, frame, frames.sensor(), options.dark ? "dark frame" : what,
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
  print(report, settings.json);
  return kSuccess;
}

}  // namespace plenoflame::cli
