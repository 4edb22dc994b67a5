#include "plenoflame/lightfield/pyrometry.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "choice.h"
#include "commands/commands.h"
#include "commands/light_field/develop_sensor.h"
#include "commands/light_field/pyrometry_compare.h"
#include "commands/light_field/pyrometry_light.h"
#include "commands/light_field/pyrometry_pupil.h"
#include "commands/light_field/temperature_picture.h"
#include "commands/scene_input.h"
#include "file_set.h"
#include "number_range.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/lightfield/pixel_bins.h"
#include "plenoflame/lightfield/sensor.h"
#include "plenoflame/scene/spectral.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

struct PyrometryArguments {
  std::string input, output, picture, truth, reference, law, range, bin;
  std::vector<std::string> channels, filters, set;
  double exponent = 1, threshold = 0.01, least_signal = 2;
  int cells = 3;
  bool json = false;
};

/// The law that the option or else the scene's flames say.
AbsorptionSpectrum law_of(const PyrometryArguments& settings, const Scene& scene,
                          std::string& name) {
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
      throw UsageError(
          "--law: the scene's flames have different spectra; choose grey, soot or power");
  const AbsorptionSpectrum law = absorption_spectrum(scene.flames.front().spectrum);
  if (law.is_grey()) name = "grey, as the scene's flames";
  return law;
}

std::size_t index_of(const LightField& field, const std::string& name) {
  const LightFieldChannel& channel = find_channel(field, name);
  return static_cast<std::size_t>(&channel - field.channels.data());
}

/// The pixels that are taken together by --bin; nothing: each alone.
std::optional<PixelBins> bins_of(const PyrometryArguments& settings, const LightField& field,
                                 const Scene& scene) {
  if (settings.bin.empty()) return std::nullopt;
  if (settings.bin != "micro-image" && settings.bin != "view")
    return block_bins(field.window, whole_number_option("--bin", settings.bin, 1, 65536));
  const SensorSpec& sensor = scene.camera.sensor;
  if (!scene.camera.array.present)
    throw UsageError("--bin: the camera has no microlens array; take blocks, like --bin 4");
  if (sensor.columns != field.sensor_width || sensor.rows != field.sensor_height)
    throw InputError(settings.input +
                     " is not a raw image of its scene's camera: the sensors differ");
  return micro_image_bins(MicroImages(Camera(scene.camera), false), field.window,
                          settings.bin == "view" ? settings.cells : 1);
}

/// The relative error that the scales of two channels (calibrate radiometry) bring into their
/// ratio; 0: nothing is known.
double scale_error_of_ratio(const LightField& field, std::size_t a, std::size_t b) {
  const auto error_of = [&](std::size_t channel) {
    const auto found = field.numbers.find("scale.error." + field.channels[channel].name);
    return found == field.numbers.end() ? 0.0 : found->second;
  };
  return std::hypot(error_of(a), error_of(b));
}

/// The temperatures of the darkest and the brightest colour.
std::pair<double, double> range_of(const PyrometryArguments& settings, const TemperatureMap& map) {
  double low = map.lowest, high = map.highest;
  if (!settings.range.empty()) {
    const auto comma = settings.range.find(',');
    if (comma == std::string::npos)
      throw UsageError("--range needs two temperatures, like \"1400 K,2000 K\"");
    low = quantity_option("--range", settings.range.substr(0, comma), Dimension::temperature);
    high = quantity_option("--range", settings.range.substr(comma + 1), Dimension::temperature);
    if (!(high > low)) throw UsageError("--range: the second temperature must be above the first");
  }
  return {low, std::max(high, low + 1)};
}

void add_temperatures(const TemperatureMap& map, Report& report) {
  report.add("temperature",
             readable(map.mean, Dimension::temperature) + " mean, " +
                 readable(map.lowest, Dimension::temperature) + " to " +
                 readable(map.highest, Dimension::temperature),
             "mean_K", map.mean);
  report.add_json("lowest_K", map.lowest);
  report.add_json("highest_K", map.highest);
  report.add("spread", readable(map.deviation, Dimension::temperature) + " standard deviation",
             "deviation_K", map.deviation);
}

