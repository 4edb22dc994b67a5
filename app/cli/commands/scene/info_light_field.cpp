#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "commands/scene/info.h"
#include "options.h"
#include "plenoflame/film/film.h"
#include "plenoflame/film/reopened.h"
#include "plenoflame/image/light_field.h"

namespace plenoflame::cli {
namespace {

struct ChannelSummary {
  double total = 0;
  double largest = 0;
  std::size_t lit = 0;  ///< above kLitShare of the largest flux
  std::size_t not_finite = 0;
  double relative_error = 0;  ///< by the standard errors, over lit pixels
};

ChannelSummary summarize(const LightFieldChannel& channel) {
  ChannelSummary summary;
  for (const float value : channel.flux.pixels) {
    if (!std::isfinite(value)) {
      ++summary.not_finite;
      continue;
    }
    summary.total += static_cast<double>(value);
    summary.largest = std::max(summary.largest, static_cast<double>(value));
  }
  for (const float value : channel.flux.pixels)
    if (static_cast<double>(value) > kLitShare * summary.largest) ++summary.lit;
  if (!channel.standard_error.empty() && summary.not_finite == 0)
    summary.relative_error = estimated_relative_rmse(channel.flux, channel.standard_error);
  return summary;
}

/// A figure among the attributes, with the unit that its name stands for.
std::string with_unit(const std::string& key, double value) {
  constexpr std::pair<std::string_view, std::string_view> kOthers[] = {
      {"sensor.exposure_time", "s"},
      {"exposure.time", "s"},
      {"exposure.begin", "s"},
      {"exposure.energy", "J"},
      {"sensor.dark_electrons", "e-"},
      {"sensor.gain", "e- per number"},
      {"sensor.saturated_from", "e-"},
      {"sensor.black_level", "counts"},
      {"view.offset_x", "pixels"},
      {"view.offset_y", "pixels"},
      {"lens.f_number", ""},
      {"render.replicates", ""},
      {"view.column", ""},
      {"view.row", ""},
      {"view.lens_step", ""},
      {"epipolar.line", ""}};
  for (const auto& [name, unit] : kOthers)
    if (name == key)
      return unit == "s"    ? readable(value, Dimension::time)
             : unit.empty() ? readable_number(value)
                            : readable_number(value) + " " + std::string(unit);
  for (const char* known : {"lens.", "array.", "sensor.", "focus.", "refocus.", "truth.wavelength"})
    if (key.starts_with(known)) return readable(value, Dimension::length);
  return readable_number(value);
}

void describe_channel(const LightFieldChannel& channel, const std::string& unit, Report& report,
                      nlohmann::json& list) {
  const ChannelSummary summary = summarize(channel);
  std::string text = readable_in(summary.total, unit) + " in " + std::to_string(summary.lit) +
                     " lit pixels, largest " + readable_in(summary.largest, unit);
  // Keys end with the unit where it is one of SI.
  const std::string ending = unit == "W" || unit == "K" || unit == "m" ? "_" + unit : "";
  nlohmann::json entry = {{"name", channel.name},
                          {"unit", unit},
                          {"total" + ending, summary.total},
                          {"largest" + ending, summary.largest},
                          {"lit_pixels", summary.lit},
                          {"not_finite_pixels", summary.not_finite}};
  if (!channel.standard_error.empty()) {
    text += ", error " + readable_percent(summary.relative_error);
    entry["relative_error"] = summary.relative_error;
  }
  if (summary.not_finite > 0)
    text += ", " + std::to_string(summary.not_finite) + " pixels NOT FINITE";
  report.add_text("channel " + channel.name, text);
  list.push_back(entry);
}

/// "4 to 64 per replicate, 12 tiles of 48 have none"; the whole list is in the JSON.
std::string tile_samples_summary(const LightField& field) {
  const Film film(field.window, 1, 1);
  const std::vector<double> samples = tile_samples_of(field, 1, film.tile_count());
  const auto [least, most] = std::minmax_element(samples.begin(), samples.end());
  std::string text = readable_number(*least) + " to " + readable_number(*most) + " per replicate";
  const auto none = std::count(samples.begin(), samples.end(), 0.0);
  if (none > 0)
    text +=
        ", " + std::to_string(none) + " tiles of " + std::to_string(samples.size()) + " have none";
  return text;
}

}  // namespace

void describe_light_field(const std::string& path, Report& report) {
  const LightField field = read_light_field(path);
  const PixelWindow& window = field.window;
  report.add("type", "light field", "type", "light field");
  report.add(
      "sensor",
      std::to_string(field.sensor_width) + " x " + std::to_string(field.sensor_height) + " pixels",
      "sensor", {field.sensor_width, field.sensor_height});
  const bool whole = window == PixelWindow{0, 0, field.sensor_width, field.sensor_height};
  report.add("window",
             whole ? std::string("whole sensor")
                   : std::to_string(window.width) + " x " + std::to_string(window.height) + " at " +
                         std::to_string(window.x) + "," + std::to_string(window.y),
             "window", {window.x, window.y, window.width, window.height});
  nlohmann::json channels = nlohmann::json::array();
  for (const LightFieldChannel& channel : field.channels)
    describe_channel(channel, field.unit, report, channels);
  report.add_json("channels", channels);
  nlohmann::json layers = nlohmann::json::array();
  for (const auto& layer : field.layers) {
    report.add_text("layer", layer.first);
    layers.push_back(layer.first);
  }
  report.add_json("layers", layers);
  report.add("complete", field.complete ? "yes" : "no: the run was stopped early", "complete",
             field.complete);
  report.add("estimator", field.estimator, "estimator", field.estimator);
  report.add("samples", readable_number(field.samples), "samples", field.samples);
  report.add("seed", std::to_string(field.seed), "seed", field.seed);
  report.add("version", field.version, "version", field.version);
  for (const auto& [key, value] : field.numbers) report.add_text(key, with_unit(key, value));
  report.add_json("numbers", field.numbers);
  for (const auto& [key, value] : field.texts)
    report.add_text(key, key == kTileSamples ? tile_samples_summary(field) : value);
  report.add_json("texts", field.texts);
  report.add("scene", std::to_string(field.scene_text.size()) + " characters (--scene prints it)",
             "scene", field.scene_text);
}

}  // namespace plenoflame::cli
