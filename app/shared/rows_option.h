#pragma once
#include <string>

#include "plenoflame/inverse/camera_rays.h"

namespace plenoflame {

/// Sets the pixels that make a row of a linear problem, by the options --bin and --cells.
/// @param bin N: blocks of N x N pixels; "micro-image"; "view": cells of each micro-image
/// @param cells of "view", along each side @throws UsageError
void rows_option(const std::string& bin, const std::string& cells, CameraRaySettings& rays);

}  // namespace plenoflame
