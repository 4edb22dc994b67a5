#pragma once
#include "plenoflame/render/render.h"

namespace plenoflame {

/// @throws UsageError for a window outside of the sensor, impossible numbers of samples and
/// replicates, and an instruction set that the processor lacks
void check_settings(const RenderSettings& settings, const SensorSpec& sensor);

/// @throws UsageError when there are more parts than tiles
void check_part(const Part& part, const PixelWindow& window);

/// The window of the settings, or the whole sensor.
PixelWindow window_of(const RenderSettings& settings, const SensorSpec& sensor);

}  // namespace plenoflame
