#pragma once
#include <string>
#include <vector>

namespace plenoflame {

/// The energy per count of one channel.
struct ChannelScale {
  std::string channel;          ///< by name
  double joules_per_count = 0;  ///< [J] radiant energy on the pixel for one count above dark
  double relative_error = 0;    ///< standard error of it, common to all pixels
  /// Counts of a linear sensor would be c (1 + curvature c), c above dark.
  double curvature = 0;  ///< [1/counts]
  double curvature_error = 0;
  /// A white picture, a flat field evened the pictures out: pictures that this scale is for have
  /// to be evened out, too.
  bool white = false, flat = false;
};

/// Result of a radiometric calibration as a file.
struct RadiometryTable {
  int columns = 0, rows = 0;  ///< of the sensor
  std::vector<ChannelScale> channels;
};

/// Reads and writes it as TOML. @throws InputError with the file's line; FileError
RadiometryTable read_radiometry(const std::string& path);
std::string radiometry_text(const RadiometryTable& table);

/// The scale of a channel. @throws InputError that lists the channels
const ChannelScale& scale_of(const RadiometryTable& table, const std::string& channel,
                             const std::string& path);

}  // namespace plenoflame
