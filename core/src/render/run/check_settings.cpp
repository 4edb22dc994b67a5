#include "render/run/check_settings.h"

#include <string>

#include "plenoflame/base/error.h"

namespace plenoflame {

void check_settings(const RenderSettings& settings, const SensorSpec& sensor) {
  const PixelWindow& w = settings.window;
  if (w.width != 0 || w.height != 0) {
    if (w.width <= 0 || w.height <= 0 || w.x < 0 || w.y < 0 || w.width > sensor.columns - w.x ||
        w.height > sensor.rows - w.y)
      throw UsageError("the window must lie inside the sensor of " +
                       std::to_string(sensor.columns) + " x " + std::to_string(sensor.rows) +
                       " pixels");
  }
  if (settings.replicates < 1 || settings.replicates > 64)
    throw UsageError("the number of replicates must be 1 to 64");
  if (settings.samples < settings.replicates)
    throw UsageError("at least " + std::to_string(settings.replicates) + " samples are needed");
  if (settings.target_error > 0 && settings.replicates < 2)
    throw UsageError("a target error needs at least 2 replicates");
  if (!settings.part.is_whole() && !has_fixed_samples(settings))
    throw UsageError(
        "a part of a picture has a fixed number of samples of the backward estimator: what a "
        "target "
        "error or a time limit asks for depends on all of the picture");
  if (!is_supported(settings.isa))
    throw UsageError("this processor does not support " + std::string(name(settings.isa)));
}

void check_part(const Part& part, const PixelWindow& window) {
  const int tiles = Film(window, 1, 1).tile_count();
  if (part.count > tiles)
    throw UsageError("the picture has " + std::to_string(tiles) + " tiles of " +
                     std::to_string(Film::kTile) + " x " + std::to_string(Film::kTile) +
                     " pixels: it can be cut into as many parts, not into " +
                     std::to_string(part.count));
}

PixelWindow window_of(const RenderSettings& settings, const SensorSpec& sensor) {
  if (settings.window.width > 0) return settings.window;
  return {0, 0, sensor.columns, sensor.rows};
}

}  // namespace plenoflame
