#pragma once
#include <string>
#include <vector>

#include "commands/calibration/calibration_options.h"

namespace plenoflame::cli {

/// The command line of `import`.
struct ImportArguments : CalibrationArguments {
  std::vector<std::string> raw, dark, flat, flat_dark, white, white_dark;
  std::vector<std::string> exposure_time, radiometry;
  std::string output, channel, unit, defects, window, noise;
  std::string gain, read_noise, black_level, saturation;
};

/// Reads, corrects, writes and reports. @return the exit status @throws UsageError, InputError,
/// FileError
int run_import(const ImportArguments& arguments);

}  // namespace plenoflame::cli
