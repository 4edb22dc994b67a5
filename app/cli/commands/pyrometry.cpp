#include "plenoflame/lightfield/pyrometry.h"
#include "number_range.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "commands/commands.h"
#include "commands/develop_sensor.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/png_file.h"
#include "plenoflame/lightfield/sensor.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/spectral.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

struct Settings {
  std::string input, output, picture, truth, law, range;
  std::vector<std::string> channels;
  double exponent = 1, threshold = 0.01;
  bool json = false;
};

/// The law that the option or else the scene's flames say.
AbsorptionSpectrum law_of(const Settings& settings, const Scene& scene, std::string& name) {
  if (settings.law == "grey" || (settings.law.empty() && scene.flames.empty())) {
    name = "grey";
    return {};
  }
  if (settings.law == "power") {
    name = "(1/wavelength)^" + readable_number(settings.exponent);
    return AbsorptionSpectrum::power(650e-9, settings.exponent);
  }
  if (settings.law == "soot") {
    name = "soot, 1/wavelength";
    return AbsorptionSpectrum::soot(650e-9, SootIndex::constant, 0.26);
  }
  name = "as the scene's flames";
  for (const FlameSpec& flame : scene.flames)
    if (!(flame.spectrum == scene.flames.front().spectrum))
      throw UsageError("--law: the scene's flames have different spectra; say which law to take");
  const AbsorptionSpectrum law = absorption_spectrum(scene.flames.front().spectrum);
  if (law.is_grey()) name = "grey, as the scene's flames";
  return law;
}

std::size_t index_of(const LightField& field, const std::string& name) {
  const LightFieldChannel& channel = find_channel(field, name);
  return static_cast<std::size_t>(&channel - field.channels.data());
}

/// In proportion to energy, without the dark signal: what the ratio is formed of.
LightFieldChannel energy_of(const LightField& field, const Scene& scene, std::size_t index) {
  LightFieldChannel channel = field.channels[index];
  if (field.unit != "e-") return channel;
  const double wavelength = channel_wavelengths(scene)[index];
  const auto dark = field.numbers.find("sensor.dark_electrons");
  const double zero = dark == field.numbers.end() ? 0 : dark->second;
  for (float& value : channel.flux.pixels)
    value = static_cast<float>((static_cast<double>(value) - zero) / (1e9 * wavelength));
  for (float& value : channel.standard_error.pixels)
    value = static_cast<float>(static_cast<double>(value) / (1e9 * wavelength));
  return channel;
}

/// Temperatures in false colours, black where there is none; at the right edge a bar with the whole
/// range, the highest on top.
void write_picture(const std::string& path, const Image& temperature, double low, double high) {
  const int gap = 4, bar = 12;
  PngImage picture;
  picture.width = temperature.width + gap + bar;
  picture.height = temperature.height;
  picture.channels = 3;
  for (int row = 0; row < picture.height; ++row)
    for (int column = 0; column < picture.width; ++column) {
      double t = 0;
      if (column < temperature.width)
        t = static_cast<double>(temperature.at(column, row));
      else if (column >= temperature.width + gap)
        t = high - (high - low) * (row + 0.5) / picture.height;
      const double x = std::clamp((t - low) / (high - low), 0.0, 1.0);
      // Black body like: dark red, red, yellow, white.
      const double rgb[3] = {0.25 + 2.2 * x, 2.6 * x - 0.75, 3.5 * x - 2.5};
      for (const double c : rgb)
        picture.samples.push_back(
            t > 0 ? static_cast<std::uint16_t>(std::lround(255 * std::clamp(c, 0.0, 1.0)))
                  : std::uint16_t{0});
    }
  picture.texts = {{"Comment", "temperature from " + readable(low, Dimension::temperature) +
                                   " (dark red) to " + readable(high, Dimension::temperature) +
                                   " (white)"}};
  write_png(path, picture);
}

