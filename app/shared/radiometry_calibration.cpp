#include "radiometry_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <list>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/base/report.h"
#include "plenoflame/calibration/radiometry_fit.h"
#include "plenoflame/camera/sensor_levels.h"
#include "plenoflame/lightfield/geometry.h"
#include "plenoflame/scene/spectral.h"

namespace plenoflame {
namespace {

constexpr double kLongestExposure = 1e6;  // [s] as of a scene's camera

/// Files that were taken alike: "1500 K@2 ms=a.tif".
struct TakenFiles {
  double temperature = 0;  ///< [K]; 0: none
  double exposure = 0;     ///< [s]; 0: not stated
  std::vector<std::string> files;
};

/// Reads "[TEMPERATURE][@TIME]=FILE"; without "=" all of it is the file.
TakenFiles taken(const std::string& option, const std::string& text, bool temperature) {
  TakenFiles one;
  const std::size_t sign = text.find('=');
  if (sign == std::string::npos) {
    if (temperature)
      throw UsageError(option + ": '" + text +
                       "': the temperature stands in front, as in 1500K=" + text);
    one.files = {text};
    return one;
  }
  one.files = {text.substr(sign + 1)};
  const std::string label = text.substr(0, sign);
  const std::size_t at = label.find('@');
  if (temperature) {
    one.temperature = quantity_option(option, label.substr(0, at), Dimension::temperature);
    constexpr double kHottest = 1e5;  // [K] as of a scene's sources
    if (!(one.temperature > 0 && one.temperature <= kHottest))
      throw UsageError(option + ": a temperature above 0 K, at most 100000 K, not '" +
                       label.substr(0, at) + "'");
  }
  if (!temperature || at != std::string::npos) {
    const std::string time = temperature ? label.substr(at + 1) : label;
    one.exposure = quantity_option(option, time, Dimension::time);
    if (!(one.exposure > 0 && one.exposure <= kLongestExposure))
      throw UsageError(option + ": an exposure time above 0 s, at most 1e6 s, not '" + time + "'");
  }
  return one;
}

/// Puts files with the same label together.
std::vector<TakenFiles> gathered(const std::string& option, const std::vector<std::string>& texts,
                                 bool temperature) {
  std::vector<TakenFiles> all;
  for (const std::string& text : texts) {
    TakenFiles one = taken(option, text, temperature);
    const auto same = std::find_if(all.begin(), all.end(), [&](const TakenFiles& other) {
      return other.temperature == one.temperature && other.exposure == one.exposure;
    });
    if (same == all.end())
      all.push_back(std::move(one));
    else
      same->files.push_back(one.files.front());
  }
  return all;
}

class RadiometryRun {
 public:
  RadiometryRun(const RadiometryRequest& arguments, const SceneDocument& camera,
                const Execution& execution)
      : arguments_(arguments), execution_(execution), document_(camera) {}

