#pragma once
#include <string>
#include <vector>

#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame::cli {

/// Options of `develop` that are about the sensor.
struct SensorOptions {
  bool sensor = false;                 ///< digital numbers of the scene's sensor
  std::vector<std::string> exposures;  ///< times, or "auto"
  std::vector<std::string> each;       ///< "CHANNEL=TIME", or "auto": every channel its own
  std::vector<std::string> noise;      ///< sources that are kept; empty: all
  std::string noise_seed;
  int frames = 1;
  bool dark = false;
  int threads = 0;

  bool any() const {
    return sensor || !exposures.empty() || !each.empty() || !noise.empty() || !noise_seed.empty() ||
           frames > 1 || dark;
  }
};

/// Options of `develop`.
struct DevelopArguments {
  std::string input;
  std::vector<std::string> set;
  std::string output;
  std::string saturation;
  int bits = 0;
  std::string curve;
  std::string channel;
  bool colour = false;
  SensorOptions sensor;
  bool json = false;
};

/// Frames as the sensor would record them. Files .png and .tif hold digital numbers of one channel
/// (or of the mosaic), .exr electrons of all channels.
/// @param output of the settings, or its default
int develop_sensor(const DevelopArguments& settings, const std::string& output,
                   const LightField& light_field, const Scene& scene);

}  // namespace plenoflame::cli
