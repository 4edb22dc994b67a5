#include "raw_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>

#include "number_rows.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/base/report.h"
#include "plenoflame/calibration/radiometry_table.h"
#include "plenoflame/calibration/raw_import.h"
#include "plenoflame/camera/sensor_levels.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/lightfield/geometry.h"
#include "plenoflame/lightfield/sensor.h"
#include "plenoflame/render/describe.h"
#include "plenoflame/scene/spectral.h"
#include "raw_channels.h"

namespace plenoflame {
namespace {

std::vector<std::uint8_t> defects_of(const RawPicturesRequest& arguments, const CountFrames& raw,
                                     const CountFrames* dark, const Execution& execution) {
  if (arguments.defects.empty()) return {};
  if (arguments.defects == "auto") {
    if (dark == nullptr)
      throw UsageError(arguments.names()("defects", "auto") + ": takes dark frames (" +
                       arguments.names()("dark") + ")");
    return hot_pixels(*dark);
  }
  std::vector<std::uint8_t> defects(raw.pixel_count(), 0);
  const std::filesystem::path path(arguments.defects);
  if (path.extension() == ".csv" || path.extension() == ".txt") {
    for (const NumberRow& row :
         read_number_rows(arguments.defects, {2}, "a defective pixel: column,row")) {
      const double x = row.values[0], y = row.values[1];
      if (x != std::floor(x) || y != std::floor(y) || x < 0 || y < 0 || x >= raw.width ||
          y >= raw.height)
        throw InputError(row.at, "not a pixel of the picture");
      defects[static_cast<std::size_t>(y) * static_cast<std::size_t>(raw.width) +
              static_cast<std::size_t>(x)] = 1;
    }
    return defects;
  }
  RawFileOptions as_it_is = arguments.files;
  as_it_is.shift = 0;
  as_it_is.bits = {};
  const CountFrames map = read_frames({arguments.defects}, as_it_is, execution, 1e9);
  if (map.pixel_count() != raw.pixel_count() || map.width != raw.width)
    throw InputError("'" + arguments.defects + "' is not of the picture's size");
  for (std::size_t i = 0; i < defects.size(); ++i)
    for (const Image& channel : map.mean) defects[i] |= channel.pixels[i] != 0;
  return defects;
}

/// Frames of corrections of one channel.
struct CorrectionFrames {
  std::optional<CountFrames> dark, flat, flat_dark, white, white_dark;
  CorrectionFrames(const RawPicturesRequest& arguments, const std::string& channel,
                   const Scene& scene, double full, const Execution& execution) {
    const auto read = [&](const char* option, const std::vector<std::string>& values,
                          std::optional<CountFrames>& to, double limit) {
      const std::vector<std::string> files =
          values_of_channel(arguments.names()(option), values, channel, scene);
      if (!files.empty()) to = read_frames(files, arguments.files, execution, limit);
    };
    constexpr double kNever = 1e9;
    read("dark", arguments.dark, dark, kNever);
    read("flat", arguments.flat, flat, full);
    read("flat-dark", arguments.flat_dark, flat_dark, kNever);
    read("white", arguments.white, white, full);
    read("white-dark", arguments.white_dark, white_dark, kNever);
  }
  RawCorrections corrections() const {
    const auto pointer = [](const std::optional<CountFrames>& frames) {
      return frames ? &*frames : nullptr;
    };
    return {pointer(dark),  pointer(flat),       pointer(flat_dark),
            pointer(white), pointer(white_dark), {}};
  }
};

double median_level(const CountFrames& frames) {
  std::vector<float> values(frames.mean[0].pixels.begin(), frames.mean[0].pixels.end());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

/// The whole command, step by step.
class ImportRun {
 public:
  ImportRun(const RawPicturesRequest& arguments, const SceneDocument& camera,
            const Execution& execution)
      : arguments_(arguments), execution_(execution), document_(camera) {}

  RawPictures run() {
    static_cast<void>(arguments_.files.layout());  // bad use is found before bad files
    read_response_options();
    levels_ = resolved_levels(document_.scene.camera.sensor);
    fill_response();
    settings_.mosaic = document_.scene.camera.sensor.mosaic;
    RawPictures result;
    LightField& field = result.light_field;
    for (const ChannelFiles& files : channel_files(arguments_, document_.scene)) {
      LightField part = import_one(files);
      if (field.channels.empty()) {
        field = std::move(part);
      } else {
        add(field, std::move(part));
      }
    }
    finish(field);
    report(field, result.report);
    return result;
  }

 private:
  void read_response_options() {
    SensorResponse& response = settings_.response;
    if (arguments_.gain && !(*arguments_.gain > 0))
      throw UsageError(arguments_.names()("gain") + ": above 0");
    response.gain = arguments_.gain.value_or(response.gain);
    response.read_noise = arguments_.read_noise.value_or(response.read_noise);
    response.black_level = arguments_.black_level.value_or(response.black_level);
    full_ = arguments_.saturation.value_or(full_);
    settings_.noise = arguments_.noise == "series"  ? NoiseSource::series
                      : arguments_.noise == "pixel" ? NoiseSource::pixel
                                                    : NoiseSource::sensor;
    settings_.unit =
        arguments_.unit == "W" || (arguments_.unit.empty() && !arguments_.radiometry.empty())
            ? ImportUnit::watts
        : arguments_.unit == "DN" ? ImportUnit::counts
                                  : ImportUnit::electrons;
  }

  /// The camera's file says what options do not.
  void fill_response() {
    const SensorSpec& sensor = document_.scene.camera.sensor;
    SensorResponse& response = settings_.response;
    if (!arguments_.gain) response.gain = levels_.gain;
    if (!arguments_.read_noise) response.read_noise = sensor.read_noise;
    if (!arguments_.black_level) response.black_level = levels_.black_level;
    response.dark_current = sensor.dark_current;
    if (!arguments_.saturation && !arguments_.gain) full_ = full_counts(levels_);
  }

  /// The exposure time of a channel's pictures [s]; 0: nothing says it.
  double exposure_of(const std::string& channel) const {
    const std::string name = arguments_.names()("exposure-time");
    const std::vector<std::string> values =
        values_of_channel(name, arguments_.exposure_time, channel, document_.scene);
    if (values.size() > 1) throw UsageError(name + ": one for all channels, or NAME=TIME for each");
    return values.empty() ? document_.scene.camera.sensor.exposure_time
                          : exposure_of_text(name, values.front());
  }

  PixelWindow window_of(const CountFrames& raw, const std::string& file) const {
    const SensorSpec& sensor = document_.scene.camera.sensor;
    PixelWindow window{0, 0, sensor.columns, sensor.rows};
    if (!arguments_.window.empty())
      window = window_option(arguments_.names()("window"), arguments_.window);
    if (window.x + window.width > sensor.columns || window.y + window.height > sensor.rows)
      throw UsageError(arguments_.names()("window") + ": it does not lie on the sensor");
    if (window.width != raw.width || window.height != raw.height)
      throw InputError(fmt::format(
          "'{}' has {} x {} pixels, the {} {} x {}: {}", file, raw.width, raw.height,
          arguments_.window.empty() ? "camera's sensor" : "window", window.width, window.height,
          arguments_.window.empty()
              ? "give the camera's columns and rows, or with " + arguments_.names()("window") +
                    " the part that was read out"
              : "the window is the part of the sensor that was read out"));
    return window;
  }

  void check_not_full(const CountFrames& raw, const std::string& file) const {
    constexpr double kMost = 0.5;
    const double share =
        static_cast<double>(raw.saturated) / static_cast<double>(raw.pixel_count());
    if (share > kMost)
      throw InputError(
          fmt::format("{:.0f} % of the pixels of '{}' are full ({:g} counts or "
                      "more), which tells nothing of "
                      "their light: expose it less, or see to the saturation, "
                      "and to full_well, gain and bits of "
                      "the camera's file",
                      100 * share, file, full_ > 0 ? full_ : std::ldexp(1.0, raw.bits) - 1));
  }

  LightField import_one(const ChannelFiles& files) {
    const std::string channel = files.channels.empty() ? "" : files.channels.front();
    settings_.response.exposure_time = exposure_of(channel);
    frames_ =
        std::make_unique<CorrectionFrames>(arguments_, channel, document_.scene, full_, execution_);
    const CountFrames raw = read_frames(files.files, arguments_.files, execution_, full_);
    check_not_full(raw, files.files.front());
    settings_.window = window_of(raw, files.files.front());
    settings_.names = names_of(files, raw, document_.scene, settings_.mosaic != MosaicPattern::none,
                               arguments_.names());
    RawCorrections corrections = frames_->corrections();
    corrections.defects = defects_of(arguments_, raw, corrections.dark, execution_);
    const SensorSpec& sensor = document_.scene.camera.sensor;
    if (corrections.dark != nullptr && !arguments_.black_level && !(sensor.black_level > 0))
      settings_.response.black_level = median_level(*corrections.dark);
    for (const std::string& name : settings_.names) {
      exposures_[name] = settings_.response.exposure_time;
      if (!frames_->dark) without_dark_.insert(name);
    }
    fit_noise(raw, corrections);
    if (full_ > 0 && full_ <= settings_.response.black_level)
      throw UsageError(
          fmt::format("{}: pixels are not full at {:g} counts, which is no "
                      "more than the level without light, "
                      "{:g}",
                      arguments_.names()("saturation"), full_, settings_.response.black_level));
    set_scale();
    if (corrections.white != nullptr && settings_.model_white.empty()) {
      const CameraSpec& camera = document_.scene.camera;
      if (!camera.array.present)
        throw InputError(arguments_.names()("white") +
                         ": the camera has no microlens array; give a flat field");
      settings_.model_white =
          white_image(MicroImages(Camera(camera), true, without_reports(execution_)),
                      settings_.window, without_reports(execution_));
    }
    frames_read_ = raw.frames;
    ImportSummary summary;
    LightField field = import_counts(raw, corrections, settings_, summary);
    add(summary);
    return field;
  }

  /// Adds the summary of one channel's pictures to the others'.
  void add(const ImportSummary& part) {
    ++pictures_;
    summary_.negative += part.negative;
    summary_.too_dark = std::max(summary_.too_dark, part.too_dark);
    summary_.largest = std::max(summary_.largest, part.largest);
    summary_.white_correction = std::max(summary_.white_correction, part.white_correction);
    summary_.dark_level += (part.dark_level - summary_.dark_level) / pictures_;
  }

  void fit_noise(const CountFrames& raw, const RawCorrections& corrections) {
    if (raw.frames < 2) {
      if (settings_.noise != NoiseSource::sensor)
        throw UsageError(arguments_.names()("noise", arguments_.noise) +
                         ": takes several frames of one scene");
      return;
    }
    if (settings_.noise == NoiseSource::pixel && raw.frames < 10)
      throw UsageError(arguments_.names()("noise", "pixel") +
                       ": a pixel's own scatter takes 10 frames or more; with fewer, " +
                       arguments_.names()("noise", "series") + " asks all pixels");
    try {
      settings_.transfer = fit_photon_transfer(
          raw, 0, corrections.dark != nullptr ? corrections.dark->mean[0] : Image(),
          settings_.response.black_level);
      fitted_ = true;
    } catch (const InputError& error) {
      if (settings_.noise == NoiseSource::series)
        throw InputError(arguments_.names()("noise", "series") + ": " + error.what());
    }
    const SensorSpec& sensor = document_.scene.camera.sensor;
    const PhotonTransfer& transfer = settings_.transfer;
    // Without a stated gain, the noise gives it if it is significant.
    if (fitted_ && !arguments_.gain && !(sensor.gain > 0) &&
        transfer.slope > 10 * transfer.slope_error) {
      settings_.response.gain = 1 / transfer.slope;
      gain_from_ = "from the scatter of the series";
    }
  }

  /// The channels of all files.
  RadiometryTable radiometry() const {
    const SensorSpec& sensor = document_.scene.camera.sensor;
    RadiometryTable all;
    for (const std::string& path : arguments_.radiometry) {
      const RadiometryTable table = read_radiometry(path);
      if (table.columns != sensor.columns || table.rows != sensor.rows)
        throw InputError("'" + path + "' is of another sensor: " + std::to_string(table.columns) +
                         " x " + std::to_string(table.rows) + " pixels");
      for (const ChannelScale& scale : table.channels) {
        const auto same = [&](const ChannelScale& other) { return other.channel == scale.channel; };
        if (std::any_of(all.channels.begin(), all.channels.end(), same))
          throw InputError(arguments_.names()("radiometry") +
                           ": two of the files have a scale of channel " + scale.channel);
        all.channels.push_back(scale);
      }
    }
    return all;
  }

  /// Watts are right where both, the pictures of the blackbody and these, were evened out alike.
  void check_evened_out(const ChannelScale& scale) const {
    const auto check = [&](const char* what, const std::string& option, bool there, bool here) {
      if (there == here) return;
      execution_.warn(arguments_.names()("radiometry") + ": the scale of channel " + scale.channel +
                      " was found with" + (there ? "" : "out") + " a " + what +
                      ", these pictures have " + (here ? "one" : "none") + ": give " + option +
                      " to both commands, or to none");
    };
    check("white picture", arguments_.names()("white"), scale.white, frames_->white.has_value());
    check("flat field", arguments_.names()("flat"), scale.flat, frames_->flat.has_value());
  }

  void set_scale() {
    settings_.watts_per_count.clear();
    settings_.curvatures.clear();
    if (settings_.unit != ImportUnit::watts) return;
    const SensorResponse& response = settings_.response;
    if (!(response.exposure_time > 0))
      throw UsageError(arguments_.names()("unit", "W") + ": flux of channel " +
                       settings_.names.front() + " is energy by time; give " +
                       arguments_.names()("exposure-time") + ", or camera.sensor.exposure_time");
    if (!arguments_.radiometry.empty()) {
      const RadiometryTable table = radiometry();
      for (const std::string& name : settings_.names) {
        const ChannelScale& scale = scale_of(table, name, arguments_.radiometry.front());
        settings_.watts_per_count.push_back(scale.joules_per_count / response.exposure_time);
        settings_.curvatures.push_back(scale.curvature);
        scale_errors_[name] = scale.relative_error;
        check_evened_out(scale);
      }
      return;
    }
    const std::vector<double> wavelengths = channel_wavelengths(document_.scene);
    for (const std::string& name : settings_.names) {
      const double wavelength =
          wavelengths[channel_number(document_.scene, name, arguments_.names())];
      if (!(wavelength > 0))
        throw InputError("channel " + name +
                         " is of all wavelengths, so no flux follows from "
                         "electrons; give its band, "
                         "line or response in the camera's file, or " +
                         arguments_.names()("radiometry"));
      settings_.watts_per_count.push_back(
          response.gain / (response.exposure_time *
                           electrons_per_joule(document_.scene.camera.sensor, wavelength)));
    }
  }

  /// Puts the channels of another picture beside those that are there.
  void add(LightField& field, LightField part) const {
    if (!(part.window == field.window)) throw InputError("pictures of two channels differ in size");
    for (LightFieldChannel& channel : part.channels) field.channels.push_back(std::move(channel));
    Image& state = field.layers.at("sensor.state");
    const Image& other = part.layers.at("sensor.state");
    for (std::size_t i = 0; i < state.pixels.size(); ++i)
      state.pixels[i] = std::max(state.pixels[i], other.pixels[i]);
  }

  void finish(LightField& field) {
    for (const float state : field.layers.at("sensor.state").pixels) {
      summary_.saturated += state == static_cast<float>(PixelState::saturated);
      summary_.defective += state == static_cast<float>(PixelState::defective);
    }
    const SensorSpec& sensor = document_.scene.camera.sensor;
    field.sensor_width = sensor.columns;
    field.sensor_height = sensor.rows;
    Scene scene = document_.scene;
    describe(scene, Camera(scene.camera), field);
    const SensorResponse& response = settings_.response;
    field.numbers["sensor.gain"] = response.gain;
    field.numbers["sensor.black_level"] = response.black_level;
    for (const auto& [name, time] : exposures_) {
      const std::string end = same_exposure() ? "" : "." + name;
      if (time > 0) field.numbers["sensor.exposure_time" + end] = time;
      if (settings_.unit == ImportUnit::electrons && without_dark_.contains(name))
        field.numbers["sensor.dark_electrons" + end] = response.dark_current * time;
    }
    field.numbers["import.frames"] = frames_read_;
    for (const auto& [name, error] : scale_errors_) field.numbers["scale.error." + name] = error;
    std::string names;
    for (const std::string& raw : arguments_.raw)
      names += (names.empty() ? "" : ", ") + std::filesystem::path(raw).filename().string();
    field.texts["import.pictures"] = names;
  }

  bool same_exposure() const {
    return std::all_of(exposures_.begin(), exposures_.end(),
                       [&](const auto& each) { return each.second == exposures_.begin()->second; });
  }

  void report(const LightField& field, Report& report) const {
    report.add("size", fmt::format("{} x {} pixels", field.window.width, field.window.height),
               "size", {field.window.width, field.window.height});
    std::string names;
    nlohmann::json list = nlohmann::json::array();
    for (const LightFieldChannel& channel : field.channels) {
      names += (names.empty() ? "" : ", ") + channel.name;
      list.push_back(channel.name);
    }
    report.add("channels", names + ", in " + field.unit, "channels", list);
    report.add_json("unit", field.unit);
    report.add("frames", std::to_string(frames_read_), "frames", frames_read_);
    const SensorResponse& response = settings_.response;
    report.add("gain", readable_number(response.gain) + " electrons per count, " + gain_text(),
               "gain", response.gain);
    if (fitted_) {
      report.add("noise of the series",
                 fmt::format("{:.3g} counts^2 + {:.4g} x counts above dark (slope +- {:.1g})",
                             settings_.transfer.floor, settings_.transfer.slope,
                             settings_.transfer.slope_error),
                 "series_slope", settings_.transfer.slope);
      report.add_json("series_slope_error", settings_.transfer.slope_error);
      report.add_json("series_floor", settings_.transfer.floor);
    }
    report.add("dark level", readable_number(summary_.dark_level) + " counts", "dark_level",
               summary_.dark_level);
    if (same_exposure()) {
      if (response.exposure_time > 0)
        report.add("exposure", readable(response.exposure_time, Dimension::time), "exposure_time_s",
                   response.exposure_time);
    } else {
      for (const auto& [name, time] : exposures_)
        report.add("exposure of " + name, readable(time, Dimension::time),
                   "exposure_time_s_" + name, time);
    }
    report.add("largest value", readable_in(summary_.largest, field.unit), "largest",
               summary_.largest);
    report.add("saturated pixels", std::to_string(summary_.saturated), "saturated",
               summary_.saturated);
    report.add("defective pixels",
               std::to_string(summary_.defective) +
                   (summary_.too_dark > 0 ? ", of which " + std::to_string(summary_.too_dark) +
                                                " are too dark in the white picture or flat field "
                                                "(dirt, edges of micro-images)"
                                          : ""),
               "defective", summary_.defective);
    report.add_json("too_dark", summary_.too_dark);
    if (summary_.white_correction > 0)
      report.add("white correction", readable_percent(summary_.white_correction) + " RMS",
                 "white_correction", summary_.white_correction);
    for (const auto& [name, error] : scale_errors_)
      report.add("scale of " + name, "known to " + readable_percent(error), "scale_error_" + name,
                 error);
    if (summary_.negative > 0)
      report.add("below zero",
                 std::to_string(summary_.negative) + " pixels, by more than 5 standard errors",
                 "negative", summary_.negative);
    if (summary_.negative > 0)
      execution_.warn(
          fmt::format("{} pixels are below 0 by more than 5 standard errors: "
                      "is the dark frame (or the black "
                      "level) of this exposure?",
                      summary_.negative));
  }

  std::string gain_text() const {
    if (arguments_.gain) return "as given";
    if (!gain_from_.empty()) return gain_from_;
    return document_.scene.camera.sensor.gain > 0 ? "of the camera's file"
                                                  : "as if the full well filled the range";
  }

  const RawPicturesRequest& arguments_;
  const Execution& execution_;
  const SceneDocument& document_;
  SensorSpec levels_;
  double full_ = 0;  ///< counts from which on a pixel is full
  std::unique_ptr<CorrectionFrames> frames_;
  ImportSettings settings_;
  ImportSummary summary_;  ///< of all channels
  int pictures_ = 0;       ///< that have their part in it
  bool fitted_ = false;
  int frames_read_ = 0;
  std::string gain_from_;
  std::map<std::string, double> scale_errors_;
  std::map<std::string, double> exposures_;  ///< [s] of each channel
  std::set<std::string> without_dark_;       ///< channels whose dark signal is in their electrons
};

}  // namespace

RawPictures import_pictures(const RawPicturesRequest& request, const SceneDocument& camera,
                            const Execution& execution) {
  return ImportRun(request, camera, execution).run();
}

}  // namespace plenoflame