  RadiometryCalibration run() {
    const SettingNames& names = arguments_.files.names;
    std::vector<std::string> white,
        series;  // without a time in front, and with one
    for (const std::string& text : arguments_.white)
      (text.find('=') == std::string::npos || std::filesystem::exists(text) ? white : series)
          .push_back(text);
    const std::vector<TakenFiles> sources = gathered("SOURCE", arguments_.sources, true),
                                  whites = gathered(names("white"), series, false),
                                  darks = gathered(names("dark"), arguments_.dark, false);
    const double temperature_error =
        arguments_.temperature_error.empty()
            ? 0
            : quantity_option(names("temperature-error"), arguments_.temperature_error,
                              Dimension::temperature);
    if (!(temperature_error >= 0 && temperature_error <= 1e5))
      throw UsageError(names("temperature-error") + ": from 0 K to 100000 K");
    if (!arguments_.exposure.empty()) {
      exposure_ = quantity_option(names("exposure-time"), arguments_.exposure, Dimension::time);
      if (!(exposure_ > 0 && exposure_ <= kLongestExposure))
        throw UsageError(names("exposure-time") + ": above 0 s, at most 1e6 s");
    }
    const Scene& scene = document_.scene;
    if (!(exposure_ > 0)) exposure_ = scene.camera.sensor.exposure_time;
    levels_ = resolved_levels(scene.camera.sensor);
    constexpr double kNever = 1e9;
    for (const TakenFiles& dark : darks) {
      darks_.push_back(
          {dark.exposure, read_frames(dark.files, arguments_.files, execution_, kNever)});
      check_size(darks_.back().frames, dark.files[0]);
    }
    if (darks.empty())
      execution_.warn("no dark frames: " + readable_number(levels_.black_level) +
                      " counts of the camera's file are taken for the level without light");
    for (const TakenFiles& source : sources) source_pictures_.push_back(picture_of(source));
    for (const TakenFiles& one : whites) white_pictures_.push_back(picture_of(one));
    read_corrections(white);
    EvaluatedPixels pixels;
    pixels.window = pixels.part = {0, 0, scene.camera.sensor.columns, scene.camera.sensor.rows};
    if (!arguments_.part.empty()) pixels.part = window_option(names("part"), arguments_.part);
    if (!scene.camera.array.present)
      throw InputError(
          "the camera has no microlens array: the etendue of its "
          "pixels is not computed here");
    pixels.etendue =
        white_image(MicroImages(Camera(scene.camera), true, without_reports(execution_)),
                    pixels.window, without_reports(execution_));
    pixels.mosaic = scene.camera.sensor.mosaic;
    pixels.corrections = {nullptr,         pointer(flat_),       pointer(flat_dark_),
                          pointer(white_), pointer(white_dark_), {}};
    pixels.sensor.gain = levels_.gain;
    pixels.sensor.read_noise = scene.camera.sensor.read_noise;
    pixels.sensor.black_level = levels_.black_level;
    RadiometryTable table;
    table.columns = scene.camera.sensor.columns;
    table.rows = scene.camera.sensor.rows;
    Report report;
    nlohmann::json list = nlohmann::json::array();
    const std::vector<std::size_t> channels = channels_of();
    for (std::size_t n = 0; n < channels.size(); ++n) {
      const bool mosaic = pixels.mosaic != MosaicPattern::none;
      pixels.colour = mosaic ? static_cast<int>(n) : 0;
      pixels.channel = mosaic ? 0 : n;
      const ChannelSpec& channel = scene.channels[channels[n]];
      RadiometryFit fit = fit_channel(channel, sources, temperature_error, pixels);
      fit.scale.white = white_.has_value();
      fit.scale.flat = flat_.has_value();
      table.channels.push_back(fit.scale);
      add(report, list, fit, sources);
    }
    report.add_json("channels", list);
    return {table, report};
  }

 private:
  struct Dark {
    double exposure = 0;
    CountFrames frames;
  };
  struct Taken {
    double exposure = 0;
    CountFrames frames;
    const CountFrames* dark = nullptr;
  };

  void check_size(const CountFrames& frames, const std::string& file) const {
    const SensorSpec& sensor = document_.scene.camera.sensor;
    if (frames.width != sensor.columns || frames.height != sensor.rows)
      throw InputError(fmt::format("'{}' has {} x {} pixels, the camera's sensor {} x {}", file,
                                   frames.width, frames.height, sensor.columns, sensor.rows));
  }

  static const CountFrames* pointer(const std::optional<CountFrames>& frames) {
    return frames ? &*frames : nullptr;
  }

  /// Counts from which on a pixel is full; 0: the largest number.
  double full() const { return full_of(arguments_.files, levels_); }

  /// Flat field and white picture, as import takes them.
  void read_corrections(const std::vector<std::string>& white) {
    const auto read = [&](const std::vector<std::string>& files, double limit,
                          std::optional<CountFrames>& to) {
      if (files.empty()) return;
      to = read_frames(files, arguments_.files, execution_, limit);
      check_size(*to, files[0]);
    };
    const auto read_dark = [&](const std::string& option, const std::vector<std::string>& files,
                               std::optional<CountFrames>& to) {
      constexpr double kNever = 1e9;
      read(files, kNever, to);
      if (to || darks_.empty()) return;
      if (darks_.size() > 1)
        throw UsageError(option +
                         ": there are dark frames of several "
                         "exposures; give those of its own");
      to = darks_.front().frames;
    };
    read(arguments_.flat, full(), flat_);
    read(white, full(), white_);
    if (flat_) read_dark(arguments_.files.names("flat-dark"), arguments_.flat_dark, flat_dark_);
    if (white_) read_dark(arguments_.files.names("white-dark"), arguments_.white_dark, white_dark_);
  }

