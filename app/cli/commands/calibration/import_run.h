#pragma once
#include <string>
#include <vector>

#include "commands/calibration/raw_files.h"

namespace plenoflame::cli {

/// The command line of `import`.
struct ImportArguments {
  std::vector<std::string> raw, dark, flat, flat_dark, white, white_dark, set;
  std::vector<std::string> exposure_time, radiometry;
  std::string camera, which, output, channel, unit, defects, window, noise;
  std::string gain, read_noise, black_level, saturation;
  RawFileOptions files;
  int threads = 0;
  bool json = false;
};

/// Reads, corrects, writes and reports. @return the exit status @throws UsageError, InputError,
/// FileError
int run_import(const ImportArguments& arguments);

}  // namespace plenoflame::cli
