#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/scene/camera_spec.h"

namespace plenoflame {

/// A format of camera calibrations that can be read.
struct CameraFormatName {
  const char* name;
  const char* what;  ///< which tool, which file
};

/// All formats, in the order in which they are tried.
std::span<const CameraFormatName> camera_formats();

/// A camera from files of another tool.
struct ImportedCamera {
  CameraSpec camera;
  std::vector<std::string> formats;  ///< of the files, in their order
  std::vector<std::string> notes;    ///< what was assumed or left out, one line each
  std::string scene_text;  ///< not empty: the file holds a whole scene (TOML), `camera` is none
};

/// Assembles a camera from calibration files: an ideal thin main lens, ideal microlenses and their
/// known places. A later file may give what an earlier one does not.
/// @param given values that replace those of the files; 0: not given. They are lens.focal_length,
///        lens.diameter, focus.lens_distance or focus.object_distance, array.pitch,
///        array.sensor_distance, focal lengths of array.types. For the sensor: columns, rows and
///        pixel pitch
/// @param format of the files by name; empty: recognised by their content
/// @throws FileError, InputError with file and line; InputError that lists every missing value with
///         its key
ImportedCamera import_camera(const std::vector<std::string>& files, const CameraSpec& given,
                             std::string_view format = {});

}  // namespace plenoflame
