#include "plenoflame/lightfield/develop.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "choice.h"
#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/light_field/develop_colour.h"
#include "commands/light_field/develop_sensor.h"
#include "commands/scene_input.h"
#include "messages.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/png_file.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

/// The scene that a sensor or a colour picture needs.
Scene needed_scene(const DevelopArguments& settings, const LightField& light_field) {
  const std::string& path = settings.input;
  if (light_field.scene_text.empty())
    throw InputError(path + " holds no scene, so its channels are not known");
  return read_scene_of(light_field, path, settings.set).scene;
}

/// The settings of the light field's scene; the defaults when it has no scene.
DevelopSpec scene_spec(const DevelopArguments& settings, const LightField& light_field) {
  if (light_field.scene_text.empty()) return {};
  try {
    return parse_scene_of(light_field, settings.input, settings.set).scene.develop;
  } catch (const InputError& error) {
    warn(std::string("the scene's settings for develop are not used: ") + error.what());
    return {};
  }
}

/// The command line, put over what the scene says.
DevelopSpec effective_spec(const DevelopArguments& settings, DevelopSpec spec) {
  if (settings.saturation == "auto") {
    spec.saturation = 0;
  } else if (!settings.saturation.empty()) {
    spec.saturation = quantity_option("--saturation", settings.saturation, Dimension::flux);
    if (!(spec.saturation > 0))
      throw UsageError("--saturation must be a flux above 0 W, or 'auto' for automatic exposure");
  }
  if (settings.bits > 0) spec.bits = settings.bits;
  if (!settings.curve.empty())
    spec.curve = settings.curve == "linear" ? ToneCurve::linear : ToneCurve::display;
  return spec;
}

int run_develop(const DevelopArguments& settings) {
  const std::string output =
      settings.output.empty()
          ? std::filesystem::path(settings.input).replace_extension(".png").string()
          : settings.output;
  check_not_overwritten("--output", output, settings.input);
  static_cast<void>(effective_spec(settings, {}));  // bad use is found before bad files
  const bool frames = settings.sensor.any() || output.ends_with(".exr") ||
                      output.ends_with(".tif") || output.ends_with(".tiff");
  if (frames && settings.colour)
    throw UsageError("--colour cannot be used with frames of the sensor; leave one of them out");
  check_writable(output);
  if (!frames) check_ending("--output", output, {".png"});
  const LightField light_field = read_light_field(settings.input);
  if (frames)
    return develop_sensor(settings, output, light_field, needed_scene(settings, light_field));
  if (settings.colour)
    return develop_colour(light_field, needed_scene(settings, light_field),
                          effective_spec(settings, scene_spec(settings, light_field)).saturation,
                          output, settings.json);
  const DevelopSpec requested = effective_spec(settings, scene_spec(settings, light_field));
  DevelopedImage image = develop(light_field, requested, settings.channel);
  const std::string& channel = find_channel(light_field, settings.channel).name;
  const std::string curve = requested.curve == ToneCurve::linear ? "linear" : "display";
  image.picture.texts = {
      {"Software", "Plenoflame " + light_field.version},
      {"Comment", "channel " + channel + ", saturation " +
                      (light_field.unit == "W" ? format_quantity(image.saturation, Dimension::flux)
                                               : readable_in(image.saturation, light_field.unit)) +
                      " per pixel, " + std::to_string(requested.bits) + " bits, curve " + curve}};
  write_png(output, image.picture);
  if (image.lit == 0)
    warn("no pixel of '" + settings.input + "' has a flux above 0: the picture is black");

  Report report;
  report.add("picture", output, "picture", output);
  report.add("size",
             std::to_string(image.picture.width) + " x " + std::to_string(image.picture.height),
             "size", {image.picture.width, image.picture.height});
  report.add("channel", channel, "channel", channel);
  report.add("saturation",
             readable_in(image.saturation, light_field.unit) + " per pixel" +
                 (image.automatic ? " (automatic)" : ""),
             "saturation_W", image.saturation);
  report.add_json("automatic_exposure", image.automatic);
  report.add("bits", std::to_string(requested.bits), "bits", requested.bits);
  report.add("curve", curve, "curve", curve);
  report.add("pixels with light", std::to_string(image.lit), "pixels_with_light", image.lit);
  report.add("saturated", readable_percent(image.saturated_share) + " of all pixels",
             "saturated_share", image.saturated_share);
  print(report, settings.json);
  return kSuccess;
}

}  // namespace

void register_develop(const Registry& registry) {
  auto settings = std::make_shared<DevelopArguments>();
  CLI::App& command = add_command(
      registry, "develop", "Turn a raw light field into a 16-bit PNG, as a sensor would see it",
      "plenoflame develop flame.exr -o flame.png --saturation \"5000 nW\" --bits 14");
  command.add_option("RAW", settings->input, "Light field (.exr) written by render")->required();
  add_set_option(command, settings->set);
  add_option(command, "-o,--output", settings->output, "FILE",
             "Picture to write; without it, RAW's name with .png")
      ->check(written());
  add_option(command, "--saturation", settings->saturation, "FLUX",
             "Flux per pixel of the largest digital number, e.g. \"5000 nW\", or auto: 99.9 % of "
             "the pixels with light are below; without it, the scene's, else auto");
  add_option(command, "--bits", settings->bits, "N",
             "Bits of the sensor, 1 to 16; without it, the scene's, else 14")
      ->check(CLI::Range(1, 16));
  add_option(command, "--curve", settings->curve, "CURVE",
             "linear: digital numbers in the upper bits; display: transfer function of sRGB; "
             "without it, the scene's, else display")
      ->check(one_of({"linear", "display"}));
  add_option(command, "--channel", settings->channel, "NAME",
             "Channel to develop; without it, the first");
  command.add_flag("--colour", settings->colour,
                   "Colour picture (8 bits, sRGB) from channels with responses cie_x, cie_y, "
                   "cie_z, else from the first three as red, green, blue");
  command.add_flag("--sensor", settings->sensor.sensor,
                   "Frames of camera.sensor: .png and .tif hold digital numbers, .exr electrons of "
                   "all channels");
  add_option(command, "--exposure", settings->sensor.exposures, "TIME",
             "Exposure time, or several for a series: \"1 ms,4 ms\"; auto: 99.9 % of the pixels "
             "with light below the full well")
      ->delimiter(',');
  add_option(command, "--channel-exposure", settings->sensor.each, "NAME=TIME",
             "Exposure of each channel: \"650nm=4 ms,850nm=auto\"; auto: all of them automatic")
      ->delimiter(',');
  add_option(command, "--noise", settings->sensor.noise, "LIST",
             "Noise to simulate, from shot, read, dark, defects; or none")
      ->delimiter(',')
      ->check(one_of({"shot", "read", "dark", "defects", "none"}));
  add_option(command, "--noise-seed", settings->sensor.noise_seed, "N",
             "Seed of noise and defects");
  add_option(command, "--frames", settings->sensor.frames, "N",
             "Frames, each with its own noise (1)")
      ->check(CLI::Range(1, 10000));
  command.add_flag("--dark", settings->sensor.dark, "Record dark frames, without light");
  add_threads_option(command, settings->sensor.threads);
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry, [settings] { return run_develop(*settings); });
}

}  // namespace plenoflame::cli
