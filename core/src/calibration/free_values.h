#pragma once
#include <string>
#include <vector>

#include "plenoflame/calibration/geometry_calibration.h"

namespace plenoflame {

/// The observations from which a value of the camera is known.
enum class ValueGroup {
  optics,      ///< corners
  array,       ///< centres of micro-images
  distortion,  ///< corners; searched only on request
  microlens    ///< blur of corners
};

/// A value of the camera that can be fitted.
struct FreeValue {
  const char* key;
  double& (*of)(CameraSpec& camera);
  double step;  ///< for differences, of the camera's own size: relative to `scale`
  double (*scale)(const CameraSpec& camera);
  ValueGroup group;
};

/// The focal length of a type of microlenses, which blur of corners tells.
const FreeValue* microlens_value(std::size_t type);

/// True for the plane of which the image is distorted but sharp.
bool is_plane(const FreeValue* value);

/// The fitted values, in the order of the settings.
/// @param with_centres there are centres of micro-images
/// @throws InputError for an unknown name
std::vector<const FreeValue*> chosen_values(const GeometrySettings& settings, bool with_centres);

}  // namespace plenoflame
