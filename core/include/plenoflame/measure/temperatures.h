#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/pixel_bins.h"
#include "plenoflame/lightfield/pyrometry.h"
#include "plenoflame/measure/two_colour_light.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// A request for two-colour pyrometry.
struct TemperatureRequest {
  /// The two channels; empty: the first two. With filters: the one behind them; empty: the first.
  std::vector<std::string> channels;
  std::vector<std::string> filters;  ///< two camera.pupil_filters, by name, in place of channels
  /// Absorption against wavelength: "grey", "soot" (1/wavelength) or "power" (wavelength to
  /// -exponent); empty: that of the scene's flames.
  std::string law;
  double exponent = 1;
  int block = 0;  ///< side of the blocks of pixels that are added before the ratio; 0: none
  /// In place of blocks: the parts of each micro-image along each side, 1 for all of it; 0: none.
  int cells = 0;
  PyrometrySettings pixels;
};

/// Temperatures from the ratio of two colours.
struct Temperatures {
  TemperatureMap map;
  /// The map as a light field, channel "temperature". With filters a pixel is the area of a
  /// microlens.
  LightField picture;
  LeftOutPixels left_out;
  std::string law;                        ///< for people
  std::array<std::size_t, 2> channels{};  ///< numbers of the light field's; with filters: one twice
  std::array<double, 2> filter_pixels{};  ///< per microlens and filter, with filters
  /// [K] by the relative errors of the counts' scales, common to all pixels; 0: not known.
  double scale_error = 0;
  // Without filters:
  std::array<LightFieldChannel, 2> light;  ///< in proportion to power
  std::optional<PixelBins> bins;           ///< nothing: each pixel alone
  std::optional<TwoColour> ratio;
};

/// Finds the temperatures of a light field in W, in electrons or in counts.
/// @param scene of the light field @throws InputError, UsageError
Temperatures find_temperatures(const LightField& field, const Scene& scene,
                               const TemperatureRequest& request);

}  // namespace plenoflame
