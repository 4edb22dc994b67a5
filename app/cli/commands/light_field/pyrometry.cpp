#include "plenoflame/measure/temperatures.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "choice.h"
#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/light_field/pyrometry_compare.h"
#include "commands/light_field/temperature_picture.h"
#include "commands/scene_input.h"
#include "file_set.h"
#include "number_range.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/image/atomic_file.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct PyrometryArguments {
  std::string input, output, picture, truth, reference, law, range, bin;
  std::vector<std::string> channels, filters, set;
  double exponent = 1, threshold = 0.01, least_signal = 2;
  int cells = 3;
  bool json = false;
};

TemperatureRequest request_of(const PyrometryArguments& settings) {
  TemperatureRequest request;
  request.channels = settings.channels;
  request.filters = settings.filters;
  request.law = settings.law;
  request.exponent = settings.exponent;
  request.pixels.threshold = settings.threshold;
  request.pixels.least_signal_to_noise = settings.least_signal;
  if (settings.bin == "micro-image")
    request.cells = 1;
  else if (settings.bin == "view")
    request.cells = settings.cells;
  else if (!settings.bin.empty())
    request.block = whole_number_option("--bin", settings.bin, 1, 65536);
  return request;
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

/// The lines about pixels that have no part in a temperature.
void add_left_out(const LeftOutPixels& left_out, Report& report) {
  if (left_out.saturated > 0)
    report.add_text("left out", std::to_string(left_out.saturated) + " pixels whose well was full");
  if (left_out.defective > 0)
    report.add_text("left out", std::to_string(left_out.defective) + " defective pixels");
  report.add_json("saturated", left_out.saturated);
  report.add_json("defective", left_out.defective);
}

/// Adds the results, apart from comparisons.
void add_found(const PyrometryArguments& settings, const LightField& field,
               const Temperatures& found, Report& report) {
  const bool filters = !settings.filters.empty();
  const std::string& first = field.channels[found.channels[0]].name;
  const std::string& second = field.channels[found.channels[1]].name;
  const TemperatureMap& map = found.map;
  if (filters) {
    report.add("channel", first, "channel", first);
    report.add("filters", settings.filters[0] + " / " + settings.filters[1], "filters",
               {settings.filters[0], settings.filters[1]});
    const auto [one, other] = found.filter_pixels;
    report.add("pixels of a microlens", readable_number(one) + " and " + readable_number(other),
               "pixels_of_a_microlens", {one, other});
  } else {
    report.add("channels", first + " / " + second, "channels", {first, second});
  }
  report.add("law", found.law, "law", found.law);
  report.add(filters ? "microlenses" : "pixels", std::to_string(map.pixels),
             filters ? "microlenses" : "pixels", map.pixels);
  if (found.bins) report.add("bins", std::to_string(map.bins), "bins", map.bins);
  add_temperatures(map, report);
  add_left_out(found.left_out, report);
  if (map.expected_deviation > 0)
    report.add("expected of noise", readable(map.expected_deviation, Dimension::temperature),
               "expected_deviation_K", map.expected_deviation);
  if (found.scale_error > 0)
    report.add("of the counts' scales",
               readable(found.scale_error, Dimension::temperature) + ", common to all pixels",
               "scale_error_K", found.scale_error);
}

void check_files(const PyrometryArguments& settings) {
  for (const std::string& path : {settings.output, settings.picture, settings.truth})
    if (!path.empty()) check_writable(path);
  if (settings.filters.empty()) return;
  for (const char* option : {settings.truth.empty() ? "" : "--truth-picture",
                             settings.reference.empty() ? "" : "--reference"})
    if (*option != '\0')
      throw UsageError(std::string(option) +
                       " cannot be used with --filters, whose pixels are microlenses");
}

int run_pyrometry(const PyrometryArguments& settings) {
  check_files(settings);
  const LightField field = read_light_field(settings.input);
  if (field.scene_text.empty())
    throw InputError(settings.input + " holds no scene, so its channels are not known");
  const Scene scene = read_scene_of(field, settings.input, settings.set).scene;
  const Temperatures found = find_temperatures(field, scene, request_of(settings));
  const TemperatureMap& map = found.map;
  const auto [low, high] = range_of(settings, map);
  FileSet files;
  if (!settings.output.empty())
    files.write(settings.output,
                [&](const std::string& name) { write_light_field(name, found.picture); });
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
  add_found(settings, field, found, report);
  if (found.ratio && truth != field.layers.end())
    compare_with(truth->second, map, found.light[0].flux, found.bins, report);
  if (!settings.reference.empty())
    compare_with_reference(settings.reference, {field, scene, found}, report);
  print(report, settings.json);
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
  add_option(command, "-o,--output", settings->output, "FILE.exr",
             "Temperature [K] and its standard error, per pixel")
      ->check(written({".exr"}));
  add_option(command, "--picture", settings->picture, "FILE.png",
             "Temperature in false colours, with a colour bar")
      ->check(written({".png"}));
  add_option(command, "--truth-picture", settings->truth, "FILE.png",
             "The layer truth.temperature (render --truth) in the same colours")
      ->check(written({".png"}));
  add_option(
      command, "--reference", settings->reference, "FILE.exr",
      "Light field of the same pixels with less noise or none, to compare temperatures with");
  add_option(command, "--range", settings->range, "T,T",
             "Temperatures of the darkest and brightest colour, \"1400 K,2000 K\"; without it, "
             "lowest and highest");
  add_option(command, "--channels", settings->channels, "A,B",
             "The two channels; without it, the first two")
      ->delimiter(',');
  add_option(command, "--filters", settings->filters, "A,B",
             "Two camera.pupil_filters, by name, in place of two channels")
      ->delimiter(',');
  add_option(command, "--law", settings->law, "LAW",
             "Absorption against wavelength: grey, soot (1/wavelength) or power; without it, that "
             "of the scene's flames")
      ->check(one_of({"grey", "soot", "power"}));
  add_option(command, "--exponent", settings->exponent, "N",
             "With --law power: absorption is proportional to wavelength^-N (1)")
      ->check(number_between(-20.0, 20.0));
  add_option(command, "--threshold", settings->threshold, "SHARE",
             "Least share of the largest value that gives a temperature (0.01)")
      ->check(number_between(0.0, 1.0));
  add_option(command, "--least-signal", settings->least_signal, "N",
             "Least light that gives a temperature, in its standard errors (2)")
      ->check(number_between(0.0, 1e6));
  add_option(command, "--bin", settings->bin, "N|micro-image|view",
             "Pixels that are added before the ratio, as in reconstruct");
  add_option(command, "--cells", settings->cells, "N",
             "Of --bin view: parts of a micro-image along each side (3)")
      ->check(CLI::Range(1, 100));
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry, [settings] { return run_pyrometry(*settings); });
}

}  // namespace plenoflame::cli
