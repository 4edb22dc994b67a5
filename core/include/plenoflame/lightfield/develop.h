#pragma once
#include <cstddef>
#include <string>

#include "plenoflame/image/light_field.h"
#include "plenoflame/image/png_file.h"
#include "plenoflame/scene/render_spec.h"

namespace plenoflame {

/// A developed picture and what was done to get it.
struct DevelopedImage {
  PngImage picture;            ///< grey, 16 bits; of the light field's window
  double saturation = 0;       ///< [W] flux per pixel at which the sensor saturates
  bool automatic = false;      ///< `saturation` was found, not given
  std::size_t saturated = 0;   ///< pixels with a flux of at least `saturation`
  std::size_t lit = 0;         ///< pixels with light: a flux above 0
  double saturated_share = 0;  ///< saturated / all pixels
};

/// Share of the pixels with light that automatic exposure does not let exceed saturation.
inline constexpr double kAutomaticExposure = 0.999;

/// Automatic exposure: the smallest flux [W] that is not exceeded by at least kAutomaticExposure of
/// the lit pixels (flux above 0). With fewer than 1000 lit pixels it is the largest flux. 0 for a
/// dark image.
double automatic_saturation(const Image& flux);

/// Sensor response without noise: digital number = round(flux / saturation * (2^bits - 1)), clipped
/// to [0, 2^bits - 1]. The picture's samples have 16 bits. With the linear curve they are scaled
/// digital numbers: digital number = sample >> (16 - bits). With the curve for display they pass
/// through the transfer function of sRGB (IEC 61966-2-1). A dark image with automatic exposure
/// becomes black.
/// @param channel name; empty: the first
/// @throws InputError: unknown channel (lists those present), a pixel that is not finite, bits
///         outside 1 to 16, a negative saturation
DevelopedImage develop(const LightField& light_field, const DevelopSpec& settings,
                       const std::string& channel = "");

/// Transfer function of sRGB, linear in [0, 1] to encoded in [0, 1] (IEC 61966-2-1:1999).
double encode_srgb(double linear);

}  // namespace plenoflame
