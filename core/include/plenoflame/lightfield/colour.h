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

/// A colour picture for display: 8 bits per sample, through the transfer function of sRGB. Colours
/// outside of sRGB, and those brighter than white, are clamped in each channel.
/// @throws InputError for images of different sizes, or values that are not finite
PngImage colour_picture(const std::array<const Image*, 3>& images, const ColourSettings& settings);

/// The channels of a light field that are a colour picture.
struct ColourChannels {
  std::array<std::string, 3> names;  ///< all empty: none are
  bool is_xyz = false;               ///< X, Y, Z; otherwise red, green, blue
  bool present() const { return !names[0].empty(); }
};

/// The channels with the responses cie_x, cie_y and cie_z. Without them: channels with the
/// responses of a camera that end in _red, _green and _blue. Without those: channels of the names
/// red, green, blue or R, G, B. Other channels are not used as colours.
ColourChannels colour_channels(const Scene& scene);

/// The channels of a colour picture for display. They are those with the responses cie_x, cie_y and
/// cie_z. Without them the first three are red, green and blue.
/// @param scene of the light field @throws InputError: there are fewer, or it holds electrons
ColourChannels display_colours(const LightField& light_field, const Scene& scene);

/// A light field with the three channels red, green and blue, in linear sRGB or as they are. Layers
/// stay, standard errors do not.
/// @throws InputError for a channel that is missing
LightField colour_field(const LightField& light_field, const ColourChannels& colours);

}  // namespace plenoflame
