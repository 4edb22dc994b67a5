#include "commands/render/light_field_output.h"
#include "commands/add_option.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <system_error>

#include "choice.h"
#include "commands/scene_input.h"
#include "messages.h"
#include "number_range.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/light_field_channel.h"
#include "plenoflame/image/staging_folder.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/scene/cameras.h"

namespace plenoflame::cli {
namespace {

/// Names of the kernels on the command line.
const std::map<std::string, ViewResampling>& view_resamplings() {
  static const std::map<std::string, ViewResampling> kNames = {
      {"nearest", ViewResampling::nearest},
      {"barycentric", ViewResampling::barycentric},
      {"paper9", ViewResampling::paper9},
      {"paper10", ViewResampling::paper10}};
  return kNames;
}

}  // namespace

void add_raw_input(CLI::App& command, RawArguments& arguments, const std::string& output_text) {
  command.add_option("RAW", arguments.input, "Light field (.exr) written by render")->required();
  add_option(command, "-o,--output", arguments.output, "DIR", output_text)
      ->check(written())
      ->required();
}

void add_raw_options(CLI::App& command, RawArguments& arguments) {
  add_option(command, "--channel", arguments.channel, "NAME", "Channel; without it, the first");
  add_option(command, "--scene", arguments.scene, "SCENE.toml",
             "Scene file with the camera, for a light field that contains none");
  add_option(command, "--camera", arguments.camera, "NAME",
             "With --scene: name of the camera, if the scene has several");
  add_set_option(command, arguments.set);
  command.add_flag("--force", arguments.force, "Write into a folder that has files in it");
  add_threads_option(command, arguments.threads);
  command.add_flag("--json", arguments.json, "Print the figures as JSON");
}

ViewSettings ViewArguments::settings() const {
  ViewSettings settings;
  settings.spread = spread;
  settings.resampling = view_resamplings().at(resampling);
  return settings;
}

void add_view_options(CLI::App& command, ViewArguments& arguments) {
  add_option(command, "--spread", arguments.spread, "S",
             "Side of the square that the views cover, in diameters of a micro-image (0.7)")
      ->check(number_between(0.0, 1.0));
  std::vector<std::string> names;
  for (const auto& entry : view_resamplings()) names.push_back(entry.first);
  add_option(command, "--resampling", arguments.resampling, "NAME",
             "Resampling from microlenses to square pixels: barycentric, nearest, paper9 or "
             "paper10, for hexagonal arrays (barycentric)")
      ->check(one_of(names));
}

MicroImages RawLightField::micro_images(bool white, const Execution& execution) const {
  MicroImages images(Camera(camera), white, execution);
  images.look_through(windows);
  return images;
}

RawLightField read_raw(const RawArguments& arguments, Layers layers) {
  const std::string &path = arguments.input, &scene = arguments.scene;
  bool ours = true;
  try {
    read_light_field_header(path);
  } catch (const InputError& error) {
    // Not one of ours, or not all of it: the pixels will do where the camera is given.
    if (scene.empty())
      throw InputError(std::string(error.what()) +
                       "; if it is a raw image from elsewhere, give its camera with --scene "
                       "SCENE.toml");
    ours = false;
  }
  RawLightField raw;
  raw.field = ours ? read_light_field_channel(path, arguments.channel, layers)
                   : read_foreign_channel(path, arguments.channel);
  if (scene.empty() && raw.field.scene_text.empty())
    throw InputError(
        "'" + path +
        "' holds no scene, so its camera is not known; give its scene with --scene SCENE.toml");
  if (scene.empty() && !arguments.camera.empty())
    throw UsageError("--camera needs --scene; without it, the light field's own camera is used");
  const Scene made = scene.empty()
                         ? read_scene_of(raw.field, path, arguments.set).scene
                         : read_scene_of_camera(scene, arguments.set, arguments.camera).scene;
  raw.camera = made.camera;
  raw.windows = made.windows;
  check_raw_image(raw.field, raw.camera, "'" + path + "'");
  return raw;
}

void check_folder(const std::string& folder, std::optional<bool> force) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path path(folder);
  if (fs::exists(path, error)) {
    if (!fs::is_directory(path, error))
      throw FileError("'" + folder + "' is not a folder; choose another one with -o");
    StagingFolder::remove_abandoned(folder);
    const bool empty = fs::is_empty(path, error);
    if (error) throw FileError("cannot read the folder '" + folder + "': " + error.message());
    if (!empty && !force.value_or(false))
      throw FileError("the folder '" + folder + "' has files in it; choose another one" +
                      (force ? ", or give --force to add to it" : ""));
    return;
  }
  fs::path full = fs::absolute(path, error).lexically_normal();
  if (!full.has_filename()) full = full.parent_path();  // written with a slash at the end
  const fs::path parent = full.parent_path();
  if (!fs::is_directory(parent, error))
    throw FileError("cannot make the folder '" + folder + "': there is no folder '" +
                    parent.string() + "'");
}

}  // namespace plenoflame::cli