  Taken picture_of(const TakenFiles& files) const {
    Taken taken{files.exposure > 0 ? files.exposure : exposure_, {}, nullptr};
    if (!(taken.exposure > 0))
      throw UsageError(arguments_.files.names("exposure-time") + ": '" + files.files[0] +
                       "' has no exposure time, nor has the camera's file "
                       "(camera.sensor.exposure_time)");
    taken.frames = read_frames(files.files, arguments_.files, execution_, full());
    check_size(taken.frames, files.files[0]);
    for (const Dark& dark : darks_) {
      const bool same = std::fabs(dark.exposure / taken.exposure - 1) < 0.01;
      if (same || (dark.exposure == 0 && taken.dark == nullptr)) taken.dark = &dark.frames;
    }
    if (!darks_.empty() && taken.dark == nullptr)
      throw InputError("no dark frame was exposed as long as '" + files.files[0] + "' (" +
                       readable(taken.exposure, Dimension::time) + ")");
    return taken;
  }

  SourcePicture source_picture(const Taken& taken) const {
    SourcePicture picture;
    picture.frames = &taken.frames;
    picture.dark = taken.dark;
    picture.black_level = levels_.black_level;
    picture.exposure_time = taken.exposure;
    return picture;
  }

  /// Channels that the pictures have.
  std::vector<std::size_t> channels_of() const {
    const Scene& scene = document_.scene;
    const std::size_t wanted = scene.camera.sensor.mosaic != MosaicPattern::none
                                   ? 3
                                   : source_pictures_.front().frames.mean.size();
    if (wanted == 1) {
      if (arguments_.channel.empty() && scene.channels.size() == 1) return {0};
      for (std::size_t c = 0; c < scene.channels.size(); ++c)
        if (scene.channels[c].name == arguments_.channel) return {c};
      std::string names;
      for (const ChannelSpec& channel : scene.channels)
        names += (names.empty() ? "" : ", ") + channel.name;
      throw UsageError(arguments_.files.names("channel") +
                       ": which of the channels of the camera's file the pictures show: " + names);
    }
    if (scene.channels.size() < wanted)
      throw InputError("the pictures have three channels, the camera's file fewer");
    return {0, 1, 2};
  }

  RadiometryFit fit_channel(const ChannelSpec& channel, const std::vector<TakenFiles>& sources,
                            double temperature_error, const EvaluatedPixels& pixels) const {
    const auto response = camera_response(document_.scene, channel);
    const SourceFunction source =
        response ? SourceFunction::of(*response) : SourceFunction::total();
    std::vector<SourcePicture> of_sources, of_whites;
    for (std::size_t p = 0; p < sources.size(); ++p) {
      SourcePicture picture = source_picture(source_pictures_[p]);
      const double temperature = sources[p].temperature;
      picture.radiance = arguments_.emissivity * source(temperature);
      const double step = 1e-4 * temperature;
      picture.radiance_error = temperature_error *
                               (source(temperature + step) - source(temperature - step)) /
                               (2 * step * source(temperature));
      if (!(picture.radiance > 0))
        throw InputError("channel " + channel.name + " has no light at " +
                         readable(temperature, Dimension::temperature));
      of_sources.push_back(picture);
    }
    for (const Taken& taken : white_pictures_) of_whites.push_back(source_picture(taken));
    const double common =
        std::hypot(arguments_.emissivity_error / arguments_.emissivity, arguments_.etendue_error);
    try {
      RadiometryFit fit = fit_radiometry(of_sources, of_whites, pixels, common);
      fit.scale.channel = channel.name;
      return fit;
    } catch (const InputError& error) {
      throw InputError("channel " + channel.name + ": " + error.what());
    }
  }

