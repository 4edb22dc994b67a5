#include "image_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>

#include "plenoflame/image/png_file.h"
#include "plenoflame/lightfield/develop.h"

namespace plenoflame {
namespace {

/// A picture that was computed from a raw light field, as a light field of one channel.
LightField computed(const Image& image, const std::string& channel, const std::string& unit,
                    const LightField& raw) {
  LightField field;
  field.sensor_width = image.width;
  field.sensor_height = image.height;
  field.window = {0, 0, image.width, image.height};
  field.channels.push_back({channel, image, {}});
  field.unit = unit;
  field.estimator = raw.estimator;
  field.seed = raw.seed;
  field.samples = raw.samples;
  field.complete = raw.complete;
  field.version = raw.version;
  return field;
}

}  // namespace

double write_pngs(const std::string& folder, const std::vector<NamedImage>& images,
                  const LightField& raw, const Execution& execution) {
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
    PngImage picture = develop(computed(named.image, named.name, "", raw), settings).picture;
    picture.texts = {{"Software", "Plenoflame " + raw.version}};
    write_png((path / (named.name + ".png")).string(), picture, execution.stop);
  }
  return settings.saturation;
}

void write_exrs(const std::string& folder, const std::vector<NamedImage>& images,
                const std::string& channel, const std::string& unit, const LightField& raw,
                const Execution& execution) {
  for (const NamedImage& named : images) {
    LightField field = computed(named.image, channel, unit, raw);
    field.numbers = named.numbers;
    write_light_field((std::filesystem::path(folder) / (named.name + ".exr")).string(), field,
                      execution.stop);
  }
}

void write_depth(const std::string& folder, const Image& depth, const Image& confidence,
                 double nearest, double farthest, const LightField& raw) {
  const std::filesystem::path path(folder);
  LightField field = computed(depth, "depth", "m", raw);
  field.layers["confidence"] = confidence;
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

}  // namespace plenoflame
