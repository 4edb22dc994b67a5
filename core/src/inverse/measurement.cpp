#include "plenoflame/inverse/measurement.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/sensor.h"
#include "plenoflame/lightfield/smoothed_error.h"
#include "plenoflame/scene/scene_settings.h"
#include "plenoflame/scene/spectral.h"

namespace plenoflame {
namespace {

/// With this number of replicates their scatter alone gives the error of a pixel, to sqrt(1 / 30) =
/// 18 %.
constexpr double kManyReplicates = 16;

void check_belongs(const LightField& picture, const Scene& scene, const std::string& what) {
  const SensorSpec& sensor = scene.camera.sensor;
  if (picture.sensor_width != sensor.columns || picture.sensor_height != sensor.rows)
    throw InputError(what + " does not belong to the scene: its sensor has " +
                     std::to_string(picture.sensor_width) + " x " +
                     std::to_string(picture.sensor_height) + " pixels, the scene's has " +
                     std::to_string(sensor.columns) + " x " + std::to_string(sensor.rows));
  if (picture.unit != "W" && picture.unit != "e-")
    throw InputError(what + " holds " + picture.unit +
                     "; a reconstruction takes fluxes in W, as render writes them, or electrons, "
                     "as develop writes them" +
                     (picture.unit == "DN" ? "; import the pictures in one of these units" : ""));
  if (!may_be_taken_by(picture, scene))
    throw InputError(what +
                     " does not belong to the scene: it was taken by another camera (lens, array, "
                     "focus or place differ)" +
                     (picture.texts.contains("import.pictures")
                          ? "; import the pictures anew with this camera"
                          : ""));
}

/// Factor from a picture's values to W.
double to_watt(const LightField& picture, const Scene& scene, std::size_t channel,
               const std::string& what) {
  if (picture.unit == "W") return 1;
  const double time = channel_exposure(picture, scene.channels[channel].name);
  if (!(time > 0))
    throw InputError(what + " holds electrons but no exposure time: develop it anew");
  ChannelSpec plain = scene.channels[channel];
  plain.photons = false;
  const auto response = scene.channels[channel].photons
                            ? spectral_response(plain)
                            : camera_response(scene, scene.channels[channel]);
  if (!response) throw InputError(what + " holds electrons of a channel of all wavelengths");
  return 1 / (time * electrons_per_joule(scene.camera.sensor, response->centroid()));
}

/// True if each pixel's variance contains the number of its electrons. False for frames developed
/// without shot noise, and for pixels that are means of others.
bool has_shot_noise(const LightFieldChannel& electrons, double full) {
  constexpr double kRounding = 0.999;  // of a square of a float
  bool seen = false;
  for (std::size_t i = 0; i < electrons.flux.pixels.size(); ++i) {
    const auto value = static_cast<double>(electrons.flux.pixels[i]),
               error = static_cast<double>(electrons.standard_error.pixels[i]);
    if (!(value > 1) || value >= full) continue;
    if (!(error * error >= kRounding * value)) return false;
    seen = true;
  }
  return seen;
}

/// Pixels of an imported picture that say nothing: defective, full, or of a mosaic's other colours,
/// whose values are means of neighbours.
class LeftOut {
 public:
  LeftOut(const LightField& picture, const SensorSpec& sensor, std::size_t channel)
      : window_(picture.window), sensor_(sensor), channel_(channel) {
    const auto found = picture.layers.find("sensor.state");
    if (found != picture.layers.end()) state_ = &found->second;
  }
  bool operator()(int column, int row) const {
    if (state_ == nullptr) return false;
    if (state_->at(column, row) != 0) return true;
    return sensor_.mosaic != MosaicPattern::none && channel_ < 3 &&
           mosaic_colour(sensor_.mosaic, window_.x + column, window_.y + row) !=
               static_cast<int>(channel_);
  }
  bool saturated(int column, int row) const {
    return state_ != nullptr && state_->at(column, row) == 2;
  }