  void add(Report& report, nlohmann::json& list, const RadiometryFit& fit,
           const std::vector<TakenFiles>& sources) const {
    const ChannelScale& scale = fit.scale;
    report.add_text("channel", scale.channel + ", " + std::to_string(fit.pixels) + " pixels");
    report.add_text("energy of a count", fmt::format("{:.5e} J +- {}", scale.joules_per_count,
                                                     readable_percent(scale.relative_error)));
    if (exposure_ > 0)
      report.add_text("at the exposure",
                      fmt::format("{:.5e} W per count in {}", scale.joules_per_count / exposure_,
                                  readable(exposure_, Dimension::time)));
    report.add_text("curvature", scale.curvature_error > 0
                                     ? fmt::format("{:.3e} +- {:.1e} per count", scale.curvature,
                                                   scale.curvature_error)
                                     : "not known: taken for 0 (white pictures or three "
                                       "temperatures tell it)");
    nlohmann::json residuals = nlohmann::json::array();
    for (std::size_t p = 0; p < fit.sources.size(); ++p) {
      const RadiometryFit::Residual& residual = fit.sources[p];
      report.add_text(
          "at " + readable(sources[p].temperature, Dimension::temperature),
          fmt::format("{:.1f} counts, off by {:+.3f} %", residual.counts, 100 * residual.relative) +
              (std::isfinite(residual.errors)
                   ? fmt::format(", {:+.1f} of its errors", residual.errors)
                   : std::string()));
      residuals.push_back({{"temperature_K", sources[p].temperature},
                           {"counts", residual.counts},
                           {"relative", residual.relative},
                           {"errors", residual.errors}});
    }
    nlohmann::json whites = nlohmann::json::array();
    for (const RadiometryFit::Residual& residual : fit.whites) {
      report.add_text("white", fmt::format("{:.1f} counts, off by {:+.3f} %", residual.counts,
                                           100 * residual.relative));
      whites.push_back({{"counts", residual.counts}, {"relative", residual.relative}});
    }
    if (fit.chi_squared > 4)
      execution_.warn(
          fmt::format("channel {}: the temperatures contradict "
                      "each other (chi^2 {:.1f} per degree of "
                      "freedom): check temperatures, exposures, "
                      "and that the source fills the part",
                      scale.channel, fit.chi_squared));
    list.push_back({{"name", scale.channel},
                    {"joules_per_count", scale.joules_per_count},
                    {"relative_error", scale.relative_error},
                    {"curvature", scale.curvature},
                    {"curvature_error", scale.curvature_error},
                    {"pixels", fit.pixels},
                    {"chi_squared", fit.chi_squared},
                    {"sources", residuals},
                    {"whites", whites}});
  }

  const RadiometryRequest& arguments_;
  const Execution& execution_;
  const SceneDocument& document_;
  SensorSpec levels_;
  double exposure_ = 0;
  std::list<Dark> darks_;  // pictures point to them
  std::vector<Taken> source_pictures_, white_pictures_;
  std::optional<CountFrames> flat_, flat_dark_, white_, white_dark_;
};

}  // namespace

template <>
std::span<const SettingRow<RadiometryRequest>> setting_rows() {
  using R = RadiometryRequest;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"white", "[TIME=]FILE ...",
       "White picture, as for import. TIME=FILE: one evenly bright scene at three exposures or "
       "more, which tell whether the sensor is linear",
       &R::white, file},
      {"white-dark", "FILE ...", "Dark frames of the white picture (those of the pictures)",
       &R::white_dark, file},
      {"flat", "FILE ...", "Flat field: the bare sensor, evenly lit, as in import", &R::flat, file},
      {"flat-dark", "FILE ...", "Its dark frames (those of the pictures)", &R::flat_dark, file},
      {"dark", "FILE ...", "Dark frames; TIME=FILE: of that exposure", &R::dark, file},
      {"channel", "NAME", "Channel of grey pictures, where the file has several", &R::channel},
      {"exposure-time", "TIME", "Of all that state none (of the camera's file)", &R::exposure},
      {"temperature-error", "TEMPERATURE", "Standard error of each temperature (0 K)",
       &R::temperature_error},
      {"emissivity", "NUMBER", "Of the source", &R::emissivity, between(0.01, 1)},
      {"emissivity-error", "NUMBER", "Its standard error", &R::emissivity_error, between(0, 1)},
      {"etendue-error", "NUMBER",
       "Relative standard error of the camera's etendue: f-number, transmission", &R::etendue_error,
       between(0, 1)},
      {"part", "X,Y,W,H", "Part of the sensor that the source fills (all)", &R::part}};
  return rows;
}

RadiometryCalibration calibrate_radiometry(const RadiometryRequest& request,
                                           const SceneDocument& camera,
                                           const Execution& execution) {
  return RadiometryRun(request, camera, execution).run();
}

}  // namespace plenoflame
