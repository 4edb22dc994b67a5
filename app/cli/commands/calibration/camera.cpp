#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>

#include "choice.h"
#include "commands/add_option.h"
#include "commands/commands.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/camera_import.h"
#include "plenoflame/scene/imported_camera.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct CameraImportArguments {
  std::vector<std::string> files, set;
  std::string output, format;
  bool json = false;
};

void add_camera_rows(Report& report, const CameraSpec& spec) {
  const Camera camera(spec);
  const auto millimetres = [](double metres) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6g mm", 1e3 * metres);
    return std::string(text);
  };
  const double f = spec.lens.focal_length;
  report.add("main lens",
             millimetres(f) + ", f/" + std::to_string(f / spec.lens.diameter).substr(0, 5),
             "focal_length", f);
  report.add("lens to array", millimetres(camera.lens_distance()), "lens_distance",
             camera.lens_distance());
  report.add("array to sensor", millimetres(camera.microlenses()[0].sensor_distance),
             "sensor_distance", camera.microlenses()[0].sensor_distance);
  report.add("pitch", millimetres(spec.array.pitch), "pitch", spec.array.pitch);
  const double object = 1 / (1 / f - 1 / camera.lens_distance());
  report.add("array's image in front", object > 0 ? millimetres(object) : "none", "object_distance",
             object);
  report.add("types", std::to_string(spec.array.types.size()), "types", spec.array.types.size());
}

int run_camera_import(const CameraImportArguments& arguments) {
  SceneSettings settings;
  settings.values = arguments.set;
  settings.option = "--set";
  const ImportedScene found = import_camera_scene(arguments.files, settings, arguments.format);
  Report report;
  report.add("camera", arguments.output, "camera", arguments.output);
  std::string formats;
  for (const std::string& format : found.formats) formats += (formats.empty() ? "" : ", ") + format;
  report.add("read as", formats, "formats", found.formats);
  add_camera_rows(report, found.scene.camera);
  for (const std::string& note : found.notes) report.add_text("note", note);
  for (const std::string& warning : found.warnings) report.add_text("warning", warning);
  report.add_json("notes", found.notes);
  report.add_json("warnings", found.warnings);
  write_scene_file(arguments.output, found.scene);
  print(report, arguments.json);
  return kSuccess;
}

}  // namespace

void register_camera(const Registry& registry) {
  CLI::App& command = add_command(registry, "camera", "Cameras from calibrations of other tools",
                                  "plenoflame camera import intrinsics.js -o camera.toml");
  command.require_subcommand(1);
  auto arguments = std::make_shared<CameraImportArguments>();
  CLI::App& import = *command.add_subcommand(
      "import", "Make the camera of a scene from calibration files of another tool");
  add_option(import, "FILE", arguments->files, "FILE...",
             "Calibration files; what the first does not say, a later one may")
      ->required();
  add_option(import, "-o,--output", arguments->output, "FILE", "The scene file to write (.toml)")
      ->check(written({".toml"}))
      ->required();
  std::vector<std::string> names;
  std::string about = "Of which tool; without it the content says so:";
  for (const CameraFormatName& format : camera_formats()) {
    about += std::string(names.empty() ? " " : "; ") + format.name + " (" + format.what + ")";
    names.emplace_back(format.name);
  }
  add_option(import, "--format", arguments->format, "NAME", about)->check(one_of(names));
  add_option(import, "--set", arguments->set, "KEY=VALUE",
             "A value of the scene, such as camera.sensor.pixel_pitch=5.5um or "
             "camera.array.types[0].focal_length=0.5mm; repeatable")
      ->allow_extra_args(false);
  import.add_flag("--json", arguments->json, "Print the report as JSON");
  on_chosen(command, registry, [arguments] { return run_camera_import(*arguments); });
}

}  // namespace plenoflame::cli
