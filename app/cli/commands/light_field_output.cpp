#include "commands/light_field_output.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include "plenoflame/base/error.h"
#include "plenoflame/image/png_file.h"
#include "plenoflame/lightfield/develop.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame::cli {

RawLightField read_raw(const std::string& path, const std::string& scene) {
  RawLightField raw;
  try {
    raw.field = read_light_field(path);
  } catch (const InputError& error) {
    // Not one of ours, or not all of it: the pixels will do where the camera is given.
    if (scene.empty())
      throw InputError(std::string(error.what()) +
                       "; if it is a raw image from elsewhere, give its camera with --scene "
                       "SCENE.toml");
    raw.field = read_foreign_image(path);
  }
  if (scene.empty() && raw.field.scene_text.empty())
    throw InputError("'" + path +
                     "' holds no scene, so its camera is not known; give the one it was made with: "
                     "--scene SCENE.toml");
  raw.camera = (scene.empty() ? parse_scene(raw.field.scene_text, "scene of " + path)
                              : read_scene_file(scene))
                   .scene.camera;
  check_raw_image(raw.field, raw.camera, "'" + path + "'");
  return raw;
}

void prepare_folder(const std::string& folder, bool force) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path path(folder);
  if (fs::exists(path, error)) {
    if (!fs::is_directory(path, error))
      throw FileError("'" + folder + "' is not a folder; choose another one with -o");
    const bool empty = fs::is_empty(path, error);
    if (error) throw FileError("cannot read the folder '" + folder + "': " + error.message());
    if (!empty && !force)
      throw FileError("the folder '" + folder +
                      "' has files in it; choose another one, or give --force to add to it");
    return;
  }
  fs::create_directory(path, error);
  if (error) throw FileError("cannot make the folder '" + folder + "': " + error.message());
}

const std::map<std::string, ViewResampling>& view_resamplings() {
  static const std::map<std::string, ViewResampling> kNames = {
      {"nearest", ViewResampling::nearest},
      {"barycentric", ViewResampling::barycentric},
      {"paper9", ViewResampling::paper9},
      {"paper10", ViewResampling::paper10}};
  return kNames;
}

std::vector<std::string> view_resampling_names() {
  std::vector<std::string> names;
  for (const auto& entry : view_resamplings()) names.push_back(entry.first);
  return names;
}

double write_images(const std::string& folder, const std::vector<NamedImage>& images,
                    const std::string& unit, const std::string& channel, bool exr,
                    const LightField& raw) {
  Image all;  // one exposure for all pictures
  for (const NamedImage& named : images)
    all.pixels.insert(all.pixels.end(), named.image.pixels.begin(), named.image.pixels.end());
  all.width = static_cast<int>(all.pixels.size());
  all.height = 1;
  DevelopSpec settings;
  settings.bits = 16;
  settings.saturation = automatic_saturation(all);
  const std::filesystem::path path(folder);
  for (const NamedImage& named : images) {
    LightField field;
    field.sensor_width = named.image.width;
    field.sensor_height = named.image.height;
    field.window = {0, 0, named.image.width, named.image.height};
    field.channels.push_back({channel, named.image, {}});
    field.unit = unit;
    field.estimator = raw.estimator;
    field.seed = raw.seed;
    field.samples = raw.samples;
    field.complete = raw.complete;
    field.version = raw.version;
    field.numbers = named.numbers;
    PngImage picture = develop(field, settings).picture;
    picture.texts = {{"Software", "Plenoflame " + raw.version}};
    write_png((path / (named.name + ".png")).string(), picture);
    if (exr) write_light_field((path / (named.name + ".exr")).string(), field);
  }
  return settings.saturation;
}

void write_depth(const std::string& folder, const Image& depth, const Image& confidence,
                 double nearest, double farthest, const LightField& raw) {
  const std::filesystem::path path(folder);
  LightField field;
  field.sensor_width = depth.width;
  field.sensor_height = depth.height;
  field.window = {0, 0, depth.width, depth.height};
  field.channels.push_back({"depth", depth, {}});
  field.layers["confidence"] = confidence;
  field.unit = std::string("m");
  field.estimator = raw.estimator;
  field.seed = raw.seed;
  field.samples = raw.samples;
  field.complete = raw.complete;
  field.version = raw.version;
  write_light_field((path / "depth.exr").string(), field);
  PngImage picture;
  picture.width = depth.width;
  picture.height = depth.height;
  for (const float value : depth.pixels) {
    const double share =
        (1 / static_cast<double>(value) - 1 / farthest) / (1 / nearest - 1 / farthest);
    picture.samples.push_back(
        value > 0 ? static_cast<std::uint16_t>(std::lround(40 + 215 * std::clamp(share, 0.0, 1.0)))
                  : std::uint16_t{0});
  }
  picture.texts = {{"Software", "Plenoflame " + raw.version}};
  write_png((path / "depth.png").string(), picture);
}

}  // namespace plenoflame::cli
