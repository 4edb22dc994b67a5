#pragma once
#include <span>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/base/report.h"
#include "plenoflame/calibration/board_corners.h"
#include "plenoflame/scene/scene_file.h"
#include "raw_files.h"
#include "settings.h"

namespace plenoflame {

/// A request for the corners of boards in raw pictures, each of one pose.
struct BoardRequest {
  RawFileOptions files;
  std::vector<std::string> boards, white = {}, dark = {};
  std::string board = {}, cell = {};
  bool dots = false;
};
template <>
std::span<const SettingRow<BoardRequest>> setting_rows();

/// The corners, and the figures about them.
struct BoardCalibration {
  std::string corners;  ///< table (CSV)
  Image light;          ///< of the first picture that shows the board
  BoardCorners found;   ///< in it
  Report report;
};

/// Brightness that nearly no pixel exceeds.
double high_level(const Image& image);

/// @throws UsageError; InputError where no picture shows the board; FileError, Cancelled
BoardCalibration calibrate_corners(const BoardRequest& request, const SceneDocument& camera,
                                   const Execution& execution);

}  // namespace plenoflame
