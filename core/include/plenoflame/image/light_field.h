#pragma once
#include <cstdint>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "plenoflame/image/image.h"

namespace plenoflame {

/// One channel of a light field: radiant flux per pixel and its standard error.
struct LightFieldChannel {
  std::string name;      ///< "total" or as named in the scene, e.g. "650nm"
  Image flux;            ///< [W]
  Image standard_error;  ///< [W], of `flux`; empty: not requested
};

/// A raw light-field image with everything that later steps need. The scene text holds the whole
/// camera, so views, refocusing and exports need no other file.
struct LightField {
  int sensor_width = 0;   ///< columns of the whole sensor
  int sensor_height = 0;  ///< rows of the whole sensor
  PixelWindow window;     ///< the part of the sensor that the images below hold
  std::vector<LightFieldChannel> channels;
  std::map<std::string, Image> layers;  ///< further per-pixel results by name, e.g. ground truth

  std::string scene_text;  ///< TOML, complete (presets and files resolved)
  std::string estimator;   ///< "backward" or "forward"
  std::uint64_t seed = 0;
  double samples = 0;    ///< rays per lit pixel and microlens (backward), bundles (forward)
  bool complete = true;  ///< false: the run was stopped early
  std::string version;   ///< of Plenoflame
  std::map<std::string, double> numbers;     ///< derived figures, e.g. "array.pitch" [m]
  std::map<std::string, std::string> texts;  ///< further attributes
  std::string unit = "W";  ///< of the channels; pictures made from a raw image hold "W/(m^2 sr)"
};

/// The channel of this name; the first when `name` is empty.
/// @param what names the light field in messages
/// @throws InputError that lists the channels present
const LightFieldChannel& find_channel(const LightField& light_field, const std::string& name,
                                      const std::string& what = "the light field");

/// Ways to pack the pixels of an EXR; nothing is lost by any.
enum class ExrCompression {
  none,
  rle,  ///< runs of equal bytes: unlit pixels, most of a light field, take no space; quick
  zip,  ///< some percent smaller than rle, three times as long to write
  piz,  ///< wavelets: larger and slower than zip where pixels are noisy or unlit
};

/// Writes a multi-channel float EXR (flux "NAME", standard error "NAME.error", layers by name),
/// under a temporary name that is renamed at the end. Data window: `window` within a display window
/// of the whole sensor. The same light field gives the same bytes.
///
/// Integer attributes: "plenoflame.format" (2) and .complete. All others are texts, because few
/// other programs keep other types: "plenoflame.unit" ("W"), .version, .scene, .estimator. Decimal:
/// .seed and .samples. Names in order, one a line: .channels and .layers. Further .text.KEY, and
/// .number.KEY (decimal, SI; the shortest that is read as the same double).
///
/// Some entries of `numbers` also give the standard attributes of OpenEXR, in its units. Lens:
/// lens.focal_length (effectiveFocalLength, mm), lens.f_number (aperture). Focus:
/// focus.object_distance (focus, m). Sensor: sensor.pixel_pitch (sensorPhotositePitch, um;
/// sensorOverallDimensions, mm).
/// @throws FileError naming the file and the cause (folder missing, disk full, ...)
/// @throws InputError when window, images and names do not fit together
/// @throws Cancelled when a stop was requested: no file is left
void write_light_field(const std::string& path, const LightField& light_field,
                       const std::stop_token& stop = {},
                       ExrCompression compression = ExrCompression::rle);

/// Reads what write_light_field wrote. @throws FileError (cannot be read, not an EXR, damaged),
/// InputError (an EXR from elsewhere: names the missing attribute), Cancelled
LightField read_light_field(const std::string& path, const std::stop_token& stop = {});

/// Reads an EXR of another program as a raw image. Every channel (converted to 32-bit float) is
/// flux, in alphabetical order; the display window is the sensor. Attributes of Plenoflame are
/// ignored. @throws FileError, InputError as read_light_field
LightField read_foreign_image(const std::string& path);

/// The same without pixels: all images are empty; channels without standard error cannot be told
/// from those with one.
LightField read_light_field_header(const std::string& path);

}  // namespace plenoflame
