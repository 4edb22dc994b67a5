#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/calibration/count_frames.h"
#include "plenoflame/image/raw_picture.h"
#include "plenoflame/scene/sensor_spec.h"
#include "settings.h"

namespace plenoflame {

/// How a camera's files are read.
struct RawFileOptions {
  SettingNames names = kOptionNames;
  std::string size = {};
  std::optional<int> bits = {};
  std::string endian = "little";
  std::optional<std::uint64_t> skip = {};  ///< [byte]
  int shift = 0;
  std::string turn = "0";
  bool mirror = false;

  /// @throws UsageError
  RawLayout layout() const;
};

template <>
std::span<const SettingRow<RawFileOptions>> setting_rows();

/// Files, and those in folders by their names; numbers in names count as numbers.
/// @throws InputError for an empty folder
std::vector<std::string> files_of(const std::vector<std::string>& names);

/// Reads the frames of one series, in files or folders; pages of a TIFF and consecutive pictures in
/// a headerless file are frames, too. Probable mistakes give a warning.
/// @param full counts from which on a pixel is saturated; 0: the largest number
/// @throws FileError, InputError with the file's name
CountFrames read_frames(const std::vector<std::string>& files, const RawFileOptions& options,
                        const Execution& execution, double full = 0);

/// Counts from which on a pixel of this sensor is full; 0, the largest number, where the number of
/// bits is given.
double full_of(const RawFileOptions& options, const SensorSpec& sensor);

/// Says so where many of a picture's pixels are full, or hold more than the sensor can count.
/// @param full as for read_frames()
void warn_of_full(const CountFrames& frames, const std::string& file, double full,
                  const SensorSpec& sensor, const Execution& execution);

/// Light alone: dark subtracted, colours of a picture added, those of a mosaic made alike.
/// @throws InputError where the dark frame has another size
Image light_of(const CountFrames& frames, const std::optional<CountFrames>& dark,
               MosaicPattern mosaic);

}  // namespace plenoflame