/// The two colours are those of filters over parts of the stop, in one channel.
int run_with_filters(const PyrometryArguments& settings, const LightField& field,
                     const Scene& scene) {
  if (settings.filters.size() != 2)
    throw UsageError("--filters needs two names, separated by a comma");
  if (settings.channels.size() > 1)
    throw UsageError("--filters uses one channel; give --channels one name");
  if (!settings.bin.empty())
    throw UsageError(
        "--bin cannot be used with --filters, which adds up the light of each microlens");
  if (!settings.truth.empty())
    throw UsageError("--truth-picture cannot be used with --filters, whose pixels are microlenses");
  if (!settings.reference.empty())
    throw UsageError("--reference cannot be used with --filters, whose pixels are microlenses");
  const std::size_t channel =
      settings.channels.empty() ? 0 : index_of(field, settings.channels.front());
  std::string law_name;
  const AbsorptionSpectrum law = law_of(settings, scene, law_name);
  PyrometrySettings how;
  how.threshold = settings.threshold;
  how.least_signal_to_noise = settings.least_signal;
  PupilPyrometry found =
      pupil_pyrometry(field, scene, channel, {settings.filters[0], settings.filters[1]}, law, how);
  const TemperatureMap& map = found.map;
  const auto [low, high] = range_of(settings, map);
  FileSet files;
  if (!settings.output.empty()) {
    found.picture.texts["pyrometry.law"] = law_name;
    files.write(settings.output,
                [&](const std::string& name) { write_light_field(name, found.picture); });
  }
  if (!settings.picture.empty())
    files.write(settings.picture, [&, low = low, high = high](const std::string& name) {
      write_temperature_picture(name, map.temperature, low, high);
    });
  files.commit();
  Report report;
  report.add("channel", field.channels[channel].name, "channel", field.channels[channel].name);
  report.add("filters", settings.filters[0] + " / " + settings.filters[1], "filters",
             {settings.filters[0], settings.filters[1]});
  report.add("pixels of a microlens",
             readable_number(found.pixels[0]) + " and " + readable_number(found.pixels[1]),
             "pixels_of_a_microlens", {found.pixels[0], found.pixels[1]});
  report.add("law", law_name, "law", law_name);
  report.add("microlenses", std::to_string(map.pixels), "microlenses", map.pixels);
  add_left_out(found.left_out, report);
  add_temperatures(map, report);
  if (map.expected_deviation > 0)
    report.add("expected of noise", readable(map.expected_deviation, Dimension::temperature),
               "expected_deviation_K", map.expected_deviation);
  report.print(settings.json);
  return kSuccess;
}

int run_pyrometry(const PyrometryArguments& settings) {
  for (const std::string& path : {settings.output, settings.picture, settings.truth})
    if (!path.empty()) check_writable(path);
  if (!settings.output.empty()) check_ending("--output", settings.output, {".exr"});
  if (!settings.picture.empty()) check_ending("--picture", settings.picture, {".png"});
  if (!settings.truth.empty()) check_ending("--truth-picture", settings.truth, {".png"});
  if (settings.filters.empty() && !settings.channels.empty() && settings.channels.size() != 2)
    throw UsageError("--channels needs two names, separated by a comma");
  const LightField field = read_light_field(settings.input);
  if (field.scene_text.empty())
    throw InputError(settings.input + " holds no scene, so its channels are not known");
  const Scene scene = read_scene_of(field, settings.input, settings.set).scene;
  if (!settings.filters.empty()) return run_with_filters(settings, field, scene);
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
  how.least_signal_to_noise = settings.least_signal;
  LightFieldChannel light[2] = {light_in_proportion(field, scene, a),
                                light_in_proportion(field, scene, b)};
  const LeftOutPixels left_out =
      leave_out_bad_pixels(field, scene.camera.sensor.mosaic, a, b, light);
  const std::optional<PixelBins> bins = bins_of(settings, field, scene);
  const TemperatureMap map = two_colour_map(light[0], light[1], two, how, bins ? &*bins : nullptr);
  const auto [low, high] = range_of(settings, map);
  FileSet files;
  if (!settings.output.empty()) {
    LightField out = field;
    out.channels = {{"temperature", map.temperature, map.standard_error}};
    std::erase_if(out.layers, [](const auto& layer) { return !layer.first.starts_with("truth."); });
    out.unit = "K";
    if (!settings.bin.empty()) out.texts["pyrometry.bin"] = settings.bin;
    out.texts["pyrometry.law"] = law_name;
    out.texts["pyrometry.channels"] = field.channels[a].name + "," + field.channels[b].name;
    files.write(settings.output, [&](const std::string& name) { write_light_field(name, out); });
  }
  const auto write_picture = [&, low = low, high = high](const std::string& path,
                                                         const Image& temperature) {
    files.write(path, [&](const std::string& name) {
      write_temperature_picture(name, temperature, low, high);
    });
  };
  if (!settings.picture.empty()) write_picture(settings.picture, map.temperature);
  const auto truth = field.layers.find("truth.temperature");
  if (!settings.truth.empty()) {
    if (truth == field.layers.end())
      throw InputError(settings.input + " has no layer truth.temperature; render it with --truth");
    // Only pixels with a measured temperature have something to compare the truth with.
    Image seen = truth->second;
    for (std::size_t i = 0; i < seen.pixels.size(); ++i)
      if (!(map.temperature.pixels[i] > 0)) seen.pixels[i] = 0;
    write_picture(settings.truth, seen);
  }
  files.commit();
  Report report;
  report.add("channels", field.channels[a].name + " / " + field.channels[b].name, "channels",
             {field.channels[a].name, field.channels[b].name});
  report.add("law", law_name, "law", law_name);
  report.add("pixels", std::to_string(map.pixels), "pixels", map.pixels);
  if (bins) report.add("bins", std::to_string(map.bins), "bins", map.bins);
  add_temperatures(map, report);
  add_left_out(left_out, report);
  if (map.expected_deviation > 0)
    report.add("expected of noise", readable(map.expected_deviation, Dimension::temperature),
               "expected_deviation_K", map.expected_deviation);
  if (const double scale = scale_error_of_ratio(field, a, b); scale > 0) {
    const double kelvin = scale / std::fabs(two.slope(map.mean));
    report.add("of the counts' scales",
               readable(kelvin, Dimension::temperature) + ", common to all pixels", "scale_error_K",
               kelvin);
  }
  if (truth != field.layers.end()) compare_with(truth->second, map, light[0].flux, bins, report);
  if (!settings.reference.empty())
    compare_with_reference(settings.reference, {field, scene, {a, b}, two}, light, map, bins,
                           report);
  report.print(settings.json);
  return kSuccess;
}

}  // namespace

