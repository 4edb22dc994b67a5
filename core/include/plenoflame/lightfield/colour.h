#pragma once
#include <array>

#include "plenoflame/image/image.h"
#include "plenoflame/image/png_file.h"

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

}  // namespace plenoflame
