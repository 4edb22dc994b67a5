#pragma once
#include <span>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/base/report.h"
#include "plenoflame/calibration/radiometry_table.h"
#include "plenoflame/scene/scene_file.h"
#include "raw_files.h"
#include "settings.h"

namespace plenoflame {

/// A request for the energy of a count, from pictures of a blackbody.
struct RadiometryRequest {
  RawFileOptions files;
  std::vector<std::string> sources;  ///< TEMPERATURE=FILE or TEMPERATURE@TIME=FILE
  std::vector<std::string> white = {}, white_dark = {}, flat = {}, flat_dark = {}, dark = {};
  std::string channel = {}, exposure = {}, temperature_error = {};
  double emissivity = 1, emissivity_error = 0, etendue_error = 0;
  std::string part = {};
};
template <>
std::span<const SettingRow<RadiometryRequest>> setting_rows();

/// The scales of the channels, and the figures about them.
struct RadiometryCalibration {
  RadiometryTable table;
  Report report;
};

/// @param camera scene with the camera and its channels @throws UsageError, InputError, FileError
RadiometryCalibration calibrate_radiometry(const RadiometryRequest& request,
                                           const SceneDocument& camera, const Execution& execution);

}  // namespace plenoflame
