#pragma once
#include <array>
#include <string>

#include "plenoflame/image/image.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/image/png_file.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// Linear sRGB of CIE XYZ (IEC 61966-2-1:1999, D65 white of Y = 1).
std::array<double, 3> linear_srgb(const std::array<double, 3>& xyz);

struct ColourSettings {
  bool is_xyz = false;    ///< the three images are X, Y, Z; otherwise red, green and blue
  double saturation = 0;  ///< of Y, or of each of the three; 0: automatic_saturation() of it
};

/// A colour picture that a person looks at: 8 bits per sample, through the transfer function of
/// sRGB. Colours that sRGB does not have, and what is brighter than white, are cut to the nearest
/// edge of each channel. @throws InputError for images of different sizes, or not finite values
PngImage colour_picture(const std::array<const Image*, 3>& images, const ColourSettings& settings);

/// The channels of a light field that are a colour picture.
struct ColourChannels {
  std::array<std::string, 3> names;  ///< all empty: none are
  bool is_xyz = false;               ///< X, Y, Z; otherwise red, green, blue
  bool present() const { return !names[0].empty(); }
};

/// The channels with the responses cie_x, cie_y and cie_z; or else with those of a camera that end
/// in _red, _green and _blue; or else those named so: red, green, blue or R, G, B. Bands of other
/// names are not taken for colours.
ColourChannels colour_channels(const Scene& scene);

/// A light field with the three channels red, green and blue in linear sRGB or as they are; layers
/// stay, standard errors do not. @throws InputError for a channel that is missing
LightField colour_field(const LightField& light_field, const ColourChannels& colours);

}  // namespace plenoflame
