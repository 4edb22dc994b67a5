#pragma once
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/calibration/count_frames.h"
#include "plenoflame/image/raw_picture.h"
#include "plenoflame/scene/sensor_spec.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

/// Options of every command that reads a camera's files.
struct RawFileOptions {
  std::string size, endian = "little", skip = "0";
  int bits = 0, shift = 0, turn = 0;
  bool mirror = false;

  /// @throws UsageError
  RawLayout layout() const;
};

void add_raw_file_options(CLI::App& command, RawFileOptions& options);

/// Reads the frames of one series; pages of a TIFF and consecutive pictures in a headerless file
/// are frames, too. Probable mistakes give a warning.
/// @param full counts from which on a pixel is saturated; 0: the largest number
/// @throws FileError, InputError with the file's name
CountFrames read_frames(const std::vector<std::string>& files, const RawFileOptions& options,
                        double full = 0);

/// Counts from which on a pixel of this sensor is full; 0, the largest number, where --bits says
/// it.
double full_of(const RawFileOptions& options, const SensorSpec& sensor);

/// Says so where many of a picture's pixels are full, or hold more than the sensor can count.
/// @param full as for read_frames()
void warn_of_full(const CountFrames& frames, const std::string& file, double full,
                  const SensorSpec& sensor);

/// Light alone: dark subtracted, colours of a picture added, those of a mosaic made alike.
/// @throws InputError where the dark frame has another size
Image light_of(const CountFrames& frames, const std::optional<CountFrames>& dark,
               MosaicPattern mosaic);

}  // namespace plenoflame::cli
