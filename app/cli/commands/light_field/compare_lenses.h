#pragma once
#include <string>

#include "plenoflame/base/report.h"

namespace plenoflame {
struct LightField;
}

namespace plenoflame::cli {

/// The choices of compare about single micro-images.
struct LensComparison {
  bool wanted = false;
  std::string csv, map;
  bool asked() const { return wanted || !csv.empty() || !map.empty(); }
};

/// Registers the two pictures micro-image by micro-image, with the camera of the reference, reports
/// it and writes the files. @throws InputError, FileError
void compare_lenses(const LightField& measured, const LightField& simulated,
                    const std::string& channel, const std::string& path,
                    const LensComparison& settings, Report& report);

}  // namespace plenoflame::cli