/// How far the temperatures are from the mean temperatures of what the pixels look at.
void compare_with(const Image& truth, const Image& temperature, Report& report) {
  double sum = 0, squares = 0, n = 0;
  for (std::size_t i = 0; i < truth.pixels.size(); ++i) {
    if (!(truth.pixels[i] > 0) || !(temperature.pixels[i] > 0)) continue;
    const double away =
        static_cast<double>(temperature.pixels[i]) - static_cast<double>(truth.pixels[i]);
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

/// Whether a colour of a pixel was made of recorded ones with a full well: its own, or, of other
/// colours, neighbours of which it is the mean (demosaic() in lightfield/sensor.h).
bool was_full(const Image& raw, MosaicPattern pattern, PixelWindow window, int column, int row,
              int colour, float limit) {
  if (mosaic_colour(pattern, window.x + column, window.y + row) == colour)
    return raw.at(column, row) >= limit;
  for (int y = std::max(0, row - 1); y <= std::min(raw.height - 1, row + 1); ++y)
    for (int x = std::max(0, column - 1); x <= std::min(raw.width - 1, column + 1); ++x)
      if (mosaic_colour(pattern, window.x + x, window.y + y) == colour && raw.at(x, y) >= limit)
        return true;
  return false;
}

/// Makes pixels dark whose well was full in either channel: they say nothing of a ratio.
/// @return how many
std::size_t leave_out_saturated(const LightField& field, MosaicPattern mosaic, std::size_t a,
                                std::size_t b, LightFieldChannel light[2]) {
  const auto full = field.numbers.find("sensor.saturated_from");
  if (field.unit != "e-" || full == field.numbers.end()) return 0;
  const auto limit = static_cast<float>(full->second);
  std::size_t count = 0;
  // Of a mosaic the mean of a full pixel and others may lie below the limit.
  const auto raw = field.layers.find("sensor.raw");
  const bool demosaiced = mosaic != MosaicPattern::none && raw != field.layers.end();
  for (int row = 0; row < light[0].flux.height; ++row)
    for (int column = 0; column < light[0].flux.width; ++column) {
      bool overflown = false;
      for (const std::size_t c : {a, b})
        overflown = overflown || (demosaiced ? was_full(raw->second, mosaic, field.window, column,
                                                        row, static_cast<int>(c), limit)
                                             : field.channels[c].flux.at(column, row) >= limit);
      if (!overflown) continue;
      light[0].flux.at(column, row) = light[1].flux.at(column, row) = 0;
      ++count;
    }
  return count;
}

int run_pyrometry(const Settings& settings) {
  for (const auto& [option, path] : {std::pair{"--output", settings.output},
                                     {"--picture", settings.picture},
                                     {"--truth-picture", settings.truth}})
    if (!path.empty()) {
      check_not_overwritten(option, path, settings.input);
      check_writable(path);
    }
  if (!settings.channels.empty() && settings.channels.size() != 2)
    throw UsageError("--channels: two names, separated by a comma");
  const LightField field = read_light_field(settings.input);
  if (field.scene_text.empty())
    throw InputError(settings.input + " does not say what its channels are: it holds no scene");
  const Scene scene = parse_scene(field.scene_text, "scene of " + settings.input).scene;
  if (field.channels.size() < 2 || scene.channels.size() < field.channels.size())
    throw InputError("two-colour pyrometry needs a light field with at least two channels");
  std::size_t a = 0, b = 1;
  if (!settings.channels.empty()) {
    a = index_of(field, settings.channels[0]);
    b = index_of(field, settings.channels[1]);
  }
  const auto first = camera_response(scene, scene.channels[a]);
  const auto second = camera_response(scene, scene.channels[b]);
  if (!first || !second)
    throw InputError(
        "a channel of all wavelengths has no colour; choose two others with "
        "--channels");
  std::string law_name;
  const AbsorptionSpectrum law = law_of(settings, scene, law_name);
  const TwoColour two(*first, *second, law);
  PyrometrySettings how;
  how.threshold = settings.threshold;
  LightFieldChannel light[2] = {energy_of(field, scene, a), energy_of(field, scene, b)};
  const std::size_t saturated = leave_out_saturated(field, scene.camera.sensor.mosaic, a, b, light);
  const TemperatureMap map = two_colour_map(light[0], light[1], two, how);
  double low = map.lowest, high = map.highest;
  if (!settings.range.empty()) {
    const auto comma = settings.range.find(',');
    if (comma == std::string::npos)
      throw UsageError("--range: two temperatures, like \"1400 K,2000 K\"");
    low = quantity_option("--range", settings.range.substr(0, comma), Dimension::temperature);
    high = quantity_option("--range", settings.range.substr(comma + 1), Dimension::temperature);
    if (!(high > low)) throw UsageError("--range: the second temperature must be the higher one");
  }
  if (!settings.output.empty()) {
    LightField out = field;
    out.channels = {{"temperature", map.temperature, map.standard_error}};
    out.layers.clear();
    out.unit = "K";
    out.texts["pyrometry.law"] = law_name;
    out.texts["pyrometry.channels"] = field.channels[a].name + "," + field.channels[b].name;
    write_light_field(settings.output, out);
  }
  high = std::max(high, low + 1);
  if (!settings.picture.empty()) write_picture(settings.picture, map.temperature, low, high);
  const auto truth = field.layers.find("truth.temperature");
  if (!settings.truth.empty()) {
    if (truth == field.layers.end())
      throw InputError(settings.input + " has no layer truth.temperature; render it with --truth");
    // Where there is a temperature to compare with.
    Image seen = truth->second;
    for (std::size_t i = 0; i < seen.pixels.size(); ++i)
      if (!(map.temperature.pixels[i] > 0)) seen.pixels[i] = 0;
    write_picture(settings.truth, seen, low, high);
  }
  Report report;
  report.add("channels", field.channels[a].name + " / " + field.channels[b].name, "channels",
             {field.channels[a].name, field.channels[b].name});
  report.add("law", law_name, "law", law_name);
  report.add("pixels", std::to_string(map.pixels), "pixels", map.pixels);
  report.add("temperature",
             readable(map.mean, Dimension::temperature) + " mean, " +
                 readable(map.lowest, Dimension::temperature) + " to " +
                 readable(map.highest, Dimension::temperature),
             "mean_K", map.mean);
  report.add_json("lowest_K", map.lowest);
  report.add_json("highest_K", map.highest);
  report.add("spread", readable(map.deviation, Dimension::temperature) + " standard deviation",
             "deviation_K", map.deviation);
  if (saturated > 0)
    report.add_text("left out", std::to_string(saturated) + " pixels whose well was full");
  report.add_json("saturated", saturated);
  if (map.expected_deviation > 0)
    report.add("expected of noise", readable(map.expected_deviation, Dimension::temperature),
               "expected_deviation_K", map.expected_deviation);
  if (truth != field.layers.end()) compare_with(truth->second, map.temperature, report);
  report.print(settings.json);
  return kSuccess;
}

}  // namespace

void register_pyrometry(const Registry& registry) {
  auto settings = std::make_shared<Settings>();
  CLI::App& command =
      add_command(registry, "pyrometry", "Temperatures from the ratio of two channels",
                  "plenoflame pyrometry candle.exr --channels 650nm,850nm -o temperature.exr");
  command
      .add_option("RAW", settings->input,
                  "Light field (.exr) written by render, or its electrons by develop")
      ->required();
  command
      .add_option("-o,--output", settings->output,
                  "Temperature [K] and its standard error, per pixel")
      ->option_text("FILE.exr");
  command
      .add_option("--picture", settings->picture,
                  "The same in false colours, with a bar of the range at the right")
      ->option_text("FILE.png");
  command
      .add_option("--truth-picture", settings->truth,
                  "The layer truth.temperature (render --truth) in the same colours")
      ->option_text("FILE.png");
  command
      .add_option(
          "--range", settings->range,
          "Temperatures of the darkest and the brightest colour, \"1400 K,2000 K\"; without "
          "it, those that occur")
      ->option_text("T,T");
  command
      .add_option("--channels", settings->channels, "The two channels; without it, the first two")
      ->delimiter(',')
      ->option_text("A,B");
  command
      .add_option("--law", settings->law,
                  "How absorption depends on wavelength: grey, soot (1/wavelength) or power; "
                  "without it, as the scene's flames")
      ->check(CLI::IsMember({"grey", "soot", "power"}))
      ->option_text("LAW");
  command
      .add_option("--exponent", settings->exponent, "Of law power: absorption as wavelength^-N (1)")
      ->check(number_between(-20.0, 20.0))
      ->option_text("N");
  command
      .add_option("--threshold", settings->threshold,
                  "Pixels below this share of the largest value have no temperature (0.01)")
      ->check(number_between(0.0, 1.0))
      ->option_text("SHARE");
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry, [settings] { return run_pyrometry(*settings); });
}

}  // namespace plenoflame::cli
