#include "plenoflame/lightfield/export.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "commands/commands.h"
#include "commands/light_field_output.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

struct Settings {
  RawArguments raw;
  ViewArguments views;
  std::string format, name, saturation;
  int grid = 0;
};

const ExportName& format_of(const std::string& name) {
  const auto& formats = export_formats();
  return *std::find_if(formats.begin(), formats.end(),
                       [&](const ExportName& format) { return format.name == name; });
}

int run_export(const Settings& settings) {
  const ExportName& format = format_of(settings.format);
  if (settings.grid > 0 && format.grid == 0)
    throw UsageError("--grid: the format '" + settings.format + "' holds no views");
  check_folder(settings.raw.output, settings.raw.force);
  const RawLightField raw = read_raw(settings.raw, Layers::all);
  ExportSettings how;
  how.format = format.format;
  how.name = settings.name.empty() ? std::filesystem::path(settings.raw.input).stem().string()
                                   : settings.name;
  if (how.name.find('/') != std::string::npos)
    throw UsageError("--name: a name without folders; the folder is given with --output");
  how.grid = settings.grid;
  how.views = settings.views.settings();
  how.views.channel = find_channel(raw.field, settings.raw.channel).name;
  if (!settings.saturation.empty()) {
    how.saturation = quantity_option("--saturation", settings.saturation, Dimension::flux);
    if (!(how.saturation > 0)) throw UsageError("--saturation: a flux above 0 W");
  }
  Execution execution;
  execution.threads = settings.raw.threads;
  const Camera camera(raw.camera);
  check_export(camera, how.format);
  const MicroImages micro(camera, true, execution);
  prepare_folder(settings.raw.output, settings.raw.force);
  const ExportResult result =
      export_light_field(raw.field, micro, how, settings.raw.output, execution);

  Report report;
  report.add("folder", settings.raw.output, "folder", settings.raw.output);
  report.add("format", settings.format, "format", settings.format);
  report.add("files", std::to_string(result.files.size()), "files", result.files);
  report.add("channel", how.views.channel, "channel", how.views.channel);
  for (const std::string& note : result.notes) report.add_text("note", note);
  report.add_json("notes", result.notes);
  report.print(settings.raw.json);
  return kSuccess;
}

}  // namespace

void register_export(const Registry& registry) {
  auto settings = std::make_shared<Settings>();
  CLI::App& command = add_command(registry, "export", "Files for other light-field tools",
                                  "plenoflame export flame.exr --format hci -o flame-hci");
  add_raw_input(command, settings->raw, "Folder for the files; made when missing");
  std::string about = "Of which tool:";
  std::vector<std::string> names;
  for (const ExportName& format : export_formats()) {
    names.emplace_back(format.name);
    about +=
        std::string(names.size() > 1 ? ";" : "") + " " + format.name + " (" + format.what + ")";
  }
  command.add_option("--format", settings->format, about)
      ->required()
      ->check(CLI::IsMember(names))
      ->option_text("NAME");
  command.add_option("--name", settings->name, "Stem of the files' names; without it, that of RAW")
      ->option_text("STEM");
  command
      .add_option("--grid", settings->grid,
                  "Views along each side, 1 to 99, for formats of views; without it, as the tool "
                  "expects (hci 9, eslf 14)")
      ->check(CLI::Range(1, 99))
      ->option_text("N");
  add_view_options(command, settings->views);
  command
      .add_option(
          "--saturation", settings->saturation,
          "Flux per pixel that is white in pictures of the raw image; without it, 99.9 % of "
          "the pixels with light are not saturated")
      ->option_text("FLUX");
  add_raw_options(command, settings->raw);
  on_chosen(command, registry, [settings] { return run_export(*settings); });
}

}  // namespace plenoflame::cli
