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
  std::string input, output, format, name, scene, resampling = "barycentric", channel, saturation;
  int grid = 0, threads = 0;
  double spread = 0.7;
  bool force = false, json = false;
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
  const RawLightField raw = read_raw(settings.input, settings.scene);
  ExportSettings how;
  how.format = format.format;
  how.name =
      settings.name.empty() ? std::filesystem::path(settings.input).stem().string() : settings.name;
  if (how.name.find('/') != std::string::npos)
    throw UsageError("--name: a name without folders; the folder is given with --output");
  how.grid = settings.grid;
  how.views.spread = settings.spread;
  how.views.resampling = view_resamplings().at(settings.resampling);
  how.views.channel = find_channel(raw.field, settings.channel).name;
  if (!settings.saturation.empty()) {
    how.saturation = quantity_option("--saturation", settings.saturation, Dimension::flux);
    if (!(how.saturation > 0)) throw UsageError("--saturation: a flux above 0 W");
  }
  Execution execution;
  execution.threads = settings.threads;
  const Camera camera(raw.camera);
  check_export(camera, how.format);
  const MicroImages micro(camera, true, execution);
  prepare_folder(settings.output, settings.force);
  const ExportResult result = export_light_field(raw.field, micro, how, settings.output, execution);

  Report report;
  report.add("folder", settings.output, "folder", settings.output);
  report.add("format", settings.format, "format", settings.format);
  report.add("files", std::to_string(result.files.size()), "files", result.files);
  report.add("channel", how.views.channel, "channel", how.views.channel);
  for (const std::string& note : result.notes) report.add_text("note", note);
  report.add_json("notes", result.notes);
  report.print(settings.json);
  return kSuccess;
}

}  // namespace

void register_export(const Registry& registry) {
  auto settings = std::make_shared<Settings>();
  CLI::App& command = add_command(registry, "export", "Files for other light-field tools",
                                  "plenoflame export flame.exr --format hci -o flame-hci");
  command.add_option("RAW", settings->input, "Light field (.exr) written by render")->required();
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
  command.add_option("-o,--output", settings->output, "Folder for the files; made when missing")
      ->required()
      ->option_text("DIR");
  command.add_option("--name", settings->name, "Stem of the files' names; without it, that of RAW")
      ->option_text("STEM");
  command
      .add_option("--grid", settings->grid,
                  "Views along each side, 1 to 99, for formats of views; without it, as the tool "
                  "expects (hci 9, eslf 14)")
      ->check(CLI::Range(1, 99))
      ->option_text("N");
  command
      .add_option("--spread", settings->spread,
                  "Side of the square that the views cover, in diameters of a micro-image (0.7)")
      ->check(CLI::Range(0.0, 1.0))
      ->option_text("S");
  command
      .add_option("--resampling", settings->resampling,
                  "From microlenses to square pixels, as for views (barycentric)")
      ->check(CLI::IsMember(view_resampling_names()))
      ->option_text("NAME");
  command
      .add_option(
          "--saturation", settings->saturation,
          "Flux per pixel that is white in pictures of the raw image; without it, 99.9 % of "
          "the pixels with light are not saturated")
      ->option_text("FLUX");
  command.add_option("--channel", settings->channel, "Channel; without it, the first")
      ->option_text("NAME");
  command
      .add_option("--scene", settings->scene,
                  "Scene file that gives the camera, for a light field without its own")
      ->option_text("SCENE.toml");
  command.add_flag("--force", settings->force, "Write into a folder that has files in it");
  command.add_option("--threads", settings->threads, "Worker threads; 0: one per processor (0)")
      ->check(CLI::Range(0, 1024))
      ->option_text("N");
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry, [settings] { return run_export(*settings); });
}

}  // namespace plenoflame::cli
