#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "choice.h"
#include "commands/commands.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/camera_import.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/scene_settings.h"
#include "plenoflame/scene/validate.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

struct CameraImportArguments {
  std::vector<std::string> files, set;
  std::string output, format;
  bool json = false;
};

/// A scene with 0 where --set may give a value of a camera that is still to be found.
constexpr const char* kNothingYet = R"(
[camera.lens]
model = "ideal"
[camera.array]
model = "ideal"
[[camera.array.types]]
[[camera.array.types]]
[[camera.array.types]]
)";

/// --set camera.lens.f_number=N is the diameter once the focal length is known.
double take_f_number(std::vector<std::string>& values) {
  constexpr std::string_view kKey = "camera.lens.f_number=";
  double f_number = 0;
  std::erase_if(values, [&](const std::string& value) {
    if (!value.starts_with(kKey)) return false;
    const std::string text = value.substr(kKey.size());
    char* end = nullptr;
    f_number = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || *end != '\0' || !(f_number > 0) || !std::isfinite(f_number))
      throw UsageError("--set camera.lens.f_number: a number above 0");
    return true;
  });
  return f_number;
}

SceneDocument parse_with(const std::string& text, const std::string& name,
                         const std::vector<std::string>& values) {
  SceneSettings settings;
  settings.values = values;
  settings.option = "--set";
  try {
    return parse_scene(text, name, settings);
  } catch (const InputError& error) {
    if (error.position().file.starts_with("--set")) throw UsageError(error.what());
    throw;
  }
}

/// The scene of one camera that a file holds beside pictures.
Scene scene_in_file(const std::string& text, const std::string& path) {
  return for_camera(parse_embedded_scene(text, path)).scene;
}

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
  check_ending("-o", arguments.output, {".toml"});
  std::vector<std::string> values = arguments.set;
  const double f_number = take_f_number(values);
  CameraSpec given = parse_with(kNothingYet, "camera", values).scene.camera;
  if (f_number > 0) {
    // The focal length may stand in a file: a diameter that is certainly replaced.
    given.lens.diameter = given.lens.focal_length > 0 ? given.lens.focal_length / f_number : 1;
  }
  ImportedCamera found = import_camera(arguments.files, given, arguments.format);
  Scene scene;
  if (found.scene_text.empty()) {
    scene.camera = found.camera;
  } else {
    const Scene whole = scene_in_file(found.scene_text, arguments.files.front());
    scene.camera = whole.camera;
    scene.channels = whole.channels;
  }
  if (f_number > 0) scene.camera.lens.diameter = scene.camera.lens.focal_length / f_number;
  // Every other key that was given replaces what was found; several types that were not are none.
  std::erase_if(values, [](const std::string& value) {
    return value.starts_with("camera.focus.object_distance=");
  });
  scene = parse_with(write_scene(scene), "camera", values).scene;
  std::vector<std::string> warnings;
  try {
    for (const SceneIssue& issue : validate({scene, {}}))
      if (issue.code != IssueCode::no_flame) warnings.push_back(to_string(issue));
  } catch (const InputError& error) {
    throw InputError(SourcePosition{arguments.files.front()},
                     "the camera that it describes cannot be: " + std::string(error.what()));
  }
  Report report;
  report.add("camera", arguments.output, "camera", arguments.output);
  std::string formats;
  for (const std::string& format : found.formats) formats += (formats.empty() ? "" : ", ") + format;
  report.add("read as", formats, "formats", found.formats);
  add_camera_rows(report, scene.camera);
  for (const std::string& note : found.notes) report.add_text("note", note);
  for (const std::string& warning : warnings) report.add_text("warning", warning);
  report.add_json("notes", found.notes);
  report.add_json("warnings", warnings);
  write_scene_file(arguments.output, scene);
  report.print(arguments.json);
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
  import
      .add_option("FILE", arguments->files,
                  "Calibration files; what the first does not say, a later one may")
      ->required()
      ->option_text("FILE...");
  import.add_option("-o,--output", arguments->output, "The scene file to write (.toml)")
      ->check(written())
      ->required()
      ->option_text("FILE");
  std::vector<std::string> names;
  std::string about = "Of which tool; without it the content says so:";
  for (const CameraFormatName& format : camera_formats()) {
    about += std::string(names.empty() ? " " : "; ") + format.name + " (" + format.what + ")";
    names.emplace_back(format.name);
  }
  import.add_option("--format", arguments->format, about)
      ->check(one_of(names))
      ->option_text("NAME");
  import
      .add_option("--set", arguments->set,
                  "A value of the scene, such as camera.sensor.pixel_pitch=5.5um or "
                  "camera.array.types[0].focal_length=0.5mm; repeatable")
      ->option_text("KEY=VALUE")
      ->allow_extra_args(false);
  import.add_flag("--json", arguments->json, "Print the report as JSON");
  on_chosen(command, registry, [arguments] { return run_camera_import(*arguments); });
}

}  // namespace plenoflame::cli
