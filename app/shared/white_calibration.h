#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/base/report.h"
#include "plenoflame/calibration/white_lattice.h"
#include "plenoflame/scene/scene_file.h"
#include "raw_files.h"
#include "settings.h"

namespace plenoflame {

/// A request for the microlens array, from white pictures.
struct WhiteRequest {
  RawFileOptions files;
  std::vector<std::string> white;  ///< N=FILE: one at f/N; or a .csv of centres
  std::vector<std::string> dark = {};
  std::string pixel_pitch = {}, mosaic = {};
  bool no_tilt = false;
};
template <>
std::span<const SettingRow<WhiteRequest>> setting_rows();

/// The array, and the figures about it.
struct WhiteCalibration {
  std::string camera;          ///< scene with the array; empty: no size of a pixel is known
  std::string centres, radii;  ///< tables (CSV); radii of one aperture: empty
  Image white;                 ///< light of the first aperture; empty: centres were given
  WhiteLattice lattice;
  Report report;
};

/// Called with the picture where no lattice is found. @return what is added to the message
using WhiteSeen = std::function<std::string(const Image& white)>;

/// @param camera nullptr: nothing is known of it @param seen may be empty
/// @throws UsageError, InputError, FileError, Cancelled
WhiteCalibration calibrate_white(const WhiteRequest& request, const SceneDocument* camera,
                                 const Execution& execution, const WhiteSeen& seen = {});

/// Warns of an angle that no array is mounted with, beyond its error: something else looks like it.
void warn_of_tilt(const std::string& key, double tilt, double error, const Execution& execution);

}  // namespace plenoflame
