#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "number_rows.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/base/report.h"
#include "plenoflame/calibration/geometry_calibration.h"
#include "plenoflame/scene/scene_file.h"
#include "settings.h"

namespace plenoflame {

/// A request for distances, focal length and decentre of a camera from corners of a board.
struct GeometryRequest {
  SettingNames names = kOptionNames;
  std::string corners = {}, centres = {}, radii = {};  ///< files
  /// In place of files: "corners", "centres", "radii".
  std::map<std::string, std::vector<NumberRow>> tables = {};
  double f_number = GeometrySettings().f_number, microlens = GeometrySettings().microlens;
  std::string free = {};
  double pupil = GeometrySettings().pupil;
};
template <>
std::span<const SettingRow<GeometryRequest>> setting_rows();

/// The camera, and the figures about it.
struct FoundGeometry {
  GeometryCalibration fit;
  std::vector<CornerObservation> corners;
  std::string poses, residuals;  ///< tables (CSV)
  Report report;
};

/// @param start scene of the camera to start with @throws UsageError, InputError, FileError
FoundGeometry calibrate_geometry(const GeometryRequest& request, const SceneDocument& start,
                                 const Execution& execution);

/// A camera of a rig, and the boards that it has seen.
struct RigCamera {
  std::string what;  ///< for messages
  std::string file;  ///< of its scene
  Scene scene;
  std::vector<NumberRow> poses;  ///< table of poses
};

/// Reads the table of poses. @throws InputError, FileError
std::vector<NumberRow> read_poses(const std::string& path);

/// A request for the places of cameras by boards that they have seen together.
struct RigRequest {
  SettingNames names = kOptionNames;
  std::vector<RigCamera> cameras = {};
  std::string size = {};
};
template <>
std::span<const SettingRow<RigRequest>> setting_rows();

/// The scene with all cameras, in the first one's world, and the figures about it.
struct FoundRig {
  Scene scene;
  Report report;
};

/// @throws UsageError, InputError
FoundRig calibrate_rig(const RigRequest& request, const Execution& execution);

}  // namespace plenoflame