 private:
  PixelWindow window_;
  const SensorSpec& sensor_;
  std::size_t channel_;
  const Image* state_ = nullptr;
};

/// True if two cameras stand at almost the same place and are focused almost alike. One is the
/// other as a later calibration has found it.
bool is_almost_at(const CameraSpec& a, const CameraSpec& b) {
  constexpr double kAlmost = 0.02;  // of a distance, or [rad]
  constexpr double kUnknown = 1;    // [m] for an unknown distance of the object
  const auto is_close = [](double x, double y) {
    return x == y || std::fabs(x - y) <= kAlmost * std::fabs(y);
  };
  const double object = b.focus.object_distance;
  const double distance = std::isfinite(object) && object > 0 ? object : kUnknown;
  return length(a.position - b.position) <= kAlmost * distance &&
         length(normalize(a.look_direction) - normalize(b.look_direction)) <= kAlmost &&
         length(normalize(a.up) - normalize(b.up)) <= kAlmost &&
         is_close(a.focus.lens_distance, b.focus.lens_distance) &&
         is_close(a.focus.object_distance, object);
}

/// The camera that a picture names, with the sensor and the name of the scene's camera. The way a
/// frame was taken does not move any ray.
CameraSpec camera_of(const LightField& picture, const Scene& scene) {
  CameraSpec own = parse_embedded_scene(picture.scene_text, "the picture").scene.camera;
  own.sensor = scene.camera.sensor;
  own.wavelength = scene.camera.wavelength;  // not in files
  own.name = scene.camera.name;
  return own;
}

bool fits_sensor(const LightField& picture, const SensorSpec& sensor) {
  return picture.sensor_width == sensor.columns && picture.sensor_height == sensor.rows;
}

}  // namespace

bool may_be_taken_by(const LightField& picture, const Scene& scene) {
  if (!fits_sensor(picture, scene.camera.sensor)) return false;
  if (picture.scene_text.empty()) return true;
  CameraSpec own = camera_of(picture, scene);
  if (!is_almost_at(own, scene.camera)) return false;
  own.position = scene.camera.position;
  own.look_direction = scene.camera.look_direction;
  own.up = scene.camera.up;
  own.focus.lens_distance = scene.camera.focus.lens_distance;
  own.focus.object_distance = scene.camera.focus.object_distance;
  return own == scene.camera;
}

bool was_taken_by(const LightField& picture, const Scene& scene) {
  return fits_sensor(picture, scene.camera.sensor) && !picture.scene_text.empty() &&
         camera_of(picture, scene) == scene.camera;
}

Measurement take_measurement(const LightField& picture, const Scene& scene, std::size_t channel,
                             double noise, const std::string& what) {
  check_belongs(picture, scene, what);
  const LightFieldChannel& own = find_channel(picture, scene.channels.at(channel).name, what);
  const double factor = to_watt(picture, scene, channel, what);
  const bool electrons = picture.unit == "e-";
  const auto number = [&](const char* key, double otherwise) {
    const auto found = picture.numbers.find(key);
    return found == picture.numbers.end() ? otherwise : found->second;
  };
  const double dark = electrons ? channel_dark_electrons(picture, own.name) : 0;
  const double full = electrons ? number("sensor.saturated_from", 1e300) : 1e300;
  const bool has_error = !own.standard_error.empty();
  // A rendering as it is has few replicates; frames of develop have counts, whose error is known.
  const double replicates = electrons ? 0 : number("render.replicates", 0);
  const Image errors = has_error && replicates >= 2 && replicates < kManyReplicates
                           ? smoothed_error(own.flux, own.standard_error)
                           : own.standard_error;

  Measurement result;
  result.window = picture.window;
  result.scale_error = number(("scale.error." + own.name).c_str(), 0);
  if (electrons && has_error && has_shot_noise(own, full)) {
    result.electron = factor;
    result.dark = factor * dark;
  }
  result.flux = Image(own.flux.width, own.flux.height);
  result.deviation = result.flux;
  const LeftOut left_out(picture, scene.camera.sensor, channel);
  double largest = 0;
  for (int row = 0; row < own.flux.height; ++row)
    for (int column = 0; column < own.flux.width; ++column) {
      const double value = static_cast<double>(own.flux.at(column, row));
      if (!std::isfinite(value))
        throw InputError(what + " has a value that is not finite in pixel " +
                         std::to_string(picture.window.x + column) + "," +
                         std::to_string(picture.window.y + row));
      if (value < full && !left_out(column, row)) largest = std::max(largest, value - dark);
    }
  if (!(largest > 0)) throw InputError(what + " is dark in channel " + own.name);
  if (!has_error && !(noise > 0))
    throw InputError(what + " has no standard error, and no noise is given");
  // No pixel is known better than a part in a million of the brightest.
  const double least = 1e-6 * largest, model_error = noise * largest;
  result.model_error = factor * model_error;
  for (int row = 0; row < own.flux.height; ++row)
    for (int column = 0; column < own.flux.width; ++column) {
      const double value = static_cast<double>(own.flux.at(column, row));
      if (value >= full || left_out.saturated(column, row)) {
        ++result.saturated;
        continue;
      }
      if (left_out(column, row)) continue;
      // A pixel that counted nothing is known to about one electron.
      double error = has_error ? static_cast<double>(errors.at(column, row)) : 0;
      if (!std::isfinite(error)) error = 0;
      if (electrons) error = std::max(error, 1.0);
      const double deviation = std::hypot(error, least);
      result.negative += value - dark < -5 * std::hypot(deviation, model_error);
      result.flux.at(column, row) = static_cast<float>(factor * (value - dark));
      result.deviation.at(column, row) = static_cast<float>(factor * deviation);
    }
  return result;
}

MeasuredRows measured_rows(const std::vector<Measurement>& measurements, const CameraRays& rays,
                           int bin) {
  MeasuredRows result;
  result.flux.reserve(rays.rows.size());
  result.deviation.reserve(rays.rows.size());
  for (std::size_t r = 0; r < rays.rows.size(); ++r) {
    const Measurement& from = measurements.at(static_cast<std::size_t>(rays.rows[r].view));
    double flux = 0, variance = 0, counted = 0, pixels = 0;
    bool whole = true;
    rays.for_each_pixel(r, bin, [&](int sensor_column, int sensor_row) {
      const int column = sensor_column - from.window.x, line = sensor_row - from.window.y;
      const double deviation = static_cast<double>(from.deviation.at(column, line));
      whole = whole && deviation > 0;
      flux += static_cast<double>(from.flux.at(column, line));
      variance += deviation * deviation;
      counted += std::max(static_cast<double>(from.flux.at(column, line)) + from.dark, 0.0);
      ++pixels;
    });
    result.flux.push_back(flux);
    result.deviation.push_back(whole ? std::hypot(std::sqrt(variance), pixels * from.model_error)
                                     : 0);
    result.electron.push_back(from.electron);
    result.counted.push_back(counted - pixels * from.dark);
  }
  return result;
}

SourceFunction channel_source(const Scene& scene, std::size_t channel) {
  const auto response = camera_response(scene, scene.channels.at(channel));
  return response ? SourceFunction::of(*response) : SourceFunction::total();
}

double source_slope(const SourceFunction& source, double temperature) {
  if (!(temperature > 0)) return 0;
  if (source.is_total()) return 4 * source(temperature) / temperature;
  if (source.nodes().empty())
    throw UsageError("a source function that shares a whole has no derivative");
  // d/dT of w / (e^u - 1) with u = exponent / T: w u / T e^u / (e^u - 1)^2.
  double sum = 0;
  for (const SourceFunction::Node& node : source.nodes()) {
    const double u = node.exponent / temperature;
    const double below = -std::expm1(-u);  // 1 - e^-u
    sum += node.weight * u / temperature * std::exp(-u) / (below * below);
  }
  return sum;
}

double temperature_of(const SourceFunction& source, double value, double highest) {
  if (!(value > 0)) return 0;
  double low = 1, high = highest;
  if (source(high) <= value) return highest;
  // In the logarithm: S spans hundreds of decades.
  for (int i = 0; i < 200 && high > std::nextafter(low, high); ++i) {
    const double middle = i < 10 ? std::sqrt(low * high) : 0.5 * (low + high);
    (source(middle) < value ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace plenoflame
