#pragma once
#include <string>

#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame::cli {

/// A colour picture of the channels whose responses are cie_x, cie_y and cie_z. Without them, the
/// first three channels are red, green and blue.
/// @param saturation of Y, or of each; 0: automatic
int develop_colour(const LightField& light_field, const Scene& scene, double saturation,
                   const std::string& output, bool json);

}  // namespace plenoflame::cli
