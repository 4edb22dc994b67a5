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
  Image standard_error;  ///< [W], of `flux`; empty when it was not asked for
};

/// A raw light-field image with everything that later steps need: the scene text holds the whole
/// camera, so that views, refocusing and exports need no other file.
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
/// of the whole sensor. Attributes: "plenoflame.format" (2) and .complete are whole numbers, all
/// others texts, as other programs keep hardly anything else: "plenoflame.unit" ("W"), .version,
/// .scene, .estimator, .seed and .samples (decimal), .channels and .layers (names in order, one a
/// line), .number.KEY (decimal, SI; the shortest that is read as the same double), .text.KEY. From
/// these entries of `numbers` the standard attributes of OpenEXR are written besides, in the units
/// that it defines: lens.focal_length (effectiveFocalLength, mm), lens.f_number (aperture),
/// focus.object_distance (focus, m), sensor.pixel_pitch (sensorPhotositePitch, um;
/// sensorOverallDimensions, mm). The same light field gives the same bytes.
/// @throws FileError naming the file and the cause (folder missing, disk full, ...),
///         InputError when window, images and names do not fit together,
///         Cancelled when a stop was requested: nothing is left behind
void write_light_field(const std::string& path, const LightField& light_field,
                       const std::stop_token& stop = {},
                       ExrCompression compression = ExrCompression::rle);

/// Reads what write_light_field wrote. @throws FileError (cannot be read, not an EXR, damaged),
/// InputError (an EXR from elsewhere: names the missing attribute), Cancelled
LightField read_light_field(const std::string& path, const std::stop_token& stop = {});

/// Reads an EXR from elsewhere as though it were a raw image: every channel (converted to 32-bit
/// float) is taken for flux, in alphabetical order, the display window for the sensor. Attributes
/// of Plenoflame are not needed and not read. @throws FileError, InputError as read_light_field
LightField read_foreign_image(const std::string& path);

/// The same without pixels: all images are empty; channels without standard error cannot be told
/// from those with one.
LightField read_light_field_header(const std::string& path);

}  // namespace plenoflame
