#include "plenoflame/measure/two_colour_light.h"

#include <algorithm>
#include <limits>

#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"
#include "plenoflame/image/raw_picture.h"
#include "plenoflame/lightfield/sensor.h"
#include "plenoflame/scene/spectral.h"

namespace plenoflame {
namespace {

/// Calls look(x, y) for each recorded value that contributed to a colour of a pixel. This is its
/// own value, or those of its neighbours whose mean it is (demosaic() in lightfield/sensor.h).
/// @param has_colour whether a recorded value at (x, y) is of this colour
template <class HasColour, class Look>
void look_at_values(const Image& raw, int column, int row, const HasColour& has_colour,
                    const Look& look) {
  if (has_colour(column, row)) return look(column, row);
  for (int y = std::max(0, row - 1); y <= std::min(raw.height - 1, row + 1); ++y)
    for (int x = std::max(0, column - 1); x <= std::min(raw.width - 1, column + 1); ++x)
      if (has_colour(x, y)) look(x, y);
}

}  // namespace

LightFieldChannel light_in_proportion(const LightField& field, const Scene& scene,
                                      std::size_t index) {
  LightFieldChannel channel = field.channels[index];
  // Counts above dark of an imported picture are electrons but for the gain, which is that of all
  // channels.
  const bool counts = field.unit == "DN";
  if (field.unit != "e-" && !counts) return channel;
  const double dark = counts ? 0 : channel_dark_electrons(field, channel.name);
  const double time = channel_exposure(field, channel.name);
  if (!(time > 0) && field.texts.contains("import.pictures"))
    throw mended_by(InputError("the pictures were imported without an exposure time"),
                    {"exposure-time"});
  if (!(time > 0))
    throw InputError("the electrons of channel " + channel.name +
                     " have no exposure time; develop them again");
  // Any factor that both channels share may stay.
  const double per_electron = 1e-12 / (time * channel_wavelengths(scene)[index]);
  for (float& value : channel.flux.pixels)
    value = static_cast<float>((static_cast<double>(value) - dark) * per_electron);
  for (float& value : channel.standard_error.pixels)
    value = static_cast<float>(static_cast<double>(value) * per_electron);
  return channel;
}

LeftOutPixels leave_out_bad_pixels(const LightField& field, MosaicPattern mosaic, std::size_t a,
                                   std::size_t b, LightFieldChannel light[2]) {
  LeftOutPixels count;
  const auto layer = [&](const char* name) {
    const auto found = field.layers.find(name);
    return found == field.layers.end() ? nullptr : &found->second;
  };
  const Image* const state = layer("sensor.state");  // of imported pictures
  const Image* const raw = layer("sensor.raw");
  const auto full = field.numbers.find("sensor.saturated_from");
  const bool limited = field.unit == "e-" && full != field.numbers.end();
  if (state == nullptr && !limited) return count;
  const float limit =
      limited ? static_cast<float>(full->second) : std::numeric_limits<float>::infinity();
  // The mean of a full pixel and others of a mosaic may lie below the limit.
  const bool demosaiced = mosaic != MosaicPattern::none && raw != nullptr;
  for (int row = 0; row < light[0].flux.height; ++row)
    for (int column = 0; column < light[0].flux.width; ++column) {
      bool saturated = false, defective = false;
      for (const std::size_t c : {a, b}) {
        const Image& recorded = demosaiced ? *raw : field.channels[c].flux;
        const auto look = [&](int x, int y) {
          const float is = state != nullptr ? state->at(x, y) : 0;
          saturated = saturated || is == static_cast<float>(PixelState::saturated) ||
                      recorded.at(x, y) >= limit;
          defective = defective || is == static_cast<float>(PixelState::defective);
        };
        const auto has_colour = [&](int x, int y) {
          return mosaic_colour(mosaic, field.window.x + x, field.window.y + y) ==
                 static_cast<int>(c);
        };
        if (demosaiced)
          look_at_values(recorded, column, row, has_colour, look);
        else
          look(column, row);
      }
      if (!saturated && !defective) continue;
      light[0].flux.at(column, row) = light[1].flux.at(column, row) =
          std::numeric_limits<float>::quiet_NaN();
      ++(saturated ? count.saturated : count.defective);
    }
  return count;
}

}  // namespace plenoflame
