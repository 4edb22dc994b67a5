#include "commands/light_field/pyrometry_light.h"

#include <algorithm>
#include <limits>

#include "commands/light_field/develop_sensor.h"
#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/sensor.h"

namespace plenoflame::cli {
namespace {

/// True if a recorded value with a full well went into a colour of a pixel: its own value, or, for
/// another colour, a neighbour's, of which it is a mean (demosaic() in lightfield/sensor.h).
bool was_full(const Image& raw, MosaicPattern pattern, PixelWindow window, int column, int row,
              int colour, float limit) {
  if (mosaic_colour(pattern, window.x + column, window.y + row) == colour)
    return raw.at(column, row) >= limit;
  for (int y = std::max(0, row - 1); y <= std::min(raw.height - 1, row + 1); ++y)
    for (int x = std::max(0, column - 1); x <= std::min(raw.width - 1, column + 1); ++x)
      if (mosaic_colour(pattern, window.x + x, window.y + y) == colour && raw.at(x, y) >= limit)
        return true;
  return false;
}

}  // namespace

LightFieldChannel light_in_proportion(const LightField& field, const Scene& scene,
                                      std::size_t index) {
  LightFieldChannel channel = field.channels[index];
  if (field.unit != "e-") return channel;
  const double dark = channel_dark_electrons(field, channel.name);
  const double time = channel_exposure(field, channel.name);
  if (!(time > 0))
    throw InputError("the electrons of channel " + channel.name +
                     " have no exposure time: develop them anew");
  // Any factor that both channels share may stay.
  const double per_electron = 1e-12 / (time * channel_wavelengths(scene)[index]);
  for (float& value : channel.flux.pixels)
    value = static_cast<float>((static_cast<double>(value) - dark) * per_electron);
  for (float& value : channel.standard_error.pixels)
    value = static_cast<float>(static_cast<double>(value) * per_electron);
  return channel;
}

std::size_t leave_out_saturated(const LightField& field, MosaicPattern mosaic, std::size_t a,
                                std::size_t b, LightFieldChannel light[2]) {
  const auto full = field.numbers.find("sensor.saturated_from");
  if (field.unit != "e-" || full == field.numbers.end()) return 0;
  const auto limit = static_cast<float>(full->second);
  std::size_t count = 0;
  // The mean of a full pixel and others of a mosaic may lie below the limit.
  const auto raw = field.layers.find("sensor.raw");
  const bool demosaiced = mosaic != MosaicPattern::none && raw != field.layers.end();
  for (int row = 0; row < light[0].flux.height; ++row)
    for (int column = 0; column < light[0].flux.width; ++column) {
      bool overflown = false;
      for (const std::size_t c : {a, b})
        overflown = overflown || (demosaiced ? was_full(raw->second, mosaic, field.window, column,
                                                        row, static_cast<int>(c), limit)
                                             : field.channels[c].flux.at(column, row) >= limit);
      if (!overflown) continue;
      light[0].flux.at(column, row) = light[1].flux.at(column, row) =
          std::numeric_limits<float>::quiet_NaN();
      ++count;
    }
  return count;
}

}  // namespace plenoflame::cli
