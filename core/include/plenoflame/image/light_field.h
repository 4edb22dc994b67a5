#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "plenoflame/image/image.h"

namespace plenoflame {

/// What one channel of a light field holds: radiant flux per pixel and its standard error.
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

  std::string scene_text;       ///< TOML, complete (presets and files resolved)
  std::string estimator;        ///< "backward" or "forward"
  std::uint64_t seed = 0;
  double samples = 0;           ///< rays per lit pixel and microlens (backward), bundles (forward)
  bool complete = true;         ///< false: the run was stopped early
  std::string version;          ///< of Plenoflame
  std::map<std::string, double> numbers;        ///< derived figures, e.g. "array.pitch" [m]
  std::map<std::string, std::string> texts;     ///< further attributes
};

/// Writes a multi-channel float EXR (flux "NAME", standard error "NAME.error", layers by name),
/// under a temporary name that is renamed at the end.
/// @throws FileError naming the file and the cause (folder missing, disk full, ...)
void write_light_field(const std::string& path, const LightField& light_field);

/// Reads what write_light_field wrote. @throws FileError (cannot be read, not an EXR),
/// InputError (an EXR from elsewhere: names the missing attribute).
LightField read_light_field(const std::string& path);

}  // namespace plenoflame
