#include "commands/light_field_output.h"

#include <algorithm>
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
  raw.field = read_light_field(path);
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

}  // namespace plenoflame::cli