void register_pyrometry(const Registry& registry) {
  auto settings = std::make_shared<PyrometryArguments>();
  CLI::App& command =
      add_command(registry, "pyrometry", "Temperatures from the ratio of two channels",
                  "plenoflame pyrometry candle.exr --channels 650nm,850nm -o temperature.exr");
  command
      .add_option("RAW", settings->input,
                  "Light field (.exr) written by render, or its electrons by develop")
      ->required();
  add_set_option(command, settings->set);
  command
      .add_option("-o,--output", settings->output,
                  "Temperature [K] and its standard error, per pixel")
      ->check(written())
      ->option_text("FILE.exr");
  command
      .add_option("--picture", settings->picture, "Temperature in false colours, with a colour bar")
      ->check(written())
      ->option_text("FILE.png");
  command
      .add_option("--truth-picture", settings->truth,
                  "The layer truth.temperature (render --truth) in the same colours")
      ->check(written())
      ->option_text("FILE.png");
  command
      .add_option(
          "--reference", settings->reference,
          "Light field of the same pixels with less noise or none, to compare temperatures with")
      ->option_text("FILE.exr");
  command
      .add_option("--range", settings->range,
                  "Temperatures of the darkest and brightest colour, \"1400 K,2000 K\"; without "
                  "it, lowest and highest")
      ->option_text("T,T");
  command
      .add_option("--channels", settings->channels, "The two channels; without it, the first two")
      ->delimiter(',')
      ->option_text("A,B");
  command
      .add_option("--filters", settings->filters,
                  "Two camera.pupil_filters, by name, in place of two channels")
      ->delimiter(',')
      ->option_text("A,B");
  command
      .add_option("--law", settings->law,
                  "Absorption against wavelength: grey, soot (1/wavelength) or power; without it, "
                  "that of the scene's flames")
      ->check(one_of({"grey", "soot", "power"}))
      ->option_text("LAW");
  command
      .add_option("--exponent", settings->exponent,
                  "With --law power: absorption is proportional to wavelength^-N (1)")
      ->check(number_between(-20.0, 20.0))
      ->option_text("N");
  command
      .add_option("--threshold", settings->threshold,
                  "Least share of the largest value that gives a temperature (0.01)")
      ->check(number_between(0.0, 1.0))
      ->option_text("SHARE");
  command
      .add_option("--least-signal", settings->least_signal,
                  "Least light that gives a temperature, in its standard errors (2)")
      ->check(number_between(0.0, 1e6))
      ->option_text("N");
  command
      .add_option("--bin", settings->bin,
                  "Pixels that are added before the ratio, as in reconstruct")
      ->option_text("N|micro-image|view");
  command
      .add_option("--cells", settings->cells,
                  "Of --bin view: parts of a micro-image along each side (3)")
      ->check(CLI::Range(1, 100))
      ->option_text("N");
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry, [settings] { return run_pyrometry(*settings); });
}

}  // namespace plenoflame::cli
