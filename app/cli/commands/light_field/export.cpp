#include "plenoflame/lightfield/export.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "choice.h"
#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/render/light_field_output.h"
#include "commands/scene_input.h"
#include "export_folder.h"
#include "file_set.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct ExportArguments {
  RawArguments raw;
  ViewArguments views;
  std::string format, name, saturation;
  std::vector<std::string> channels;
  int grid = 0;
};

const ExportName& format_of(const std::string& name) {
  const auto& formats = export_formats();
  return *std::find_if(formats.begin(), formats.end(),
                       [&](const ExportName& format) { return format.name == name; });
}

/// The colours of the pictures, as the light field's scene and its channels allow.
ColourChannels colours_of(const ExportArguments& settings, const ExportName& format) {
  if (settings.channels.empty() && !settings.raw.scene.empty()) return {};
  const LightField header = read_light_field_header(settings.raw.input);
  std::optional<Scene> scene;
  if (!header.scene_text.empty()) scene = read_scene_of(header, settings.raw.input).scene;
  return export_colours(header, scene ? &*scene : nullptr, format, settings.channels,
                        settings.raw.channel, "--");
}

int run_export(const ExportArguments& settings, const std::stop_token& stop) {
  const ExportName& format = format_of(settings.format);
  if (settings.grid > 0 && format.grid == 0)
    throw UsageError("--grid: the format '" + settings.format + "' holds no views");
  check_folder(settings.raw.output, settings.raw.force);
  // Checked by read_raw, which says what is wrong with a file.
  RawLightField raw = read_raw(settings.raw, Layers::all);
  ExportSettings how;
  how.format = format.format;
  how.colour = colours_of(settings, format);
  if (how.colour.present()) raw.field = read_light_field(settings.raw.input);
  how.name = settings.name.empty() ? std::filesystem::path(settings.raw.input).stem().string()
                                   : settings.name;
  if (how.name.find('/') != std::string::npos)
    throw UsageError("--name must not contain folders; give the folder with --output");
  how.grid = settings.grid;
  how.views = settings.views.settings();
  how.views.channel = find_channel(raw.field, settings.raw.channel).name;
  if (!settings.saturation.empty()) {
    how.saturation = quantity_option("--saturation", settings.saturation, Dimension::flux);
    if (!(how.saturation > 0)) throw UsageError("--saturation must be a flux above 0 W");
  }
  Execution execution;
  execution.threads = settings.raw.threads;
  execution.stop = stop;
  const Camera camera(raw.camera);
  check_export(camera, how.format);
  const MicroImages micro = raw.micro_images(true, execution);
  ResultFolder folder(settings.raw.output);
  ExportResult result;
  folder.write([&](const std::string& path) {
    result = export_light_field(raw.field, micro, how, path, execution);
  });
  folder.commit();

  Report report;
  report.add("folder", settings.raw.output, "folder", settings.raw.output);
  report.add("format", settings.format, "format", settings.format);
  report.add("files", std::to_string(result.files.size()), "files", result.files);
  if (how.colour.present()) {
    const auto& names = how.colour.names;
    report.add("colours",
               names[0] + ", " + names[1] + ", " + names[2] +
                   (how.colour.is_xyz ? " as XYZ" : " as red, green, blue"),
               "colours", names);
  }
  report.add("channel", how.views.channel, "channel", how.views.channel);
  for (const std::string& note : result.notes) report.add_text("note", note);
  report.add_json("notes", result.notes);
  print(report, settings.raw.json);
  return kSuccess;
}

}  // namespace

void register_export(const Registry& registry) {
  auto settings = std::make_shared<ExportArguments>();
  CLI::App& command = add_command(registry, "export", "Export a light field for other tools",
                                  "plenoflame export flame.exr --format hci -o flame-hci");
  add_raw_input(command, settings->raw, "Folder for the files");
  std::string about = "Format of a tool:";
  std::vector<std::string> names;
  for (const ExportName& format : export_formats()) {
    names.emplace_back(format.name);
    about +=
        std::string(names.size() > 1 ? ";" : "") + " " + format.name + " (" + format.what + ")";
  }
  add_option(command, "--format", settings->format, "NAME", about)
      ->required()
      ->check(one_of(names));
  add_option(command, "--name", settings->name, "STEM", "Stem of the file names (that of RAW)");
  add_option(command, "--grid", settings->grid, "N",
             "Views along each side, 1 to 99; without it, as the tool expects (hci 9, eslf 14)")
      ->check(CLI::Range(1, 99));
  add_option(command, "--channels", settings->channels, "R,G,B",
             "Red, green and blue; without it, the scene's colour channels; grey with --channel")
      ->delimiter(',');
  add_view_options(command, settings->views);
  add_option(command, "--saturation", settings->saturation, "FLUX",
             "Flux per pixel that is white; without it, 99.9 % of the pixels with light are below");
  add_raw_options(command, settings->raw);
  on_chosen(command, registry,
            [settings](const std::stop_token& stop) { return run_export(*settings, stop); });
}

}  // namespace plenoflame::cli
