#pragma once
#include <string>
#include <vector>

#include "commands/calibration/raw_files.h"

namespace plenoflame::cli {

/// The command line of `import`.
struct ImportArguments {
  std::vector<std::string> raw, dark, flat, flat_dark, white, white_dark, set;
  std::string camera, which, output, channel, unit, defects, window, radiometry, noise;
  std::string gain, read_noise, black_level, exposure_time, saturation;
  RawFileOptions files;
  int threads = 0;
  bool json = false;
};

/// Reads, corrects, writes and reports. @return the exit status @throws UsageError, InputError,
/// FileError
int run_import(const ImportArguments& arguments);

}  // namespace plenoflame::cli
